// Idea: distances are compared squared, and the place of a point in a box is found by Cramer's
// rule,
//   all in rational numbers.
// Source: CGAL 5.5, Exact_rational.
#include "tests/geometry/exact_containment.h"

#include <CGAL/Exact_rational.h>

#include <array>

namespace vislab::test {
namespace {

using Rational = CGAL::Exact_rational;
using Vector = std::array<Rational, 3>;

Vector vector_of(const glm::dvec3& v) { return {Rational(v.x), Rational(v.y), Rational(v.z)}; }

Vector difference(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Rational dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Rational absolute(const Rational& value) { return value < 0 ? Rational(-value) : value; }

bool contains(const Sphere& sphere, const Vector& point) {
  const Vector way = difference(point, vector_of(glm::dvec3(sphere.center)));
  const Rational radius(static_cast<double>(sphere.radius));
  return radius >= 0 && dot(way, way) <= radius * radius;
}

/// A box without volume whose half-axes are exactly orthogonal: `way` from the centre must be a sum
/// of parts along them.
bool flat_contains(const std::array<Vector, 3>& half_axes, Vector way) {
  for (const Vector& axis : half_axes) {
    const Rational squared = dot(axis, axis);
    if (squared == 0) continue;
    const Rational share = dot(way, axis) / squared;
    if (absolute(share) > 1) return false;
    for (std::size_t i = 0; i < 3; ++i) way[i] -= axis[i] * share;
  }
  return dot(way, way) == 0;
}

bool contains(const OrientedBox& box, const Vector& point) {
  const Vector way = difference(point, vector_of(box.center));
  const Vector x = vector_of(box.half_axes[0]);
  const Vector y = vector_of(box.half_axes[1]);
  const Vector z = vector_of(box.half_axes[2]);
  const Rational volume = absolute(dot(x, cross(y, z)));
  if (volume == 0) return flat_contains({x, y, z}, way);
  return absolute(dot(way, cross(y, z))) <= volume && absolute(dot(way, cross(z, x))) <= volume &&
         absolute(dot(way, cross(x, y))) <= volume;
}

Vector image_of(const Vector& point, const glm::dmat4x3& transform) {
  Vector image = vector_of(transform[3]);
  for (int column = 0; column < 3; ++column) {
    const Vector axis = vector_of(transform[column]);
    for (std::size_t row = 0; row < 3; ++row) {
      image[row] += axis[row] * point[static_cast<std::size_t>(column)];
    }
  }
  return image;
}

}  // namespace

bool exactly_contains(const Sphere& sphere, const glm::dvec3& point) {
  return contains(sphere, vector_of(point));
}

bool exactly_contains(const OrientedBox& box, const glm::dvec3& point) {
  return contains(box, vector_of(point));
}

bool exactly_contains_image(const OrientedBox& image, const OrientedBox& box, const glm::dvec3& t,
                            const glm::dmat4x3& transform) {
  Vector point = vector_of(box.center);
  for (int i = 0; i < 3; ++i) {
    const Vector axis = vector_of(box.half_axes[i]);
    for (std::size_t row = 0; row < 3; ++row) point[row] += axis[row] * Rational(t[i]);
  }
  return contains(image, image_of(point, transform));
}

bool exactly_contains_image(const Sphere& image, const Sphere& sphere, const glm::dvec3& t,
                            const glm::dmat4x3& transform) {
  Vector point = vector_of(glm::dvec3(sphere.center));
  for (std::size_t i = 0; i < 3; ++i) {
    point[i] += Rational(static_cast<double>(sphere.radius)) * Rational(t[static_cast<int>(i)]);
  }
  return contains(image, image_of(point, transform));
}

}  // namespace vislab::test
