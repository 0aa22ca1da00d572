// Planes, axis-aligned boxes and spheres. Planes are double; boxes and spheres are float and are
// always rounded outward, so that what they enclose is enclosed in exact arithmetic too.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <limits>
#include <span>

namespace vislab {

/// Half-space n.p + d >= 0 ("inside"), world frame. `normal` has unit length unless a function says
/// otherwise.
struct Plane {
  glm::dvec3 normal{0.0, 0.0, 1.0};
  double d = 0.0;
  /// Sum of the absolute terms that d was made of. d may be a small rest of large terms, and its
  /// rounding is then of their size. Who changes d by hand adds what was added; 0 says that d is
  /// exact or no rest, and |d| is then taken.
  double magnitude = 0.0;

  double signed_distance(const glm::dvec3& p) const { return glm::dot(normal, p) + d; }
};

/// |x| + |y| + |z|: what bounds the rounding of a scalar product with a unit vector.
inline double absolute_sum(const glm::dvec3& p) {
  return std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
}

/// Plane through three points; the inside is where they appear counter-clockwise. The points must
/// not be collinear.
Plane plane_through(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// Axis-aligned box, metres. The default is empty (min > max), which contains nothing.
struct Aabb {
  glm::vec3 min{std::numeric_limits<float>::infinity()};
  glm::vec3 max{-std::numeric_limits<float>::infinity()};

  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  /// All six numbers are finite, their differences too, and min <= max. A box that is not valid may
  /// never be culled.
  bool valid() const {
    constexpr float greatest = std::numeric_limits<float>::max();
    const glm::vec3 extent = max - min;  // infinite or NaN if any bound is
    return min.x <= max.x && min.y <= max.y && min.z <= max.z && extent.x <= greatest &&
           extent.y <= greatest && extent.z <= greatest;
  }
  glm::dvec3 center() const { return (glm::dvec3(min) + glm::dvec3(max)) * 0.5; }
  glm::dvec3 half_size() const { return (glm::dvec3(max) - glm::dvec3(min)) * 0.5; }
  void extend(const glm::vec3& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  void extend(const Aabb& box) {
    min = glm::min(min, box.min);
    max = glm::max(max, box.max);
  }
  bool contains(const glm::dvec3& p) const;
  /// Does the other box lie in this one, its border included? Neither is to be empty.
  bool contains(const Aabb& box) const {
    return glm::all(glm::lessThanEqual(min, box.min)) && glm::all(glm::lessThanEqual(box.max, max));
  }

  friend bool operator==(const Aabb&, const Aabb&) = default;
};

/// Box of a set of points; empty for no points.
Aabb bounds_of(std::span<const glm::vec3> points);

/// Smallest box around the eight corners of `box` after an affine transform (Arvo 1990), rounded
/// outward. An empty box stays empty.
Aabb transformed(const Aabb& box, const glm::dmat4x3& transform);

/// Half the box's surface, metres squared; 0 of an empty box.
double half_area(const Aabb& box);

/// Squared distance of a point from a box, metres squared; 0 inside.
double distance_squared(const Aabb& box, const glm::dvec3& p);

struct Sphere {
  glm::vec3 center{0.0F};
  float radius = 0.0F;
};

/// The sphere around the box's centre through its corners, radius rounded up. If the box is not
/// valid the radius is NaN, and no test culls it.
Sphere circumscribed(const Aabb& box);

}  // namespace vislab
