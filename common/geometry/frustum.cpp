#include "common/geometry/frustum.h"

namespace vislab {
Frustum frustum_of(const Camera& camera) {
  const auto& [eye, right, up, back] = camera.pose;
  const Lens& lens = camera.lens;
  const glm::dvec3 forward = -back;
  Frustum frustum;
  // The plane through eye + axis * distance.
  auto set = [&](Frustum::PlaneIndex index, const glm::dvec3& normal, const glm::dvec3& axis,
                 double distance) {
    const glm::dvec3 unit = glm::normalize(normal);
    const glm::dvec3 way = axis * distance;
    frustum.planes[index] = {unit, -glm::dot(unit, eye + way),
                             absolute_sum(eye) + absolute_sum(way)};
  };
  if (lens.projection == Projection::orthographic) {
    set(Frustum::left, right, right, lens.left);
    set(Frustum::right, -right, right, lens.right);
    set(Frustum::bottom, up, up, lens.bottom);
    set(Frustum::top, -up, up, lens.top);
  } else {
    // Each side plane holds the eye and one edge of the window on the near plane.
    set(Frustum::left, right * lens.near_m - forward * lens.left, forward, 0.0);
    set(Frustum::right, -right * lens.near_m + forward * lens.right, forward, 0.0);
    set(Frustum::bottom, up * lens.near_m - forward * lens.bottom, forward, 0.0);
    set(Frustum::top, -up * lens.near_m + forward * lens.top, forward, 0.0);
  }
  set(Frustum::near, forward, forward, lens.near_m);
  if (std::isinf(lens.far_m)) {
    frustum.plane_count = 5;
  } else {
    set(Frustum::far, back, forward, lens.far_m);
  }
  return frustum;
}

Frustum frustum_from_matrix(const glm::dmat4& clip) {
  const glm::dmat4 rows = glm::transpose(clip);
  Frustum frustum;
  const glm::dvec4& w = rows[3];
  // The plane of w + sign * row >= 0.
  auto set = [&](Frustum::PlaneIndex index, double sign, const glm::dvec4& row) {
    const glm::dvec4 sum = w + sign * row;
    const double length = glm::length(glm::dvec3(sum));
    frustum.planes[index] = {glm::dvec3(sum) / length, sum.w / length,
                             (std::abs(w.w) + std::abs(row.w)) / length};
  };
  set(Frustum::left, 1.0, rows[0]);
  set(Frustum::right, -1.0, rows[0]);
  set(Frustum::bottom, 1.0, rows[1]);
  set(Frustum::top, -1.0, rows[1]);
  set(Frustum::near, 1.0, rows[2]);
  const glm::dvec4 far_row = w - rows[2];
  const double scale = glm::length(glm::dvec3(w)) + glm::length(glm::dvec3(rows[2]));
  if (glm::length(glm::dvec3(far_row)) <= 1e-12 * scale) {
    frustum.plane_count = 5;
  } else {
    set(Frustum::far, -1.0, rows[2]);
  }
  return frustum;
}

Frustum frustum_by_corners(const Camera& camera) {
  const auto& [eye, right, up, back] = camera.pose;
  const Lens& lens = camera.lens;
  const bool perspective = lens.projection == Projection::perspective;
  const bool has_far = std::isfinite(lens.far_m);
  const glm::dvec3 forward = -back;
  const auto corner = [&](double x, double y, double distance) {
    const double scale = perspective ? distance / lens.near_m : 1.0;
    return eye + forward * distance + right * (x * scale) + up * (y * scale);
  };
  // The far corners define the planes best. Without them any distance beyond near will do.
  const double far = has_far ? lens.far_m : lens.near_m + std::max(1.0, std::abs(lens.near_m));
  const glm::dvec3 far_left_bottom = corner(lens.left, lens.bottom, far);
  const glm::dvec3 far_left_top = corner(lens.left, lens.top, far);
  const glm::dvec3 far_right_bottom = corner(lens.right, lens.bottom, far);
  const glm::dvec3 far_right_top = corner(lens.right, lens.top, far);
  const glm::dvec3 near_left_bottom = corner(lens.left, lens.bottom, lens.near_m);
  const glm::dvec3 near_right_bottom = corner(lens.right, lens.bottom, lens.near_m);
  const glm::dvec3 near_right_top = corner(lens.right, lens.top, lens.near_m);
  // All side planes of a perspective camera meet in the eye.
  const glm::dvec3 low = perspective ? eye : near_left_bottom;
  const glm::dvec3 high = perspective ? eye : near_right_top;
  Frustum frustum;
  frustum.planes[Frustum::left] = plane_through(low, far_left_bottom, far_left_top);
  frustum.planes[Frustum::right] = plane_through(high, far_right_top, far_right_bottom);
  frustum.planes[Frustum::bottom] = plane_through(low, far_right_bottom, far_left_bottom);
  frustum.planes[Frustum::top] = plane_through(high, far_left_top, far_right_top);
  frustum.planes[Frustum::near] =
      plane_through(near_left_bottom, near_right_top, near_right_bottom);
  if (has_far) {
    frustum.planes[Frustum::far] = plane_through(far_left_bottom, far_right_bottom, far_right_top);
  } else {
    frustum.plane_count = 5;
  }
  return frustum;
}

bool surely_outside(const Plane& plane, const Sphere& sphere) {
  const glm::dvec3 c(sphere.center);
  const double error =
      distance_error(plane, c) + std::numeric_limits<double>::epsilon() * sphere.radius;
  return sphere.radius >= 0.0F && plane.signed_distance(c) + sphere.radius < -error;
}

bool surely_inside(const Plane& plane, const Sphere& sphere) {
  const glm::dvec3 c(sphere.center);
  const double error =
      distance_error(plane, c) + std::numeric_limits<double>::epsilon() * sphere.radius;
  return sphere.radius >= 0.0F && plane.signed_distance(c) - sphere.radius > error;
}

bool touches_near_region(const Camera& camera, const Aabb& box) {
  if (!box.valid()) return true;
  const Lens& lens = camera.lens;
  if (lens.projection == Projection::orthographic) {
    const Plane near_plane = frustum_of(camera).planes[Frustum::near];
    return !surely_inside(near_plane, box);
  }
  const double x = std::max(std::abs(lens.left), std::abs(lens.right));
  const double y = std::max(std::abs(lens.bottom), std::abs(lens.top));
  const double reach = std::sqrt(x * x + y * y + lens.near_m * lens.near_m) * (1.0 + 1e-6);
  return distance_squared(box, camera.pose.eye) <= reach * reach;
}

}  // namespace vislab
