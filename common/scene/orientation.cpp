#include "common/scene/orientation.h"

#include <cmath>
#include <numbers>

namespace vislab {

glm::dmat3 rotation(const glm::dvec3& axis, double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  const glm::dmat3 crossing({0.0, axis.z, -axis.y}, {-axis.z, 0.0, axis.x}, {axis.y, -axis.x, 0.0});
  glm::dmat3 matrix = crossing * s;
  for (int column = 0; column < 3; ++column) {
    matrix[column] += axis * (axis[column] * (1.0 - c));
    matrix[column][column] += c;
  }
  return matrix;
}

glm::dvec3 random_direction(Random& random) {
  const double y = random.uniform(-1.0, 1.0);
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double flat = std::sqrt(1.0 - y * y);
  return {flat * std::cos(angle), y, flat * std::sin(angle)};
}

glm::dmat3 random_rotation(Random& random) {
  // A unit quaternion x i + y j + z k + w, uniform on the sphere of four dimensions.
  const double share = random.uniform();
  const double angle1 = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double angle2 = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double x = std::sqrt(1.0 - share) * std::sin(angle1);
  const double y = std::sqrt(1.0 - share) * std::cos(angle1);
  const double z = std::sqrt(share) * std::sin(angle2);
  const double w = std::sqrt(share) * std::cos(angle2);
  return {{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)},
          {2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)},
          {2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)}};
}

}  // namespace vislab
