#include "common/geometry/frustum_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vislab {
FrustumFilter::FrustumFilter(const Frustum& frustum, const glm::vec3& origin, float extent)
    : count_(frustum.plane_count) {
  // Rounding to nearest is off by at most half of epsilon. Of each of the four terms: one rounding
  // of the plane, one of the coordinate, and four of the sum. Eight leave room for what is of
  // second order.
  constexpr double float_roundings = 8.0 * 0.5 * std::numeric_limits<float>::epsilon();
  // The double test's own error bound is 16 epsilon (distance_error in frustum.h), on either side
  // of its threshold; as much again covers the shift to the origin.
  constexpr double double_roundings = 64.0 * std::numeric_limits<double>::epsilon();
  // Far below any scene's precision, and large enough that products with the scaled planes do not
  // underflow to something that matters.
  constexpr double smallest_margin = 1e-30;
  const glm::dvec3 shift(origin);
  for (int i = 0; i < count_; ++i) {
    const Plane& plane = frustum.planes[static_cast<std::size_t>(i)];
    const double d = plane.d + glm::dot(plane.normal, shift);
    const double farthest = absolute_sum(shift) + 3.0 * static_cast<double>(extent) +
                            std::max(std::abs(plane.d), plane.magnitude);
    const double margin = std::max(
        smallest_margin, float_roundings * (absolute_sum(plane.normal) * extent + std::abs(d)) +
                             double_roundings * farthest);
    planes_[static_cast<std::size_t>(i)] = {
        static_cast<float>(plane.normal.x / margin), static_cast<float>(plane.normal.y / margin),
        static_cast<float>(plane.normal.z / margin), static_cast<float>(d / margin)};
  }
}

}  // namespace vislab
