// Bounding volumes by CGAL: the convex hull, and the smallest volumes that the fast ones are measured
// against.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "common/geometry/bounds.h"
#include "common/geometry/oriented_box.h"

namespace vislab {

struct Hull {
  std::vector<glm::dvec3> points;
  std::vector<glm::uvec3> triangles;  // outward; none if the points are planar
};
Hull convex_hull(std::span<const glm::vec3> points);

/// Radius of the smallest sphere around the points, to double precision.
double smallest_sphere_radius(std::span<const glm::vec3> points);

/// The box of (nearly) the smallest volume around the points, as CGAL finds it.
OrientedBox smallest_box(std::span<const glm::vec3> points);

}  // namespace vislab
