#include "common/geometry/convex_polygon.h"

#include <cmath>

namespace vislab {

ConvexPolygon square_on(const Plane& plane, const glm::dvec3& around, double reach) {
  const glm::dvec3 n = glm::normalize(plane.normal);
  const glm::dvec3 middle =
      around - n * (plane.signed_distance(around) / glm::length(plane.normal));
  const glm::dvec3 other = std::abs(n.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(other, n)) * reach;
  const glm::dvec3 v = glm::cross(n, u);
  return {middle - u - v, middle + u - v, middle + u + v, middle - u + v};
}

PolygonHalves divided(const ConvexPolygon& polygon, const Plane& plane, double tolerance) {
  PolygonHalves halves;
  bool any_inside = false;
  bool any_outside = false;
  glm::dvec3 before = polygon.empty() ? glm::dvec3(0.0) : polygon.back();
  double distance_before = plane.signed_distance(before);
  for (const glm::dvec3& corner : polygon) {
    const double distance = plane.signed_distance(corner);
    if ((distance > tolerance && distance_before < -tolerance) ||
        (distance < -tolerance && distance_before > tolerance)) {
      const glm::dvec3 cut =
          before + (corner - before) * (distance_before / (distance_before - distance));
      halves.inside.push_back(cut);
      halves.outside.push_back(cut);
    }
    if (distance >= -tolerance) halves.inside.push_back(corner);
    if (distance <= tolerance) halves.outside.push_back(corner);
    any_inside = any_inside || distance > tolerance;
    any_outside = any_outside || distance < -tolerance;
    before = corner;
    distance_before = distance;
  }
  if (!any_inside) halves.inside.clear();
  if (!any_outside) halves.outside.clear();
  return halves;
}

glm::dvec3 area_vector(const ConvexPolygon& polygon) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    sum += glm::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  }
  return sum;
}

}  // namespace vislab
