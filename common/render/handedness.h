// Which way triangles turn in the window, for devices that leave out those seen from behind. For
// .cpp files of this folder only.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>

namespace vislab {

/// The sign of the transform's determinant; 0 if rounding its entries and what it transforms to
/// float may turn it: the object is then to be drawn on both sides.
inline double handedness(const glm::dmat4x3& m) {
  const glm::dvec3 forward(m[1].y * m[2].z, m[1].z * m[2].x, m[1].x * m[2].y);
  const glm::dvec3 backward(m[1].z * m[2].y, m[1].x * m[2].z, m[1].y * m[2].x);
  const double determinant = glm::dot(m[0], forward - backward);
  const double size = glm::dot(glm::abs(m[0]), glm::abs(forward) + glm::abs(backward));
  constexpr double rounding = 1e-5;
  return std::abs(determinant) > rounding * size ? determinant : 0.0;
}

}  // namespace vislab
