// Conversions from double to float that round to a chosen side, for volumes that must enclose.
#pragma once

#include <cmath>
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

}  // namespace vislab
