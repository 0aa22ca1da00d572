// A mask's lanes as bits of a number, the form that answers are written in. To be included by files
// that Highway compiles for each instruction set, after highway.h.
#if defined(VISLAB_COMMON_SIMD_MASK_BITS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef VISLAB_COMMON_SIMD_MASK_BITS_INL_H_
#undef VISLAB_COMMON_SIMD_MASK_BITS_INL_H_
#else
#define VISLAB_COMMON_SIMD_MASK_BITS_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace vislab::simd::HWY_NAMESPACE {

/// Bit i tells of lane i; bits beyond the lanes are 0. `Lanes` is the tag of the vectors that the
/// mask was made from, of at most 16 lanes.
template <class Lanes>
HWY_INLINE std::uint32_t mask_bits(Lanes lanes, hwy::HWY_NAMESPACE::Mask<Lanes> mask) {
  // Read back in the size it was written in: the processor then passes it on without memory.
  constexpr std::size_t most_lanes = hwy::HWY_NAMESPACE::MaxLanes(Lanes());
  static_assert(most_lanes <= 16);
  using Bits = std::conditional_t<(most_lanes > 8), std::uint16_t, std::uint8_t>;
  std::array<std::uint8_t, 8> bytes{};
  hwy::HWY_NAMESPACE::StoreMaskBits(lanes, mask, bytes.data());
  Bits bits = 0;
  std::memcpy(&bits, bytes.data(), sizeof bits);
  return bits;
}

}  // namespace vislab::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
