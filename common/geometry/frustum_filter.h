// The planes of a view frustum in float, with a margin: a fast filter in front of the exact-enough
// double test of frustum.h, for kernels that look at many boxes.
//
// Idea: boxes are kept as float coordinates relative to an origin near them, none farther from it
//   than a known extent in any coordinate. That bounds every rounding error of n.p + d by one
//   constant a plane, the margin. The planes are scaled so that all margins are 1.
// Guarantee: a corner that is farthest along the normal (p-vertex) with a value below -1 means that
//   surely_outside() is true of this plane for the box and for every box inside it. A p-vertex
//   above 1 means that it is false for the box; a corner that is nearest along the normal
//   (n-vertex) above 1 means that it is false for the box and every box inside it. Nothing is known
//   in between, and nothing of NaN, which compares false.
// Cost: three multiplications and three additions a plane and box.
// Limits: the margin grows with the extent: about 1e-6 of it.
// Source: error bounds of dot products, Higham, Accuracy and Stability of Numerical Algorithms,
//   2002, 3.1.
#pragma once

#include <array>
#include <span>

#include "common/geometry/frustum.h"

namespace vislab {

/// n.p + d of a point p relative to the origin, divided by the margin.
struct FilterPlane {
  float x = 0.0F, y = 0.0F, z = 0.0F;  // the scaled normal
  float d = 0.0F;

  /// In float; the sum may be taken in any order and with or without fused operations.
  float value(float px, float py, float pz) const { return x * px + (y * py + (z * pz + d)); }
};

class FrustumFilter {
 public:
  FrustumFilter() = default;
  /// For boxes whose float coordinates minus `origin`, rounded to float, are at most `extent` in
  /// absolute value. All finite, extent >= 0. The planes are frustum_of's (see surely_outside).
  FrustumFilter(const Frustum& frustum, const glm::vec3& origin, float extent);

  /// In the order of the frustum's: 5 or 6.
  std::span<const FilterPlane> planes() const {
    return {planes_.data(), static_cast<std::size_t>(count_)};
  }

 private:
  std::array<FilterPlane, 6> planes_{};
  int count_ = 0;
};

}  // namespace vislab
