// A square table of bits, which cell sees which, stored as in Quake's world files: rows of bytes,
// in which every run of zero bytes is a zero and the run's length.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vislab::portal_culling {

/// Bits in words of 64; bit i is bit i % 64 of word i / 64.
using BitWords = std::vector<std::uint64_t>;

inline std::size_t words_for(std::size_t bits) { return (bits + 63) / 64; }
inline bool bit(std::span<const std::uint64_t> words, std::size_t i) {
  return (words[i / 64] >> (i % 64) & 1U) != 0;
}
inline void set_bit(std::span<std::uint64_t> words, std::size_t i) {
  words[i / 64] |= std::uint64_t{1} << (i % 64);
}

class CompressedRows {
 public:
  void clear(std::size_t bits_in_row);
  /// Appends a row. O(bits / 8).
  void add(std::span<const std::uint64_t> words);
  /// To be called after the last row: gives back the room that more rows would take.
  void finish();
  /// Adds the bits of a row to `words`. O(bytes of the compressed row).
  void unite(std::size_t row, std::span<std::uint64_t> words) const;

  std::size_t row_count() const { return first_.size() - 1; }
  std::size_t bits_in_row() const { return bits_in_row_; }
  std::size_t bytes() const {
    return first_.capacity() * sizeof(std::uint32_t) + bytes_.capacity();
  }

 private:
  std::size_t bits_in_row_ = 0;
  std::vector<std::uint32_t> first_{0};  // by row: of bytes_
  std::vector<std::uint8_t> bytes_;
};

}  // namespace vislab::portal_culling
