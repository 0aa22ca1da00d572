// Bounding volumes by CGAL: the convex hull, and the smallest volumes that the fast ones are
// measured against. All points must be finite; for none, std::logic_error.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "common/geometry/bounds.h"
#include "common/geometry/oriented_box.h"

namespace vislab {

struct Hull {
  std::vector<glm::dvec3> points;     // exactly points of the input, each once
  std::vector<glm::uvec3> triangles;  // counter-clockwise seen from outside; none if flat
};

/// Corners and faces of the convex hull, by exact predicates. Of points in one plane the corners of
/// their convex polygon in its order; of collinear points the two ends; of copies of one point that
/// point. Deterministic. O(n log n): 20 ms for 23,000 points.
Hull convex_hull(std::span<const glm::vec3> points);

/// Radius of the smallest sphere around the points, to double precision. O(n) expected.
double smallest_sphere_radius(std::span<const glm::vec3> points);

/// The box of (nearly) the smallest volume around the points, as CGAL finds it by a search with a
/// fixed seed; rounded outward as box_along() is. For points in a plane covariance_box().
/// Source: Chang, Gorissen and Melchior 2011, Fast Oriented Bounding Box Optimization on the
/// Rotation Group SO(3,R).
OrientedBox smallest_box(std::span<const glm::vec3> points);

}  // namespace vislab
