#include "algorithms/backface/normal_cone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/geometry/rounding.h"

namespace vislab::backface_culling {
namespace {

/// Of the greatest angle between a cone's axis and its normals.
constexpr double least_cosine = 0.05;

/// A cap of the unit sphere: the directions p with axis . p >= cosine.
struct Cap {
  glm::dvec3 axis{0.0};
  double cosine = 2.0;

  bool holds(const glm::dvec3& p) const { return glm::dot(axis, p) >= cosine - 1e-12; }
};

Cap cap_through(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 sum = a + b;
  const double length = glm::length(sum);
  if (!(length > 1e-12)) return {a, -1.0};
  return {sum / length, glm::dot(sum, a) / length};
}

Cap cap_through(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double length = glm::length(normal);
  // Three points of the sphere on a line are two points.
  if (!(length > 1e-15)) return cap_through(a, glm::dot(a, b) < glm::dot(a, c) ? b : c);
  const double side = glm::dot(normal, a) < 0.0 ? -1.0 : 1.0;
  return {normal * (side / length), std::abs(glm::dot(normal, a)) / length};
}

/// Welzl's smallest circle, written as loops, on the sphere.
Cap smallest_cap(std::span<const glm::dvec4> planes) {
  const auto p = [&](std::size_t i) { return glm::dvec3(planes[i]); };
  Cap cap{p(0), 1.0};
  for (std::size_t i = 1; i < planes.size(); ++i) {
    if (cap.holds(p(i))) continue;
    cap = {p(i), 1.0};
    for (std::size_t j = 0; j < i; ++j) {
      if (cap.holds(p(j))) continue;
      cap = cap_through(p(i), p(j));
      for (std::size_t k = 0; k < j; ++k) {
        if (!cap.holds(p(k))) cap = cap_through(p(i), p(j), p(k));
      }
    }
  }
  return cap;
}

/// Three directions square to the axis and 120 degrees apart.
std::array<glm::dvec3, 3> around(const glm::dvec3& axis) {
  const glm::dvec3 size = glm::abs(axis);
  const glm::dvec3 other = size.x <= size.y && size.x <= size.z ? glm::dvec3(1.0, 0.0, 0.0)
                           : size.y <= size.z                   ? glm::dvec3(0.0, 1.0, 0.0)
                                                                : glm::dvec3(0.0, 0.0, 1.0);
  const glm::dvec3 u = glm::normalize(glm::cross(axis, other));
  const glm::dvec3 v = glm::cross(axis, u);
  const double half_root = std::sqrt(0.75);
  return {u, -0.5 * u + half_root * v, -0.5 * u - half_root * v};
}

/// How far down along the axis a point has to go until side * (n.p + d) <= -distance for all
/// planes.
double way_down(std::span<const glm::dvec4> planes, const glm::dvec3& axis, double side,
                const glm::dvec3& point, double distance) {
  double down = 0.0;
  for (const glm::dvec4& plane : planes) {
    const double above = side * (glm::dot(glm::dvec3(plane), point) + plane.w) + distance;
    if (above > 0.0) down = std::max(down, above / (side * glm::dot(glm::dvec3(plane), axis)));
  }
  return down;
}

/// A point with a great axis . p among those with side * (n.p + d) <= 0 for all planes, by the dual
/// simplex method: three planes whose normals the axis is a positive combination of hold the point;
/// the plane that it violates most takes the place of one of them. It starts from a pyramid over
/// the origin. Of all points on the way, straightened by going down the axis, the highest is taken
/// that is not far away: nearly parallel planes meet anywhere.
glm::dvec3 highest_point(std::span<const glm::dvec4> planes, const glm::dvec3& axis, double side,
                         double reach) {
  const std::array<glm::dvec3, 3> sideways = around(axis);
  glm::dmat3 normals(0.0);  // columns
  glm::dvec3 offsets(-reach);
  glm::dvec3 weights(1.0 / 3.0);  // normals * weights = axis
  for (int i = 0; i < 3; ++i) normals[i] = axis + sideways[static_cast<std::size_t>(i)];
  glm::dvec3 point = axis * reach;
  glm::dvec3 best(0.0);
  double best_height = -std::numeric_limits<double>::infinity();
  constexpr int most_steps = 40;
  for (int step = 0; step < most_steps; ++step) {
    if (glm::length(point) < 8.0 * reach) {
      const glm::dvec3 valid = point - axis * way_down(planes, axis, side, point, 0.0);
      if (glm::dot(axis, valid) > best_height) {
        best_height = glm::dot(axis, valid);
        best = valid;
      }
    }
    double worst = 1e-12 * reach;
    const glm::dvec4* entering = nullptr;
    for (const glm::dvec4& plane : planes) {
      const double above = side * (glm::dot(glm::dvec3(plane), point) + plane.w);
      if (above > worst) {
        worst = above;
        entering = &plane;
      }
    }
    if (entering == nullptr) break;
    const glm::dvec3 shares = glm::inverse(normals) * (side * glm::dvec3(*entering));
    int leaving = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      if (shares[i] > 1e-12 && weights[i] / shares[i] < least) {
        least = weights[i] / shares[i];
        leaving = i;
      }
    }
    if (leaving < 0) break;
    weights -= least * shares;
    weights[leaving] = least;
    normals[leaving] = side * glm::dvec3(*entering);
    offsets[leaving] = side * entering->w;
    if (!(std::abs(glm::determinant(normals)) > 1e-12)) break;
    point = glm::inverse(glm::transpose(normals)) * -offsets;
  }
  return best;
}

glm::dvec3 apex(std::span<const glm::dvec4> planes, const glm::dvec3& axis, double side,
                double reach, double spare) {
  const glm::dvec3 point = highest_point(planes, axis, side, reach);
  // Going down changes its length, by far less than twice.
  const double distance = 2.0 * spare * (reach + glm::length(point));
  return point - axis * way_down(planes, axis, side, point, distance);
}

}  // namespace

NormalCone cone_around(const glm::dvec3& axis, std::span<const glm::dvec4> planes) {
  NormalCone cone{glm::normalize(axis), 0.0};
  for (const glm::dvec4& plane : planes) {
    const glm::dvec3 normal(plane);
    if (!(glm::dot(cone.axis, normal) > least_cosine)) return {};
    cone.sine = std::max(cone.sine, glm::length(glm::cross(cone.axis, normal)));
  }
  return cone;
}

NormalCone smallest_cone(std::span<const glm::dvec4> planes) {
  if (planes.empty()) return {};
  return cone_around(smallest_cap(planes).axis, planes);
}

glm::dvec3 merged_axis(const NormalCone& a, const NormalCone& b) {
  const double between = std::acos(std::clamp(glm::dot(a.axis, b.axis), -1.0, 1.0));
  const double angle_a = std::asin(a.sine);
  const double angle_b = std::asin(b.sine);
  if (between + angle_b <= angle_a) return a.axis;
  if (between + angle_a <= angle_b) return b.axis;
  const glm::dvec3 sideways = b.axis - glm::dot(a.axis, b.axis) * a.axis;
  const double length = glm::length(sideways);
  if (!(length > 1e-12)) return a.axis;
  const double turn = 0.5 * (between + angle_b - angle_a);
  // Rounded, so that it does not depend on the last digit of a machine's sines.
  return rounded_to_float(std::cos(turn) * a.axis + std::sin(turn) * (sideways / length));
}

glm::dvec3 apex_behind(std::span<const glm::dvec4> planes, const glm::dvec3& axis, double reach,
                       double spare) {
  return apex(planes, axis, 1.0, reach, spare);
}

glm::dvec3 apex_in_front(std::span<const glm::dvec4> planes, const glm::dvec3& axis, double reach,
                         double spare) {
  return apex(planes, -axis, -1.0, reach, spare);
}

}  // namespace vislab::backface_culling
