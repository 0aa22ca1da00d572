#include "common/scene/file_bytes.h"

#include <zlib.h>

#include <array>
#include <fstream>
#include <iterator>
#include <memory>

#include "common/scene/error.h"

namespace vislab {

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

void require_file(const std::filesystem::path& file) {
  std::error_code ignored;  // exists() and the like answer false, which is what is asked
  if (!std::filesystem::exists(file, ignored)) {
    throw InputError(file.string() + " does not exist");
  }
  if (std::filesystem::is_directory(file, ignored)) {
    throw InputError(file.string() + " is a directory; a file is needed");
  }
  if (!std::filesystem::is_regular_file(file, ignored)) {
    throw InputError(file.string() + " is not a regular file");
  }
  if (std::filesystem::file_size(file, ignored) == 0) {
    throw InputError(file.string() + " is empty");
  }
}

std::string read_bytes(const std::filesystem::path& file) {
  require_file(file);
  std::ifstream stream(file, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (!stream.good() && !stream.eof()) throw InputError(file.string() + " cannot be read");
  if (bytes.empty()) throw InputError(file.string() + " cannot be read");
  return bytes;
}

std::string read_gzipped_bytes(const std::filesystem::path& file) {
  const std::string packed = read_bytes(file);
  z_stream stream{};
  constexpr int gzip_only = 15 + 16;
  if (inflateInit2(&stream, gzip_only) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);

  std::string bytes;
  std::array<char, 1U << 16U> buffer;
  std::size_t consumed = 0;
  // zlib counts in 32 bits, so a large file is handed over in pieces; a .gz may have several
  // members.
  int status = Z_OK;
  while (true) {
    if (stream.avail_in == 0 && consumed < packed.size()) {
      const std::size_t piece = std::min<std::size_t>(packed.size() - consumed, 1U << 30U);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + consumed));
      stream.avail_in = static_cast<uInt>(piece);
      consumed += piece;
    }
    stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream.avail_out = static_cast<uInt>(buffer.size());
    status = inflate(&stream, Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END) {
      throw InputError(file.string() + " is not whole gzip data: it is damaged or ends too early");
    }
    bytes.append(buffer.data(), buffer.size() - stream.avail_out);
    if (status == Z_STREAM_END) {
      if (stream.avail_in == 0 && consumed == packed.size()) break;
      inflateReset(&stream);
    }
  }
  if (bytes.empty()) throw InputError(file.string() + " is empty once decompressed");
  return bytes;
}

}  // namespace vislab
