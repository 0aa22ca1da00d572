// What a transform must be to place an object.
#pragma once

#include <glm/mat4x3.hpp>
#include <string>

namespace vislab {

/// Signed volume of the unit cube under the linear part; negative for a mirror.
double determinant(const glm::dmat4x3& transform);

/// Throws InputError, beginning with `where`, unless all numbers are finite and the determinant is
/// not tiny beside the lengths of the axes. Mirrors are allowed: the outside of a mesh stays its
/// outside, only the order of its vertices in the world turns round.
void require_placing_transform(const glm::dmat4x3& transform, const std::string& where);

}  // namespace vislab
