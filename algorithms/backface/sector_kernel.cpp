// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/backface/sector_kernel.cpp"
#include "algorithms/backface/sector_kernel.h"

#include <hwy/foreach_target.h>
// foreach_target.h must come before highway.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace vislab::backface_culling::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Places the boxes that lie in the lanes of one vector. With one lane it is the scalar twin.
template <typename Floats>
class Placer {
 public:
  using Vector = hn::Vec<Floats>;
  using Ints = hn::RebindToUnsigned<Floats>;

  HWY_INLINE Placer(const CameraRows& rows, const ViewLines& lines) : rows_(rows), lines_(lines) {}

  HWY_INLINE hn::Vec<Ints> place(const PointBoxes& boxes, std::size_t first) const {
    const Floats f;
    const Ints u;
    Vector x[8], y[8], z[8];
    corners(rows_.x, boxes, first, x);
    corners(rows_.y, boxes, first, y);
    corners(rows_.z, boxes, first, z);
    Vector nearest = z[0];
    for (int k = 1; k < 8; ++k) nearest = hn::Min(nearest, z[k]);
    const Vector error = hn::Set(f, rows_.error);
    const auto in_front = hn::Gt(nearest, hn::Mul(hn::Set(f, 4.0F), error));
    // |x / z - true| <= error (1 + |x / z|) / (nearest - error), and 2^-22 (1 + |x / z|) for all
    // rounding from here on.
    const Vector relative =
        hn::Add(hn::Mul(hn::Div(error, hn::Sub(nearest, error)), hn::Set(f, 1.0F + 0x1p-20F)),
                hn::Set(f, 0x1p-22F));
    for (int k = 0; k < 8; ++k) z[k] = hn::Div(hn::Set(f, 1.0F), z[k]);
    auto packed = hn::Zero(u);
    auto known = in_front;
    span(x, z, relative, lines_.x, 0, packed, known);
    span(y, z, relative, lines_.y, 16, packed, known);
    return hn::IfThenElseZero(hn::RebindMask(u, known), packed);
  }

 private:
  /// One coordinate of the 8 corners of each box.
  HWY_INLINE void corners(const float* row, const PointBoxes& boxes, std::size_t first,
                          Vector* out) const {
    const Floats f;
    Vector terms[3][2];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector factor = hn::Set(f, row[axis]);
      terms[axis][0] = hn::Mul(factor, hn::LoadU(f, boxes.row(axis) + first));
      terms[axis][1] = hn::Mul(factor, hn::LoadU(f, boxes.row(axis + 3) + first));
    }
    const Vector added = hn::Set(f, row[3]);
    for (int k = 0; k < 8; ++k) {
      out[k] =
          hn::Add(hn::Add(terms[0][k % 2], terms[1][k / 2 % 2]), hn::Add(terms[2][k / 4], added));
    }
  }

  /// The lines before and behind all quotients values / z, as two bytes from bit `shift` on.
  HWY_INLINE void span(const Vector* values, const Vector* inverse_z, Vector relative,
                       const std::vector<float>& lines, int shift, hn::Vec<Ints>& packed,
                       hn::Mask<Floats>& known) const {
    const Floats f;
    const Ints u;
    Vector low = hn::Mul(values[0], inverse_z[0]);
    Vector high = low;
    for (int k = 1; k < 8; ++k) {
      const Vector quotient = hn::Mul(values[k], inverse_z[k]);
      low = hn::Min(low, quotient);
      high = hn::Max(high, quotient);
    }
    const Vector widest = hn::Max(hn::Abs(low), hn::Abs(high));
    const Vector margin = hn::Mul(relative, hn::Add(hn::Set(f, 1.0F), widest));
    low = hn::Sub(low, margin);
    high = hn::Add(high, margin);
    const auto one = hn::Set(u, std::uint32_t{1});
    auto not_above = hn::Zero(u);  // lines <= low
    auto below = hn::Zero(u);      // lines < high
    for (const float line : lines) {
      const Vector at = hn::Set(f, line);
      not_above = hn::Add(not_above, hn::IfThenElseZero(hn::RebindMask(u, hn::Le(at, low)), one));
      below = hn::Add(below, hn::IfThenElseZero(hn::RebindMask(u, hn::Lt(at, high)), one));
    }
    const auto count = hn::Set(u, static_cast<std::uint32_t>(lines.size()));
    const auto bounded = hn::And(hn::Ne(not_above, hn::Zero(u)), hn::Ne(below, count));
    known = hn::And(known, hn::RebindMask(f, bounded));
    const auto both = hn::Add(hn::Sub(not_above, one), hn::ShiftLeft<8>(below));
    packed = hn::Or(packed, shift == 0 ? both : hn::ShiftLeft<16>(both));
  }

  const CameraRows& rows_;
  const ViewLines& lines_;
};

template <typename Floats>
void place_all(const CameraRows& rows, const ViewLines& lines, const PointBoxes& boxes,
               std::size_t first, std::size_t count, Rectangle* rectangles) {
  const Floats f;
  const hn::RebindToUnsigned<Floats> u;
  const Placer<Floats> placer(rows, lines);
  const std::size_t lanes = hn::Lanes(f);
  HWY_ALIGN std::uint32_t packed[HWY_MIN(HWY_LANES(float), 16)];
  for (std::size_t i = 0; i < count; i += lanes) {
    hn::Store(placer.place(boxes, first + i), u, packed);
    for (std::size_t lane = 0; lane < std::min(lanes, count - i); ++lane) {
      const std::uint32_t bits = packed[lane];
      rectangles[i + lane] = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
                              static_cast<std::uint8_t>(bits >> 16),
                              static_cast<std::uint8_t>(bits >> 24)};
    }
  }
}

void find_all(const CameraRows& rows, const ViewLines& lines, const PointBoxes& boxes,
              std::size_t first, std::size_t count, Rectangle* rectangles) {
  place_all<hn::CappedTag<float, 16>>(rows, lines, boxes, first, count, rectangles);
}

void find_one_by_one(const CameraRows& rows, const ViewLines& lines, const PointBoxes& boxes,
                     std::size_t first, std::size_t count, Rectangle* rectangles) {
  place_all<hn::CappedTag<float, 1>>(rows, lines, boxes, first, count, rectangles);
}

}  // namespace
}  // namespace vislab::backface_culling::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab::backface_culling {

HWY_EXPORT(find_all);
HWY_EXPORT(find_one_by_one);

void find_rectangles(const CameraRows& rows, const ViewLines& lines, const PointBoxes& boxes,
                     std::size_t first, std::size_t count, Rectangle* rectangles) {
  HWY_DYNAMIC_DISPATCH(find_all)(rows, lines, boxes, first, count, rectangles);
}

void find_rectangles_scalar(const CameraRows& rows, const ViewLines& lines, const PointBoxes& boxes,
                            std::size_t first, std::size_t count, Rectangle* rectangles) {
  HWY_DYNAMIC_DISPATCH(find_one_by_one)(rows, lines, boxes, first, count, rectangles);
}

PointBoxes::PointBoxes(std::size_t count)
    : count_(count), stride_(count), values_(6 * count + padding, 0.0F) {
  const float infinity = std::numeric_limits<float>::infinity();
  std::fill_n(values_.begin(), 3 * count, infinity);
  std::fill_n(values_.begin() + static_cast<std::ptrdiff_t>(3 * count), 3 * count, -infinity);
}

void PointBoxes::add(std::size_t box, const glm::dvec3& point) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    // Rounded to nearest: camera_rows' error covers it.
    const auto value = static_cast<float>(point[axis]);
    float& low = values_[i * stride_ + box];
    float& high = values_[(i + 3) * stride_ + box];
    low = std::min(low, value);
    high = std::max(high, value);
  }
}

CameraRows camera_rows(const Camera& camera, const glm::dmat4x3& transform, const MeshFrame& mesh) {
  CameraRows rows{};
  const Pose& pose = camera.pose;
  const glm::dmat3 linear(transform[0], transform[1], transform[2]);
  const glm::dvec3 middle = linear * mesh.middle + (transform[3] - pose.eye);
  // What cancels in `middle`.
  const glm::dmat3 sizes(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
  const glm::dvec3 parts =
      sizes * glm::abs(mesh.middle) + glm::abs(transform[3]) + glm::abs(pose.eye);
  double reach = 0.0;
  const auto write = [&](const glm::dvec3& axis, float* row) {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
      row[i] = static_cast<float>(glm::dot(axis, linear[i]));
      sum += glm::dot(glm::abs(axis), sizes[i]);
    }
    row[3] = static_cast<float>(glm::dot(axis, middle));
    reach = std::max(reach, sum * mesh.size + glm::dot(glm::abs(axis), glm::abs(middle)));
  };
  write(pose.right, rows.x);
  write(pose.up, rows.y);
  write(-pose.back, rows.z);
  // In float: points, factors and what is added are rounded, then come three products and three
  // sums, each 2^-24 of at most `reach`: 9 in all, and 16 are taken. In double: at most 12
  // roundings of 2^-53 of what cancels; 64 are taken. Numbers near float's least lose more than
  // that.
  constexpr double tiny = std::numeric_limits<float>::denorm_min();
  const double error = 16.0 * 0x1p-24 * reach + 64.0 * 0x1p-53 * (parts.x + parts.y + parts.z) +
                       8.0 * tiny * mesh.size + 8.0 * tiny;
  rows.error = static_cast<float>(error * (1.0 + 0x1p-20));
  return rows;
}

}  // namespace vislab::backface_culling
#endif
