// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/backface/plane_kernel.cpp"
#include "algorithms/backface/plane_kernel.h"

#include <hwy/foreach_target.h>
// foreach_target.h must come before highway.h.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "algorithms/backface/back_bits.h"
#include "algorithms/backface/magnitudes.h"
#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::backface_culling::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, PlaneArrays::padding>;
constexpr std::uint32_t lanes = HWY_MIN(HWY_LANES(float), PlaneArrays::padding);

HWY_INLINE std::uint64_t bits_of(hn::Mask<Floats> mask) {
  return simd::HWY_NAMESPACE::mask_bits(Floats(), mask);
}

void mark(const PlaneArrays& planes, const PlaneTest& test, std::uint32_t first,
          std::uint32_t count, std::uint64_t* back) {
  const Floats f;
  const float* x = planes.row(0) + first;
  const float* y = planes.row(1) + first;
  const float* z = planes.row(2) + first;
  const float* d = planes.row(3) + first;
  const auto eye_x = hn::Set(f, test.x);
  const auto eye_y = hn::Set(f, test.y);
  const auto eye_z = hn::Set(f, test.z);
  const auto eye_w = hn::Set(f, test.w);
  const auto limit = hn::Set(f, -test.limit);
  const auto bits_at = [&](std::uint32_t i) HWY_ATTR {
    // No fused multiply-add: it would round differently where there is one.
    const auto xy =
        hn::Add(hn::Mul(hn::LoadU(f, x + i), eye_x), hn::Mul(hn::LoadU(f, y + i), eye_y));
    const auto zd =
        hn::Add(hn::Mul(hn::LoadU(f, z + i), eye_z), hn::Mul(hn::LoadU(f, d + i), eye_w));
    return bits_of(hn::Lt(hn::Add(xy, zd), limit));
  };
  std::uint32_t i = 0;
  for (; i + 64 <= count; i += 64) {
    std::uint64_t word = 0;
    for (std::uint32_t j = 0; j < 64; j += lanes) word |= bits_at(i + j) << j;
    back[i / 64] = word;
  }
  if (i == count) return;
  std::uint64_t word = 0;
  for (std::uint32_t j = 0; i + j < count; j += lanes) word |= bits_at(i + j) << j;
  back[i / 64] = word & (~std::uint64_t{0} >> (64U - (count - i)));
}

}  // namespace
}  // namespace vislab::backface_culling::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab::backface_culling {

std::array<float, 4> rounded_plane(const Mesh& mesh, const MeshFrame& frame,
                                   std::uint32_t triangle) {
  const glm::dvec4 plane = scaled_plane(mesh, frame, triangle);
  return {static_cast<float>(plane.x), static_cast<float>(plane.y), static_cast<float>(plane.z),
          static_cast<float>(plane.w / frame.unit())};
}

PlaneArrays::PlaneArrays(const Mesh& mesh, const MeshFrame& frame)
    : count_(static_cast<std::uint32_t>(mesh.triangles.size())),
      values_(std::size_t{4} * count_ + padding) {
  for (std::uint32_t i = 0; i < count_; ++i) {
    const std::array<float, 4> plane = rounded_plane(mesh, frame, i);
    for (std::size_t row = 0; row < 4; ++row) values_[row * count_ + i] = plane[row];
  }
}

PlaneTest plane_test(const MeshEye& eye, const MeshFrame& frame) {
  // Largest sum that a test can come to: 1/2 to 1 after scaling, w included. What then falls below
  // the smallest float is far less than the limit.
  const double scale = 1.0 / power_of_two_from(eye.magnitude() + eye.position.w * frame.size);
  MeshEye scaled = eye;
  scaled.position = glm::dvec4(glm::dvec3(eye.position) * scale, eye.position.w);
  scaled.error *= scale;
  MeshFrame scaled_frame = frame;
  scaled_frame.size *= scale;
  return {static_cast<float>(scaled.position.x), static_cast<float>(scaled.position.y),
          static_cast<float>(scaled.position.z),
          static_cast<float>(eye.position.w * frame.unit() * scale),
          behind_limit_float(scaled, scaled_frame)};
}

HWY_EXPORT(mark);

void mark_behind(const PlaneArrays& planes, const PlaneTest& test, std::uint32_t first,
                 std::uint32_t count, std::uint64_t* back) {
  HWY_DYNAMIC_DISPATCH(mark)(planes, test, first, count, back);
}

void mark_behind_scalar(const PlaneArrays& planes, const PlaneTest& test, std::uint32_t first,
                        std::uint32_t count, std::uint64_t* back) {
  std::fill_n(back, words_of(count), 0);
  for (std::uint32_t i = 0; i < count; ++i) {
    const float xy = planes.row(0)[first + i] * test.x + planes.row(1)[first + i] * test.y;
    const float zd = planes.row(2)[first + i] * test.z + planes.row(3)[first + i] * test.w;
    back[i / 64] |= std::uint64_t{xy + zd < -test.limit} << (i % 64);
  }
}

}  // namespace vislab::backface_culling
#endif  // HWY_ONCE
