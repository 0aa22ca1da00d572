// Directions and rotations, given and random.
#pragma once

#include <glm/glm.hpp>

#include "common/geometry/random.h"

namespace vislab {

/// Rotation about a unit axis, counter-clockwise as seen by one whom the axis points at
/// (Rodrigues).
glm::dmat3 rotation(const glm::dvec3& axis, double angle_rad);

/// A unit vector, uniform over the sphere (Archimedes: heights are uniform).
glm::dvec3 random_direction(Random& random);

/// An orientation, uniform over all rotations (Shoemake, "Uniform random rotations", 1992).
glm::dmat3 random_rotation(Random& random);

}  // namespace vislab
