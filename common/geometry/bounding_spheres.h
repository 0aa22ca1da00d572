// Spheres around points. All enclose their points in exact arithmetic.
#pragma once

#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <span>

#include "common/geometry/bounds.h"

namespace vislab {

/// Around the centre of the points' box through the farthest point.
Sphere farthest_point_sphere(std::span<const glm::vec3> points);

/// Two passes: the farthest of the extreme pairs along the axes, then growing. O(n), about 5 % larger
/// than the smallest. Source: Ritter 1990, An Efficient Bounding Sphere; Kowalka 2016, 2.6.1.
Sphere ritter_sphere(std::span<const glm::vec3> points);

/// A sphere around the sphere's image under an affine transform (its radius grows with the
/// transform's greatest stretch). Rounded outward.
Sphere transformed(const Sphere& sphere, const glm::dmat4x3& transform);

}  // namespace vislab
