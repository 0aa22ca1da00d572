// The inner loops of backface.normal_mask: two bytes a triangle against a table of 256 bytes, and
// the test of a grid of normals that makes the table.
//
// Layout: the offsets of all triangles in one array, their bits in another, so that 16, 32 or 64 of
//   each are one load. A triangle faces away if table[offset] & bits is not zero.
// Lookup: with AVX-512 VBMI two permutations of 128 bytes each, chosen by the offset's highest bit.
//   With byte shuffles of 16 bytes (SSSE3, AVX2, AVX-512 BW) the table is cut into 16 pieces, of
//   which piece k is stored as its difference (exclusive or) to piece k - 1: a shuffle answers 0
//   where offset - 16 k is below 0, so that all pieces up to the offset's own are added up, and
//   leave the offset's own. The offset's highest bit is the sign, and chooses between the halves.
// Guarantee: looking up rounds nothing, and counting rounds one sum: every instruction set gives
//   the same bits.
// Cost: two bytes read a triangle; about two operations (VBMI: a tenth) a triangle.
// Source: Zhang and Hoff 1997; Zachmann, Computer-Graphik 2, SS 2012, slides 13-18.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace vislab::backface_culling {

/// Bits of all classes of normals: class c is bit c % 8 of byte c / 8, set if normals of this class
/// surely face away.
struct alignas(64) BackMask {
  std::array<std::uint8_t, 256> bytes{};

  friend bool operator==(const BackMask&, const BackMask&) = default;
};

/// Bytes that the arrays below have to be readable beyond their end.
inline constexpr std::size_t mask_kernel_padding = 64;

/// Bit i of `back` becomes set if mask.bytes[offsets[i]] & bits[i] is not zero; bits from count on
/// become 0. Writes (count + 63) / 64 words. Reads up to mask_kernel_padding bytes beyond the end
/// of `offsets` and `bits`, which may start anywhere. O(count), and about 20 ns for the table.
void look_up(const BackMask& mask, const std::uint8_t* offsets, const std::uint8_t* bits,
             std::size_t count, std::uint64_t* back);

/// The same for words of 64 triangles that have a mask each: word w is looked up in
/// masks[numbers[w]]. Reads and writes 64 x `words` triangles.
void look_up_words(const BackMask* masks, const std::uint16_t* numbers, const std::uint8_t* offsets,
                   const std::uint8_t* bits, std::size_t words, std::uint64_t* back);

/// look_up, one triangle after the other.
void look_up_scalar(const BackMask& mask, const std::uint8_t* offsets, const std::uint8_t* bits,
                    std::size_t count, std::uint64_t* back);

/// Values at the points of a grid on a side of the direction cube: rows[j] + columns[i].
struct alignas(64) SidePoints {
  static constexpr std::size_t most = 32;  // of each, those not used included

  std::array<float, most> rows{};
  std::array<float, most> columns{};
};

/// For each row, on how many of the first `count` columns the value is above the limit. Writes
/// SidePoints::most numbers, also for rows that are not used.
void count_above(const SidePoints& points, std::size_t count, float limit, std::uint32_t* above);

}  // namespace vislab::backface_culling
