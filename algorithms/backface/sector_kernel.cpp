// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/backface/sector_kernel.cpp"
#include "algorithms/backface/sector_kernel.h"

#include <hwy/foreach_target.h>
// foreach_target.h must come before highway.h.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
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
  using Bool = hn::Mask<Floats>;
  using Ints = hn::RebindToSigned<Floats>;

  explicit HWY_INLINE Placer(const SectorRows& rows) : rows_(rows) {}

  /// Four bytes a box, as in Rectangle from the lowest on.
  HWY_INLINE hn::Vec<Ints> place(const PointBoxes& boxes, std::size_t first) const {
    const Floats f;
    const Ints ints;
    Vector z[8];
    corners(rows_.z, boxes, first, z);
    Vector nearest = z[0];
    for (int k = 1; k < 8; ++k) nearest = hn::Min(nearest, z[k]);
    const Vector error_z = hn::Set(f, rows_.error_z);
    Bool known = hn::Gt(nearest, hn::Mul(hn::Set(f, 4.0F), error_z));
    // Where it is not known, lanes may hold anything: they are dropped in the end.
    const Vector least_z = hn::Div(hn::Set(f, 1.0F + 0x1p-20F), hn::Sub(nearest, error_z));
    for (int k = 0; k < 8; ++k) z[k] = hn::Div(hn::Set(f, 1.0F), z[k]);
    Vector values[8];
    corners(rows_.x, boxes, first, values);
    const auto x = span(values, z, rows_.error_x, least_z, known);
    corners(rows_.y, boxes, first, values);
    const auto y = span(values, z, rows_.error_y, least_z, known);
    const auto packed = hn::Or(x, hn::ShiftLeft<16>(y));
    return hn::IfThenElseZero(hn::RebindMask(ints, known), packed);
  }

 private:
  static constexpr float farthest = (1 << SectorLines::lines_beyond) - 1;

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
    for (std::size_t k = 0; k < 2; ++k) terms[2][k] = hn::Add(terms[2][k], added);
    for (std::size_t k = 0; k < 8; ++k) {
      out[k] = hn::Add(hn::Add(terms[0][k % 2], terms[1][k / 2 % 2]), terms[2][k / 4]);
    }
  }

  /// The lines before and behind all quotients values / z, as two bytes.
  HWY_INLINE hn::Vec<Ints> span(const Vector* values, const Vector* inverse_z, float error,
                                Vector least_z, Bool& known) const {
    const Floats f;
    const Ints ints;
    Vector low = hn::Mul(values[0], inverse_z[0]);
    Vector high = low;
    for (int k = 1; k < 8; ++k) {
      const Vector quotient = hn::Mul(values[k], inverse_z[k]);
      low = hn::Min(low, quotient);
      high = hn::Max(high, quotient);
    }
    // A quotient q is off by at most (error + |q| error_z) / (z - error_z), and by 2^-22 |q| for
    // all rounding from the division on.
    const Vector widest = hn::Max(hn::Abs(low), hn::Abs(high));
    const Vector share = hn::Add(hn::Mul(hn::Set(f, rows_.error_z), least_z), hn::Set(f, 0x1p-22F));
    const Vector margin = hn::Add(hn::Mul(hn::Set(f, error), least_z), hn::Mul(widest, share));
    low = hn::Sub(low, margin);
    high = hn::Add(high, margin);
    const Vector none = hn::Zero(f);
    const Vector sectors = hn::Set(f, rows_.sectors);
    known = hn::And(known, hn::And(hn::Ge(low, hn::Set(f, -farthest)),
                                   hn::Le(high, hn::Set(f, rows_.sectors + farthest))));
    Vector before = hn::Min(hn::Max(hn::Floor(low), none), sectors);
    Vector behind = hn::Min(hn::Max(hn::Ceil(high), none), sectors);
    const Bool beyond = hn::Or(hn::Lt(low, none), hn::Gt(high, sectors));
    if (!hn::AllFalse(f, beyond)) {
      const Vector one = hn::Set(f, 1.0F);
      for (int k = 0; k <= SectorLines::lines_beyond; ++k) {
        const auto step = static_cast<float>((1 << k) - 1);
        const Vector under = hn::Set(f, -step);
        const Vector above = hn::Set(f, rows_.sectors + step);
        if (k < SectorLines::lines_beyond) {
          before = hn::Sub(before, hn::IfThenElseZero(hn::Lt(low, under), one));
          behind = hn::Add(behind, hn::IfThenElseZero(hn::Gt(high, above), one));
        }
        if (k > 0) {
          before = hn::Add(before, hn::IfThenElseZero(hn::Ge(low, above), one));
          behind = hn::Sub(behind, hn::IfThenElseZero(hn::Le(high, under), one));
        }
      }
    }
    const auto offset = hn::Set(ints, SectorLines::lines_beyond);
    return hn::Or(hn::Add(hn::ConvertTo(ints, before), offset),
                  hn::ShiftLeft<8>(hn::Add(hn::ConvertTo(ints, behind), offset)));
  }

  const SectorRows& rows_;
};

template <typename Floats>
void place_all(const SectorRows& rows, const PointBoxes& boxes, std::size_t first,
               std::size_t count, Rectangle* rectangles) {
  const Floats f;
  const hn::RebindToSigned<Floats> ints;
  const Placer<Floats> placer(rows);
  const std::size_t lanes = hn::Lanes(f);
  HWY_ALIGN std::int32_t packed[HWY_MIN(HWY_LANES(float), 16)];
  for (std::size_t i = 0; i < count; i += lanes) {
    hn::Store(placer.place(boxes, first + i), ints, packed);
    const std::size_t used = std::min(lanes, count - i);
    if constexpr (std::endian::native == std::endian::little) {
      static_assert(sizeof(Rectangle) == sizeof packed[0]);
      std::memcpy(static_cast<void*>(rectangles + i), packed, used * sizeof(Rectangle));
    } else {
      for (std::size_t lane = 0; lane < used; ++lane) {
        const auto bits = static_cast<std::uint32_t>(packed[lane]);
        rectangles[i + lane] = {
            static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
            static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 24)};
      }
    }
  }
}

void find_all(const SectorRows& rows, const PointBoxes& boxes, std::size_t first, std::size_t count,
              Rectangle* rectangles) {
  place_all<hn::CappedTag<float, 16>>(rows, boxes, first, count, rectangles);
}

void find_one_by_one(const SectorRows& rows, const PointBoxes& boxes, std::size_t first,
                     std::size_t count, Rectangle* rectangles) {
  place_all<hn::CappedTag<float, 1>>(rows, boxes, first, count, rectangles);
}

}  // namespace
}  // namespace vislab::backface_culling::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab::backface_culling {

HWY_EXPORT(find_all);
HWY_EXPORT(find_one_by_one);

void find_rectangles(const SectorRows& rows, const PointBoxes& boxes, std::size_t first,
                     std::size_t count, Rectangle* rectangles) {
  HWY_DYNAMIC_DISPATCH(find_all)(rows, boxes, first, count, rectangles);
}

void find_rectangles_scalar(const SectorRows& rows, const PointBoxes& boxes, std::size_t first,
                            std::size_t count, Rectangle* rectangles) {
  HWY_DYNAMIC_DISPATCH(find_one_by_one)(rows, boxes, first, count, rectangles);
}

PointBoxes::PointBoxes(std::size_t count) : count_(count), values_(6 * count + padding, 0.0F) {
  const float infinity = std::numeric_limits<float>::infinity();
  std::fill_n(values_.begin(), 3 * count, infinity);
  std::fill_n(values_.begin() + static_cast<std::ptrdiff_t>(3 * count), 3 * count, -infinity);
}

void PointBoxes::add(std::size_t box, const glm::dvec3& point) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    // Rounded to nearest: the errors of sector_rows cover it.
    const auto value = static_cast<float>(point[axis]);
    float& low = values_[i * count_ + box];
    float& high = values_[(i + 3) * count_ + box];
    low = std::min(low, value);
    high = std::max(high, value);
  }
}

SectorLines::SectorLines(const Lens& lens, int sectors)
    : sectors_(sectors),
      left_(lens.left / lens.near_m),
      bottom_(lens.bottom / lens.near_m),
      width_((lens.right / lens.near_m - left_) / sectors),
      height_((lens.top / lens.near_m - bottom_) / sectors) {}

double SectorLines::position(int i) const {
  if (i < lines_beyond) return 1.0 - (1 << (lines_beyond - i));
  const int beyond = i - lines_beyond - sectors_;
  if (beyond > 0) return sectors_ + (1 << beyond) - 1.0;
  return i - lines_beyond;
}

SectorRows sector_rows(const Camera& camera, const SectorLines& lines,
                       const glm::dmat4x3& transform, const MeshFrame& mesh) {
  const Pose& pose = camera.pose;
  const glm::dvec3 middle = glm::dmat3(transform[0], transform[1], transform[2]) * mesh.middle +
                            (transform[3] - pose.eye);
  // The sum of the absolute values of all that is added up on the way to a point in front of the
  // camera, whatever cancels.
  double parts = 0.0;
  const auto add_up = [&](const glm::dvec3& v, double factor) {
    parts += factor * (std::abs(v.x) + std::abs(v.y) + std::abs(v.z));
  };
  for (int i = 0; i < 3; ++i) add_up(transform[i], std::abs(mesh.middle[i]) + mesh.size);
  add_up(transform[3], 1.0);
  add_up(pose.eye, 1.0);
  bool usable = true;
  // (along - border z) / size of a sector.
  const auto write = [&](const glm::dvec3& along, double border, double size, float* row) {
    const auto value = [&](const glm::dvec3& v) {
      return (glm::dot(along, v) + border * glm::dot(pose.back, v)) / size;
    };
    double reach = std::abs(value(middle));
    row[3] = static_cast<float>(value(middle));
    for (int i = 0; i < 3; ++i) {
      row[i] = static_cast<float>(value(transform[i]));
      reach += std::abs(value(transform[i])) * mesh.size;
      usable = usable && std::isfinite(row[i]);
    }
    // In float: points, factors and what is added are rounded, then come three products and three
    // sums, each 2^-24 of at most `reach`: 9 in all, and 16 are taken. In double: at most 16
    // roundings of 2^-53 of what cancels; 64 are taken. Numbers near float's least lose more.
    constexpr double tiny = std::numeric_limits<float>::denorm_min();
    const double error = 16.0 * 0x1p-24 * reach +
                         64.0 * 0x1p-53 * parts * (1.0 + std::abs(border)) / std::abs(size) +
                         8.0 * tiny * mesh.size + 1e-30;
    usable = usable && reach < 1e30 && error < 1e30;
    return static_cast<float>(error * (1.0 + 0x1p-20));
  };
  SectorRows rows{};
  rows.sectors = static_cast<float>(lines.sectors());
  rows.error_x = write(pose.right, lines.left(), lines.width(), rows.x);
  rows.error_y = write(pose.up, lines.bottom(), lines.height(), rows.y);
  rows.error_z = write(-pose.back, 0.0, 1.0, rows.z);
  if (!usable) {
    rows = {};
    rows.error_z = std::numeric_limits<float>::infinity();  // nothing is in front by so much
  }
  return rows;
}

}  // namespace vislab::backface_culling
#endif
