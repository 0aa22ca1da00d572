// Containment in exact arithmetic. For tests.
#pragma once

#include "common/geometry/bounds.h"
#include "common/geometry/oriented_box.h"

namespace vislab::test {

/// Is the point in the closed volume? The axes of a box without volume must be exactly orthogonal.
bool exactly_contains(const Sphere& sphere, const glm::dvec3& point);
bool exactly_contains(const OrientedBox& box, const glm::dvec3& point);

/// Is the exact image of the point center + half_axes * t of the box in the other box?
bool exactly_contains_image(const OrientedBox& image, const OrientedBox& box, const glm::dvec3& t,
                            const glm::dmat4x3& transform);

/// Is the exact image of the point center + radius * t of the sphere, |t| <= 1, in the other
/// sphere?
bool exactly_contains_image(const Sphere& image, const Sphere& sphere, const glm::dvec3& t,
                            const glm::dmat4x3& transform);

}  // namespace vislab::test
