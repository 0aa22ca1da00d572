// Answers as bits: one for each triangle of a mesh, set where it surely faces away.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "common/culler/candidates.h"

namespace vislab::backface_culling {

/// Words of 64 bits that `count` triangles need.
constexpr std::size_t words_of(std::size_t count) { return (count + 63) / 64; }

/// Sets the bits [first, first + count). O(count / 64 + 1).
inline void set_bits(std::span<std::uint64_t> bits, std::uint32_t first, std::uint32_t count) {
  if (count == 0) return;
  const std::uint32_t last = first + count - 1;
  const std::uint64_t head = ~std::uint64_t{0} << (first & 63U);
  const std::uint64_t tail = ~std::uint64_t{0} >> (63U - (last & 63U));
  if (first / 64 == last / 64) {
    bits[first / 64] |= head & tail;
    return;
  }
  bits[first / 64] |= head;
  for (std::uint32_t word = first / 64 + 1; word < last / 64; ++word)
    bits[word] = ~std::uint64_t{0};
  bits[last / 64] |= tail;
}

/// Appends what is left of the triangles [offered.first, offered.first + offered.count) where bits
/// are not set, as runs. Bit 0 of `back` is triangle `base` of the mesh, base <= offered.first.
/// Bits beyond the offered triangles are not looked at. O(count / 64 + runs).
void append_kept(const TriangleRange& offered, std::span<const std::uint64_t> back,
                 std::uint32_t base, std::vector<TriangleRange>& kept);

}  // namespace vislab::backface_culling
