// Idea: a centre is found in one or two passes over the points; the radius is then the distance of
//   the farthest point from the centre as it is stored, rounded up.
// Guarantee: every point is enclosed in exact arithmetic.
// Cost: O(points).
// Limits: neither sphere is the smallest.
// Sources: Ritter 1990; Ericson 2005; Kowalka 2016, 2.6.1.
#include "common/geometry/bounding_spheres.h"

#include <array>
#include <cmath>

#include "common/geometry/rounding.h"
#include "common/geometry/symmetric_eigen.h"

namespace vislab {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

double squared_distance(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 way = a - b;
  return glm::dot(way, way);
}

Sphere through_farthest(const glm::dvec3& center, std::span<const glm::vec3> points) {
  const glm::vec3 rounded(center);
  double farthest = 0.0;
  for (const glm::vec3& p : points) {
    farthest = std::max(farthest, squared_distance(glm::dvec3(p), glm::dvec3(rounded)));
  }
  // Differences, squares, sums and the root: at most 5 half ulp.
  return {rounded, round_up(std::sqrt(farthest) * (1.0 + 4.0 * epsilon))};
}

/// A sphere while it grows.
struct Growing {
  glm::dvec3 center;
  double radius;

  void hold(const glm::vec3& point) {
    const glm::dvec3 p(point);
    const double squared = squared_distance(p, center);
    if (squared <= radius * radius) return;
    // Grow by half of what is missing, away from the far side, which stays where it is.
    const double distance = std::sqrt(squared);
    radius = (radius + distance) * 0.5;
    center += (p - center) * ((distance - radius) / distance);
  }
};

}  // namespace

Sphere farthest_point_sphere(std::span<const glm::vec3> points) {
  if (points.empty()) return {glm::vec3(0.0F), -1.0F};
  return through_farthest(bounds_of(points).center(), points);
}

Sphere ritter_sphere(std::span<const glm::vec3> points, int refinements) {
  if (points.empty()) return {glm::vec3(0.0F), -1.0F};
  std::array<glm::dvec3, 3> lowest;
  std::array<glm::dvec3, 3> highest;
  lowest.fill(glm::dvec3(points[0]));
  highest.fill(glm::dvec3(points[0]));
  for (const glm::vec3& point : points) {
    const glm::dvec3 p(point);
    for (int i = 0; i < 3; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      if (p[i] < lowest[axis][i]) lowest[axis] = p;
      if (p[i] > highest[axis][i]) highest[axis] = p;
    }
  }
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (squared_distance(lowest[axis], highest[axis]) >
        squared_distance(lowest[longest], highest[longest])) {
      longest = axis;
    }
  }
  Growing sphere{(lowest[longest] + highest[longest]) * 0.5, 0.0};
  sphere.radius = std::sqrt(squared_distance(highest[longest], sphere.center));
  for (const glm::vec3& point : points) sphere.hold(point);
  Sphere smallest = through_farthest(sphere.center, points);
  for (int round = 0; round < refinements; ++round) {
    // A tenth less lets the centre go where the points pull it, from the other end every second
    // time.
    sphere.radius *= 0.9;
    for (std::size_t i = 0; i < points.size(); ++i) {
      sphere.hold(points[round % 2 == 0 ? points.size() - 1 - i : i]);
    }
    const Sphere refined = through_farthest(sphere.center, points);
    if (refined.radius < smallest.radius) smallest = refined;
  }
  return smallest;
}

Sphere transformed(const Sphere& sphere, const glm::dmat4x3& transform) {
  if (!(sphere.radius >= 0.0F)) return sphere;
  const glm::dmat3 linear(transform);
  const glm::dvec3 from(sphere.center);
  const glm::dvec3 center = linear * from + transform[3];
  // The greatest stretch is the root of the greatest eigenvalue of the squared matrix.
  const double stretch = std::sqrt(symmetric_eigen(glm::transpose(linear) * linear).values[0]) *
                         (1.0 + 64.0 * epsilon);
  const glm::vec3 rounded(center);
  double magnitude = 0.0;  // of the terms that the centre is a sum of
  for (int row = 0; row < 3; ++row) {
    magnitude += std::abs(transform[3][row]);
    for (int column = 0; column < 3; ++column) {
      magnitude += std::abs(transform[column][row] * from[column]);
    }
  }
  const double shift = glm::length(glm::dvec3(rounded) - center) + 4.0 * epsilon * magnitude;
  return {rounded, round_up((sphere.radius * stretch + shift) * (1.0 + 8.0 * epsilon))};
}

}  // namespace vislab
