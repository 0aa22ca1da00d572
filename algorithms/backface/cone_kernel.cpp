// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/backface/cone_kernel.cpp"
#include "algorithms/backface/cluster_cones.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::backface_culling::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using FloatVector = hn::Vec<Floats>;
constexpr std::size_t lanes = HWY_MIN(HWY_LANES(float), 16);

HWY_INLINE std::uint64_t bits_of(hn::Mask<Floats> mask) {
  return simd::HWY_NAMESPACE::mask_bits(Floats(), mask);
}

HWY_INLINE FloatVector dot(FloatVector ax, FloatVector ay, FloatVector az, FloatVector bx,
                           FloatVector by, FloatVector bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

template <std::size_t rows, bool perspective>
HWY_INLINE void mark(std::span<const ClusterCones::Block<rows>> blocks, const ConeEye& eye,
                     std::uint64_t* back) {
  const Floats f;
  const auto eye_x = hn::Set(f, eye.x);
  const auto eye_y = hn::Set(f, eye.y);
  const auto eye_z = hn::Set(f, eye.z);
  const auto limit = hn::Set(f, eye.limit);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    std::uint64_t word = 0;
    const auto row = [&](std::size_t i, std::size_t lane) {
      return hn::Load(f, blocks[b].row[i].data() + lane);
    };
    for (std::size_t lane = 0; lane < 64; lane += lanes) {
      auto x = hn::Neg(eye_x);
      auto y = hn::Neg(eye_y);
      auto z = hn::Neg(eye_z);
      if constexpr (perspective) {
        x = hn::Sub(row(ClusterCones::point_x, lane), eye_x);
        y = hn::Sub(row(ClusterCones::point_y, lane), eye_y);
        z = hn::Sub(row(ClusterCones::point_z, lane), eye_z);
      }
      auto t = hn::Sub(dot(row(ClusterCones::axis_x, lane), row(ClusterCones::axis_y, lane),
                           row(ClusterCones::axis_z, lane), x, y, z),
                       limit);
      if constexpr (perspective && rows == 8) t = hn::Sub(t, row(ClusterCones::radius, lane));
      const auto enough = hn::Ge(
          hn::Mul(t, t), hn::Mul(row(ClusterCones::squared_sine, lane), dot(x, y, z, x, y, z)));
      word |= bits_of(hn::And(hn::Gt(t, hn::Zero(f)), enough)) << lane;
    }
    back[b] = word;
  }
}

void mark_blocks(const ClusterCones& cones, const ConeEye& eye, std::uint64_t* back) {
  if (cones.form() == ConeForm::apex) {
    if (eye.perspective) {
      mark<7, true>(cones.apexes(), eye, back);
    } else {
      mark<7, false>(cones.apexes(), eye, back);
    }
  } else if (eye.perspective) {
    mark<8, true>(cones.spheres(), eye, back);
  } else {
    mark<8, false>(cones.spheres(), eye, back);
  }
}

}  // namespace vislab::backface_culling::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab::backface_culling {

HWY_EXPORT(mark_blocks);

void mark_cones(const ClusterCones& cones, const ConeEye& eye, std::uint64_t* back) {
  HWY_DYNAMIC_DISPATCH(mark_blocks)(cones, eye, back);
}

}  // namespace vislab::backface_culling
#endif  // HWY_ONCE
