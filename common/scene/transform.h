// What a transform must be to place an object.
#pragma once

#include <glm/mat4x3.hpp>
#include <string>

namespace vislab {

/// Throws InputError, beginning with `where`, unless all numbers are finite and the determinant is
/// positive and not tiny beside the lengths of the axes. A mirror is refused because it would turn
/// front faces into back faces; importers fold it into the mesh.
void require_placing_transform(const glm::dmat4x3& transform, const std::string& where);

}  // namespace vislab
