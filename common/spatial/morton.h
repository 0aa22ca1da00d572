// Order along the Z curve: what is near in space is mostly near in the order.
//
// Source: Morton 1966; for building hierarchies Lauterbach et al. 2009.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/bounds.h"

namespace vislab {

/// A point of the Z curve and what lies there.
struct MortonKey {
  std::uint32_t code = 0;  // 30 bits, 10 of each axis, x lowest
  std::uint32_t index = 0;
};

/// Codes of points within a box, which is cut into 1024 cells along each axis.
class MortonGrid {
 public:
  /// Without extent along an axis, all points have the same cell there.
  explicit MortonGrid(const Aabb& domain);
  /// Points outside of the domain have the nearest cell's code. Not for NaN.
  std::uint32_t code(const glm::vec3& p) const;

 private:
  glm::vec3 low_;
  glm::vec3 cells_per_m_;
};

/// Sorts by code; equal codes keep their order. `scratch` is memory that is used again. O(n).
void sort_by_code(std::vector<MortonKey>& keys, std::vector<MortonKey>& scratch);

}  // namespace vislab
