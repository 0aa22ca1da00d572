// Idea: the centres of the near and the far window lie along the view; their corners lie half a
// width
//   and half a height beside them; each side plane holds the eye and two far corners.
// Guarantee: equal to frustum_of() but for rounding. With an error switched on: a wrong frustum,
// kept
//   as a negative control.
// Source: Kowalka 2016, 4.2.1: equations 4.1 to 4.6, algorithm 1, figure 3.4.
#include "common/geometry/thesis_frustum.h"

#include <cmath>
#include <numbers>

namespace vislab {
namespace {

Plane plane_at(const glm::dvec3& normal, const glm::dvec3& point) {
  return {normal, -glm::dot(normal, point),
          std::abs(point.x) + std::abs(point.y) + std::abs(point.z)};
}

}  // namespace

ThesisFrustum thesis_frustum(const ThesisCamera& camera, const ThesisErrors& errors) {
  const glm::dvec3 view = camera.reference - camera.eye;
  const glm::dvec3 forward = glm::normalize(view);
  glm::dvec3 right = glm::cross(camera.up, -view);  // 4.4
  glm::dvec3 up = camera.up;
  if (!errors.up_as_given) {
    right = glm::normalize(right);
    up = glm::cross(right, forward);
  }
  const double angle =
      errors.angle_in_degrees ? camera.angle_deg : camera.angle_deg * std::numbers::pi / 180.0;

  ThesisFrustum result;
  std::array<glm::dvec3, 8>& corners = result.corners;
  std::array<glm::dvec3, 2> centers;
  std::size_t corner = 0;
  for (const double distance : {camera.near_m, camera.far_m}) {
    const glm::dvec3 center =
        camera.eye + (errors.direction_not_normalised ? view : forward) * distance;  // 4.1
    centers[corner / 4] = center;
    const double height = 2.0 * std::tan(angle / 2.0) * distance;  // 4.2
    const double width = height * camera.aspect;
    for (const double y : {0.5, -0.5}) {
      for (const double x : {-0.5, 0.5}) {
        corners[corner++] = center + up * (height * y) + right * (width * x);  // 4.3
      }
    }
  }

  std::array<Plane, 6>& planes = result.frustum.planes;
  using Corner = ThesisFrustum;
  planes[Frustum::near] = plane_at(forward, centers[0]);  // 4.5
  planes[Frustum::far] = plane_at(-forward, centers[1]);  // 4.6
  const auto side = [&](Corner::Corner first, Corner::Corner second) {
    return plane_through(camera.eye, corners[first], corners[second]);
  };
  planes[Frustum::left] = side(Corner::far_bottom_left, Corner::far_top_left);
  planes[Frustum::right] = side(Corner::far_top_right, Corner::far_bottom_right);
  planes[Frustum::bottom] = side(Corner::far_bottom_right, Corner::far_bottom_left);
  planes[Frustum::top] = side(Corner::far_top_left, Corner::far_top_right);
  return result;
}

}  // namespace vislab
