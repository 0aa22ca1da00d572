#include "common/geometry/frustum.h"

#include <cmath>

namespace vislab {
namespace {

/// Bound on the error of n.p + d in double for a point with float coordinates: the plane's own
/// rounding (normal and d each carry a few ulp from the camera) and seven operations.
double distance_error(const Plane& plane, const glm::dvec3& p) {
  const double magnitude = std::abs(plane.normal.x * p.x) + std::abs(plane.normal.y * p.y) +
                           std::abs(plane.normal.z * p.z) + std::abs(plane.d);
  return 16.0 * std::numeric_limits<double>::epsilon() * magnitude;
}

glm::dvec3 p_vertex(const Plane& plane, const Aabb& box) {
  return {plane.normal.x >= 0.0 ? box.max.x : box.min.x,
          plane.normal.y >= 0.0 ? box.max.y : box.min.y,
          plane.normal.z >= 0.0 ? box.max.z : box.min.z};
}

glm::dvec3 n_vertex(const Plane& plane, const Aabb& box) {
  return {plane.normal.x >= 0.0 ? box.min.x : box.max.x,
          plane.normal.y >= 0.0 ? box.min.y : box.max.y,
          plane.normal.z >= 0.0 ? box.min.z : box.max.z};
}

}  // namespace

Frustum frustum_of(const Camera& camera) {
  const auto& [eye, right, up, back] = camera.pose;
  const Lens& lens = camera.lens;
  const glm::dvec3 forward = -back;
  Frustum frustum;
  auto set = [&](Frustum::PlaneIndex index, const glm::dvec3& normal, const glm::dvec3& point) {
    const glm::dvec3 unit = glm::normalize(normal);
    frustum.planes[index] = {unit, -glm::dot(unit, point)};
  };
  if (lens.projection == Projection::orthographic) {
    set(Frustum::left, right, eye + right * lens.left);
    set(Frustum::right, -right, eye + right * lens.right);
    set(Frustum::bottom, up, eye + up * lens.bottom);
    set(Frustum::top, -up, eye + up * lens.top);
  } else {
    // Each side plane holds the eye and one edge of the window on the near plane.
    set(Frustum::left, right * lens.near_m - forward * lens.left, eye);
    set(Frustum::right, -right * lens.near_m + forward * lens.right, eye);
    set(Frustum::bottom, up * lens.near_m - forward * lens.bottom, eye);
    set(Frustum::top, -up * lens.near_m + forward * lens.top, eye);
  }
  set(Frustum::near, forward, eye + forward * lens.near_m);
  if (std::isinf(lens.far_m)) {
    frustum.plane_count = 5;
  } else {
    set(Frustum::far, back, eye + forward * lens.far_m);
  }
  return frustum;
}

Frustum frustum_from_matrix(const glm::dmat4& clip) {
  const glm::dmat4 rows = glm::transpose(clip);
  Frustum frustum;
  auto set = [&](Frustum::PlaneIndex index, const glm::dvec4& row) {
    const double length = glm::length(glm::dvec3(row));
    frustum.planes[index] = {glm::dvec3(row) / length, row.w / length};
  };
  set(Frustum::left, rows[3] + rows[0]);
  set(Frustum::right, rows[3] - rows[0]);
  set(Frustum::bottom, rows[3] + rows[1]);
  set(Frustum::top, rows[3] - rows[1]);
  set(Frustum::near, rows[3] + rows[2]);
  const glm::dvec4 far_row = rows[3] - rows[2];
  const double scale = glm::length(glm::dvec3(rows[3])) + glm::length(glm::dvec3(rows[2]));
  if (glm::length(glm::dvec3(far_row)) <= 1e-12 * scale) {
    frustum.plane_count = 5;
  } else {
    set(Frustum::far, far_row);
  }
  return frustum;
}

bool surely_outside(const Plane& plane, const Aabb& box) {
  const glm::dvec3 p = p_vertex(plane, box);
  // Written so that NaN bounds answer false: nothing is concluded from a broken box.
  return box.valid() && plane.signed_distance(p) < -distance_error(plane, p);
}

bool surely_inside(const Plane& plane, const Aabb& box) {
  const glm::dvec3 n = n_vertex(plane, box);
  return box.valid() && plane.signed_distance(n) > distance_error(plane, n);
}

bool surely_outside(const Plane& plane, const Sphere& sphere) {
  const glm::dvec3 c(sphere.center);
  return plane.signed_distance(c) + sphere.radius < -distance_error(plane, c);
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
