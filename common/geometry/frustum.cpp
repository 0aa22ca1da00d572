#include "common/geometry/frustum.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vislab {
namespace {

double absolute_sum(const glm::dvec3& p) { return std::abs(p.x) + std::abs(p.y) + std::abs(p.z); }

/// Bound on the error of n.p + d in double for a point with float coordinates: the plane's own
/// rounding (normal and d each carry a few ulp from the camera) and seven operations. Each part of
/// the unit normal may be off by a few ulp of 1, however small it is itself: p counts in full.
double distance_error(const Plane& plane, const glm::dvec3& p) {
  const double magnitude = absolute_sum(p) + std::max(std::abs(plane.d), plane.magnitude);
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
  const double error =
      distance_error(plane, c) + std::numeric_limits<double>::epsilon() * sphere.radius;
  return plane.signed_distance(c) + sphere.radius < -error;
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
