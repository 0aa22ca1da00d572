// Boxes of any orientation.
#pragma once

#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <span>

#include "common/geometry/bounds.h"

namespace vislab {

/// All points center + half_axes * t with |t| <= 1 in each component. The half-axes are orthogonal
/// for a box that was made around points; an affine transform may skew them.
struct OrientedBox {
  glm::dvec3 center{0.0};
  glm::dmat3 half_axes{0.0};  // one half-axis a column

  double volume() const;  // cubic metres
};

/// The same box, a few ulp larger at most; all NaN, which no test culls, if it is not valid.
OrientedBox oriented(const Aabb& box);

/// Smallest box along given orthonormal axes (columns) around points. Rounded outward: a flat set
/// gets a box that is thicker by a few ulp of its size and distance from the origin; copies of a
/// single point get that point. The points must be finite; for none all of the box is NaN, which no
/// test culls. O(n).
OrientedBox box_along(const glm::dmat3& axes, std::span<const glm::vec3> points);

/// Box along the eigenvectors of the covariance of the surface of the points' convex hull,
/// equations 2.2 to 2.6 of the thesis. Planar and collinear points give a flat box. O(n log n).
/// Points as above. Where the hull spreads alike in several directions (a cube) the eigenvectors
/// are arbitrary and the box may be much larger than the smallest. Source: Gottschalk, Lin and
/// Manocha 1996; Kowalka 2016, 2.6.1.
OrientedBox covariance_box(std::span<const glm::vec3> points);

/// The box (a parallelepiped if the transform shears) after an affine transform, rounded outward.
/// If it is squeezed so flat that its edges no longer tell directions, a box around it.
OrientedBox transformed(const OrientedBox& box, const glm::dmat4x3& transform);

}  // namespace vislab
