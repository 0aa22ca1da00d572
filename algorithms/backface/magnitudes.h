// How large vectors and matrices are, as error bounds measure it, and powers of two to scale by.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace vislab::backface_culling {

/// Largest absolute coordinate.
inline double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Largest sum of a row's absolute values: what a matrix makes of errors at most.
inline double row_sum(const glm::dmat3& m) {
  return largest(glm::abs(m[0]) + glm::abs(m[1]) + glm::abs(m[2]));
}

/// The least power of two that is no less than `value`, a finite number; 1 for 0.
inline double power_of_two_from(double value) {
  if (!(value > 0.0)) return 1.0;
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return std::ldexp(1.0, fraction == 0.5 ? exponent - 1 : exponent);
}

}  // namespace vislab::backface_culling
