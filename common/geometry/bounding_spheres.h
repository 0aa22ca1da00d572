// Spheres around points. All enclose their points in exact arithmetic.
#pragma once

#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <span>

#include "common/geometry/bounds.h"

namespace vislab {

/// Around the centre of the points' box through the farthest point. The points must be finite; for
/// none the radius is -1, which contains nothing and is never culled. O(n).
Sphere farthest_point_sphere(std::span<const glm::vec3> points);

/// Two passes: the farthest of the extreme pairs along the axes, then growing; a third makes the
/// radius the distance of the farthest point, since growing adds up its rounding. O(n), about 5 %
/// larger than the smallest. Points as above.
/// Source: Ritter 1990, An Efficient Bounding Sphere; Kowalka 2016, 2.6.1.
Sphere ritter_sphere(std::span<const glm::vec3> points);

/// A sphere around the sphere's image under an affine transform (its radius grows with the
/// transform's greatest stretch). Rounded outward. A sphere that contains nothing stays so.
Sphere transformed(const Sphere& sphere, const glm::dmat4x3& transform);

}  // namespace vislab
