#include "common/geometry/bounds.h"

#include <cmath>

#include "common/geometry/rounding.h"

namespace vislab {
Plane plane_through(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
  return {normal, -glm::dot(normal, a), std::abs(a.x) + std::abs(a.y) + std::abs(a.z)};
}

bool Aabb::contains(const glm::dvec3& p) const {
  return p.x >= min.x && p.x <= max.x && p.y >= min.y && p.y <= max.y && p.z >= min.z &&
         p.z <= max.z;
}

Aabb bounds_of(std::span<const glm::vec3> points) {
  Aabb box;
  for (const glm::vec3& p : points) box.extend(p);
  return box;
}

Aabb transformed(const Aabb& box, const glm::dmat4x3& transform) {
  if (box.empty()) return box;
  Aabb result;
  for (int row = 0; row < 3; ++row) {
    double low = transform[3][row];
    double high = low;
    double magnitude = std::abs(low);
    for (int column = 0; column < 3; ++column) {
      const double a = transform[column][row] * box.min[column];
      const double b = transform[column][row] * box.max[column];
      low += std::min(a, b);
      high += std::max(a, b);
      magnitude += std::max(std::abs(a), std::abs(b));
    }
    // Three products and three sums in double: at most 6 roundings of the magnitude.
    const double error = 6.0 * std::numeric_limits<double>::epsilon() * magnitude;
    result.min[row] = round_down(low - error);
    result.max[row] = round_up(high + error);
  }
  return result;
}

double half_area(const Aabb& box) {
  if (box.empty()) return 0.0;
  const glm::dvec3 size = glm::dvec3(box.max) - glm::dvec3(box.min);
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

double distance_squared(const Aabb& box, const glm::dvec3& p) {
  const glm::dvec3 gap = glm::max(glm::max(glm::dvec3(box.min) - p, p - glm::dvec3(box.max)), 0.0);
  return glm::dot(gap, gap);
}

Sphere circumscribed(const Aabb& box) {
  if (!box.valid()) return {glm::vec3(0.0F), std::numeric_limits<float>::quiet_NaN()};
  const glm::vec3 center(box.center());
  // The float centre is off the double one: the radius is measured from the float centre.
  const glm::dvec3 c(center);
  const glm::dvec3 reach = glm::max(c - glm::dvec3(box.min), glm::dvec3(box.max) - c);
  return {center,
          round_up(glm::length(reach) * (1.0 + 4.0 * std::numeric_limits<double>::epsilon()))};
}

}  // namespace vislab
