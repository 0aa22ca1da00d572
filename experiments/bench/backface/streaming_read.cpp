// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "experiments/bench/backface/streaming_read.cpp"
#include "experiments/bench/backface/streaming_read.h"

#include <hwy/foreach_target.h>
// foreach_target.h must come before highway.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vislab::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

std::uint64_t read(const std::uint8_t* a, const std::uint8_t* b, std::size_t count) {
  using Words = hn::CappedTag<std::uint64_t, 8>;
  const Words d;
  const std::size_t step = 8 * hn::Lanes(d);
  // Sums that do not wait for each other.
  auto sum_a0 = hn::Zero(d);
  auto sum_a1 = hn::Zero(d);
  auto sum_b0 = hn::Zero(d);
  auto sum_b1 = hn::Zero(d);
  const auto load = [&](const std::uint8_t* from) HWY_ATTR {
    return hn::LoadU(d, reinterpret_cast<const std::uint64_t*>(from));
  };
  for (std::size_t i = 0; i < count; i += 2 * step) {
    sum_a0 = hn::Add(sum_a0, load(a + i));
    sum_a1 = hn::Add(sum_a1, load(a + i + step));
    sum_b0 = hn::Add(sum_b0, load(b + i));
    sum_b1 = hn::Add(sum_b1, load(b + i + step));
  }
  return hn::GetLane(hn::SumOfLanes(d, hn::Add(hn::Add(sum_a0, sum_a1), hn::Add(sum_b0, sum_b1))));
}

}  // namespace
}  // namespace vislab::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab {

HWY_EXPORT(read);

std::uint64_t streaming_read(const std::uint8_t* a, const std::uint8_t* b, std::size_t count) {
  return HWY_DYNAMIC_DISPATCH(read)(a, b, count);
}

}  // namespace vislab
#endif
