#include "common/scene/content_hash.h"

#include <xxhash.h>

#include <array>
#include <bit>
#include <cstdint>
#include <new>

namespace vislab {

static_assert(std::endian::native == std::endian::little, "hashes are of little-endian bytes");

struct ContentHash::State {
  XXH3_state_t* xxh = XXH3_createState();
  State() {
    if (xxh == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(xxh);
  }
  ~State() { XXH3_freeState(xxh); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

ContentHash::ContentHash() : state_(std::make_unique<State>()) {}
ContentHash::~ContentHash() = default;

void ContentHash::add_bytes(const void* data, std::size_t size) {
  XXH3_128bits_update(state_->xxh, data, size);
}

void ContentHash::add(const std::string& text) {
  add(static_cast<unsigned long long>(text.size()));
  add_bytes(text.data(), text.size());
}

void ContentHash::add(const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) add(v[i]);
}

void ContentHash::add(const glm::dmat4x3& m) {
  for (int column = 0; column < 4; ++column) add(m[column]);
}

std::string ContentHash::hex() const {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_->xxh));
  constexpr std::array<char, 17> digits{"0123456789abcdef"};
  std::string text;
  for (const std::uint8_t byte : canonical.digest) {
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

}  // namespace vislab
