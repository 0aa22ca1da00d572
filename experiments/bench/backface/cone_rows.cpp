// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "experiments/bench/backface/cone_rows.cpp"
#include "experiments/bench/backface/cone_rows.h"

#include <hwy/foreach_target.h>
// foreach_target.h must come before highway.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vislab::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, ConeRows::multiple>;
constexpr std::size_t lanes = HWY_MIN(HWY_LANES(float), ConeRows::multiple);

void find(const ConeRows& cones, const std::array<float, 3>& camera, std::uint8_t* culled) {
  const Floats f;
  const float* apex_x = cones.apex[0].data();
  const float* apex_y = cones.apex[1].data();
  const float* apex_z = cones.apex[2].data();
  const float* axis_x = cones.axis[0].data();
  const float* axis_y = cones.axis[1].data();
  const float* axis_z = cones.axis[2].data();
  const float* cutoff = cones.cutoff.data();
  const auto camera_x = hn::Set(f, camera[0]);
  const auto camera_y = hn::Set(f, camera[1]);
  const auto camera_z = hn::Set(f, camera[2]);
  const std::size_t count = cones.cutoff.size();
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto x = hn::Sub(hn::LoadU(f, apex_x + i), camera_x);
    const auto y = hn::Sub(hn::LoadU(f, apex_y + i), camera_y);
    const auto z = hn::Sub(hn::LoadU(f, apex_z + i), camera_z);
    const auto along =
        hn::MulAdd(z, hn::LoadU(f, axis_z + i),
                   hn::MulAdd(y, hn::LoadU(f, axis_y + i), hn::Mul(x, hn::LoadU(f, axis_x + i))));
    const auto length = hn::Sqrt(hn::MulAdd(z, z, hn::MulAdd(y, y, hn::Mul(x, x))));
    const auto mask = hn::Ge(along, hn::Mul(hn::LoadU(f, cutoff + i), length));
    if constexpr (lanes >= 8) {
      hn::StoreMaskBits(f, mask, culled + i / 8);
    } else {
      std::array<std::uint8_t, 8> bits{};
      hn::StoreMaskBits(f, mask, bits.data());
      if (i % 8 == 0) culled[i / 8] = 0;
      culled[i / 8] = static_cast<std::uint8_t>(culled[i / 8] | bits[0] << (i % 8));
    }
  }
}

}  // namespace
}  // namespace vislab::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab {

HWY_EXPORT(find);

void find_culled(const ConeRows& cones, const std::array<float, 3>& camera, std::uint8_t* culled) {
  HWY_DYNAMIC_DISPATCH(find)(cones, camera, culled);
}

}  // namespace vislab
#endif
