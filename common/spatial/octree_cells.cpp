#include "common/spatial/octree_cells.h"

#include <algorithm>
#include <cmath>

namespace vislab {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float largest = std::numeric_limits<float>::max();

/// A float below a sum that was made with a few roundings of double, but never below -largest.
float below(double value) {
  const auto nearest = static_cast<float>(std::clamp<double>(value, -largest, largest));
  return std::max(std::nextafter(nearest, -infinity), -largest);
}

float above(double value) { return -below(-value); }

}  // namespace

Aabb root_cube(const Aabb& box) {
  if (box.empty()) return {};
  const glm::dvec3 center = box.center();
  const glm::dvec3 edges = box.half_size();
  const double half = std::max({edges.x, edges.y, edges.z});
  Aabb cube = box;
  for (int axis = 0; axis < 3; ++axis) {
    cube.min[axis] = std::min(box.min[axis],
                              static_cast<float>(std::max<double>(center[axis] - half, -largest)));
    cube.max[axis] =
        std::max(box.max[axis], static_cast<float>(std::min<double>(center[axis] + half, largest)));
  }
  return cube;
}

glm::vec3 middle_of(const Aabb& cell) { return glm::vec3(cell.center()); }

bool can_halve(const Aabb& cell) {
  const glm::vec3 middle = middle_of(cell);
  return glm::all(glm::lessThan(cell.min, middle)) && glm::all(glm::lessThan(middle, cell.max));
}

Aabb octant(const Aabb& cell, unsigned i) {
  const glm::vec3 middle = middle_of(cell);
  Aabb result = cell;
  for (int axis = 0; axis < 3; ++axis) {
    const bool upper = ((i >> static_cast<unsigned>(axis)) & 1U) != 0;
    (upper ? result.min : result.max)[axis] = middle[axis];
  }
  return result;
}

Aabb enlarged(const Aabb& box, double by) {
  Aabb result = box;
  if (by == 0.0) return result;
  for (int axis = 0; axis < 3; ++axis) {
    result.min[axis] = below(box.min[axis] - by);
    result.max[axis] = above(box.max[axis] + by);
  }
  return result;
}

}  // namespace vislab
