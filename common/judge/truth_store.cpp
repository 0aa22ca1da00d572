// Truth in files. A file is a header (signature, version, checksum and size of the content), then
// the content compressed by zlib: ids as runs of (id, count), then the histogram, ids as
// differences. All numbers are little-endian, of seven bits a byte where they vary in size.
#include <xxhash.h>
#include <zlib.h>

#include <array>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "common/judge/truth.h"
#include "common/scene/write_file.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

constexpr std::array<char, 8> signature = {'v', 'l', 't', 'r', 'u', 't', 'h', '1'};
constexpr std::size_t header_size = signature.size() + 16;
/// No image is larger, so a larger content is a corrupt header.
constexpr std::uint64_t largest_content = 1ULL << 32U;

using Bytes = std::vector<std::uint8_t>;

void put(Bytes& bytes, std::uint64_t value) {
  for (; value >= 0x80U; value >>= 7U) bytes.push_back(static_cast<std::uint8_t>(value | 0x80U));
  bytes.push_back(static_cast<std::uint8_t>(value));
}

/// Reads what put() wrote; remembers if the bytes ended too early.
class Reader {
 public:
  explicit Reader(const Bytes& bytes) : bytes_(bytes) {}

  std::uint64_t get() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      if (position_ == bytes_.size()) break;
      const std::uint8_t byte = bytes_[position_++];
      value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
      if ((byte & 0x80U) == 0) return value;
    }
    good_ = false;
    return 0;
  }
  bool good() const { return good_; }
  bool at_end() const { return position_ == bytes_.size(); }

 private:
  const Bytes& bytes_;
  std::size_t position_ = 0;
  bool good_ = true;
};

Bytes encode(const FrameTruth& truth) {
  Bytes bytes;
  put(bytes, static_cast<std::uint64_t>(truth.viewport.width));
  put(bytes, static_cast<std::uint64_t>(truth.viewport.height));
  put(bytes, truth.jittered_samples);
  for (std::size_t i = 0; i < truth.ids.size();) {
    std::size_t end = i + 1;
    while (end < truth.ids.size() && truth.ids[end] == truth.ids[i]) ++end;
    put(bytes, truth.ids[i]);
    put(bytes, end - i);
    i = end;
  }
  put(bytes, truth.hits.size());
  TriangleId last = 0;
  for (const TriangleHits& hit : truth.hits) {
    put(bytes, hit.triangle - last);
    put(bytes, hit.hits);
    put(bytes, hit.hits - hit.clear_hits);
    last = hit.triangle;
  }
  return bytes;
}

std::optional<FrameTruth> decode(const Bytes& bytes) {
  Reader reader(bytes);
  FrameTruth truth;
  const std::uint64_t width = reader.get();
  const std::uint64_t height = reader.get();
  truth.jittered_samples = reader.get();
  if (!reader.good() || width > 65536 || height > 65536) return std::nullopt;
  truth.viewport = {static_cast<int>(width), static_cast<int>(height)};
  truth.ids.reserve(width * height);
  while (truth.ids.size() < width * height) {
    const auto id = static_cast<TriangleId>(reader.get());
    const std::uint64_t count = reader.get();
    if (!reader.good() || count > width * height - truth.ids.size()) return std::nullopt;
    truth.ids.insert(truth.ids.end(), count, id);
  }
  const std::uint64_t triangles = reader.get();
  TriangleId last = 0;
  for (std::uint64_t i = 0; i < triangles && reader.good(); ++i) {
    last += static_cast<TriangleId>(reader.get());
    const auto hits = static_cast<std::uint32_t>(reader.get());
    truth.hits.push_back({last, hits, hits - static_cast<std::uint32_t>(reader.get())});
  }
  if (!reader.good() || !reader.at_end()) return std::nullopt;
  return truth;
}

void put_fixed(char* to, std::uint64_t value) {
  for (unsigned i = 0; i < 8; ++i) to[i] = static_cast<char>(value >> (8 * i));
}

std::uint64_t get_fixed(const std::uint8_t* from) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < 8; ++i) value |= static_cast<std::uint64_t>(from[i]) << (8 * i);
  return value;
}

fs::path file_of(const fs::path& folder, const std::string& key) {
  return folder / (key + ".truth");
}

}  // namespace

TruthStore::TruthStore(fs::path folder) : folder_(std::move(folder)) {}

std::optional<FrameTruth> TruthStore::load(const std::string& key) const {
  std::ifstream file(file_of(folder_, key), std::ios::binary | std::ios::ate);
  if (!file) return std::nullopt;
  const std::streamoff size = file.tellg();
  if (size <= static_cast<std::streamoff>(header_size)) return std::nullopt;
  Bytes stored(static_cast<std::size_t>(size));
  file.seekg(0);
  if (!file.read(reinterpret_cast<char*>(stored.data()), size)) return std::nullopt;
  if (std::memcmp(stored.data(), signature.data(), signature.size()) != 0) return std::nullopt;
  const std::uint64_t content_size = get_fixed(stored.data() + signature.size());
  const std::uint64_t checksum = get_fixed(stored.data() + signature.size() + 8);
  if (content_size > largest_content ||
      XXH3_64bits(stored.data() + header_size, stored.size() - header_size) != checksum) {
    return std::nullopt;
  }
  Bytes content(content_size);
  uLongf length = content.size();
  if (uncompress(content.data(), &length, stored.data() + header_size,
                 stored.size() - header_size) != Z_OK ||
      length != content.size()) {
    return std::nullopt;
  }
  return decode(content);
}

void TruthStore::save(const std::string& key, const FrameTruth& truth) const {
  const Bytes content = encode(truth);
  Bytes stored(header_size + compressBound(content.size()));
  uLongf length = stored.size() - header_size;
  compress2(stored.data() + header_size, &length, content.data(), content.size(), 1);
  std::array<char, header_size> header{};
  std::memcpy(header.data(), signature.data(), signature.size());
  put_fixed(header.data() + signature.size(), content.size());
  put_fixed(header.data() + signature.size() + 8, XXH3_64bits(stored.data() + header_size, length));
  std::memcpy(stored.data(), header.data(), header.size());

  std::error_code ignored;  // if the folder cannot be made, writing says so
  fs::create_directories(folder_, ignored);
  write_file(file_of(folder_, key),
             {reinterpret_cast<const char*>(stored.data()), header_size + length});
}

}  // namespace vislab
