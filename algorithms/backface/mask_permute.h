// Looking up normal masks with the byte permutations of AVX-512 (VBMI): all 256 bytes of a mask are
// in four registers, and 64 triangles take two permutations. For mask_kernel.cpp only, and only
// where simd_byte_permutations() says so; elsewhere they throw std::logic_error.
#pragma once

#include "algorithms/backface/mask_kernel.h"

namespace vislab::backface_culling {

/// 64 x `words` triangles with one mask; else as look_up().
void permute_all(const BackMask& mask, const std::uint8_t* offsets, const std::uint8_t* bits,
                 std::size_t words, std::uint64_t* back);

/// As look_up_words().
void permute_each(const BackMask* masks, const std::uint16_t* numbers, const std::uint8_t* offsets,
                  const std::uint8_t* bits, std::size_t words, std::uint64_t* back);

}  // namespace vislab::backface_culling
