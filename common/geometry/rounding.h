// Conversions from double to float that round to a chosen side, for volumes that must enclose, or
// that round surely.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace vislab {

/// The greatest float that is not above the value; NaN stays NaN.
inline float round_down(double value) {
  const auto rounded = static_cast<float>(value);
  return rounded > value ? std::nextafter(rounded, -std::numeric_limits<float>::infinity())
                         : rounded;
}

/// The smallest float that is not below the value; NaN stays NaN.
inline float round_up(double value) {
  const auto rounded = static_cast<float>(value);
  return rounded < value ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
                         : rounded;
}

/// The nearest floats, as doubles. Kept from the compiler's sight, because g++ 12 at -O2 and above
/// leaves the rounding out of glm::dvec3(glm::vec3(v)).
inline glm::dvec3 rounded_to_float(const glm::dvec3& v) {
  const volatile float x = static_cast<float>(v.x);
  const volatile float y = static_cast<float>(v.y);
  const volatile float z = static_cast<float>(v.z);
  return {x, y, z};
}

}  // namespace vislab
