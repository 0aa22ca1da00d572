#include "common/geometry/camera.h"

#include <cmath>

namespace vislab {

Pose look_at(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up) {
  Pose pose;
  pose.eye = eye;
  pose.back = glm::normalize(eye - target);
  glm::dvec3 vertical = up;
  if (glm::length(glm::cross(vertical, pose.back)) < 1e-9 * glm::length(vertical)) {
    vertical = std::abs(pose.back.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0);
  }
  pose.right = glm::normalize(glm::cross(vertical, pose.back));
  pose.up = glm::cross(pose.back, pose.right);
  return pose;
}

Lens perspective_lens(double fov_y_rad, double aspect, double near_m, double far_m) {
  const double top = near_m * std::tan(0.5 * fov_y_rad);
  const double right = top * aspect;
  return {Projection::perspective, -right, right, -top, top, near_m, far_m};
}

Lens orthographic_lens(double height_m, double aspect, double near_m, double far_m) {
  const double top = 0.5 * height_m;
  const double right = top * aspect;
  return {Projection::orthographic, -right, right, -top, top, near_m, far_m};
}

glm::dmat4 Camera::view() const {
  const auto& [eye, right, up, back] = pose;
  glm::dmat4 m(1.0);
  m[0] = {right.x, up.x, back.x, 0.0};
  m[1] = {right.y, up.y, back.y, 0.0};
  m[2] = {right.z, up.z, back.z, 0.0};
  m[3] = {-glm::dot(right, eye), -glm::dot(up, eye), -glm::dot(back, eye), 1.0};
  return m;
}

glm::dmat4 Camera::projection() const {
  const double width = lens.right - lens.left;
  const double height = lens.top - lens.bottom;
  glm::dmat4 m(0.0);
  if (lens.projection == Projection::orthographic) {
    const double depth = lens.far_m - lens.near_m;
    m[0][0] = 2.0 / width;
    m[1][1] = 2.0 / height;
    m[2][2] = -2.0 / depth;
    m[3] = {-(lens.right + lens.left) / width, -(lens.top + lens.bottom) / height,
            -(lens.far_m + lens.near_m) / depth, 1.0};
    return m;
  }
  m[0][0] = 2.0 * lens.near_m / width;
  m[1][1] = 2.0 * lens.near_m / height;
  m[2][0] = (lens.right + lens.left) / width;
  m[2][1] = (lens.top + lens.bottom) / height;
  m[2][3] = -1.0;
  if (std::isinf(lens.far_m)) {
    m[2][2] = -1.0;
    m[3][2] = -2.0 * lens.near_m;
  } else {
    const double depth = lens.far_m - lens.near_m;
    m[2][2] = -(lens.far_m + lens.near_m) / depth;
    m[3][2] = -2.0 * lens.far_m * lens.near_m / depth;
  }
  return m;
}

Ray Camera::ray(const glm::dvec2& window) const {
  const double x = lens.left + (lens.right - lens.left) * window.x;
  const double y = lens.bottom + (lens.top - lens.bottom) * window.y;
  if (lens.projection == Projection::orthographic) {
    return {pose.eye + pose.right * x + pose.up * y, -pose.back};
  }
  return {pose.eye, pose.right * (x / lens.near_m) + pose.up * (y / lens.near_m) - pose.back};
}

}  // namespace vislab
