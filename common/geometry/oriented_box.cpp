// Idea: the axes of a box are the directions in which the surface of the convex hull spreads most
//   and least. The hull's surface counts, not the points: neither inner points nor dense vertices
//   pull the axes.
// Guarantee: what is enclosed is enclosed in exact arithmetic.
// Cost: O(n log n) for the hull, O(n) for the box along given axes.
// Limits: arbitrary axes where the spread is alike in several directions.
// Sources: Gottschalk, Lin and Manocha 1996; Kowalka 2016, 2.6.1.
#include "common/geometry/oriented_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/geometry/reference_volumes.h"
#include "common/geometry/symmetric_eigen.h"

namespace vislab {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// What contains nothing and is never culled.
OrientedBox nothing() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {glm::dvec3(nan), glm::dmat3(nan)};
}

/// Sums of equations 2.2 to 2.6 over triangles.
class SurfaceCovariance {
 public:
  void add(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
    const double area = 0.5 * glm::length(glm::cross(p - q, p - r));  // 2.2
    const glm::dvec3 center = (p + q + r) / 3.0;                      // 2.4
    area_ += area;                                                    // 2.3
    center_ += center * area;                                         // 2.5, before the division
    moment_ += (glm::outerProduct(center, center) * 9.0 + glm::outerProduct(p, p) +
                glm::outerProduct(q, q) + glm::outerProduct(r, r)) *
               (area / 12.0);
  }
  double area() const { return area_; }
  glm::dmat3 covariance() const {  // 2.6
    const glm::dvec3 center = center_ / area_;
    return moment_ / area_ - glm::outerProduct(center, center);
  }

 private:
  double area_ = 0.0;
  glm::dvec3 center_{0.0};
  glm::dmat3 moment_{0.0};
};

/// Orthonormal axes whose first is along a direction of any length but 0.
glm::dmat3 axes_along(const glm::dvec3& direction) {
  const glm::dvec3 first = glm::normalize(direction);
  const glm::dvec3 other =
      std::abs(first.x) < 0.6 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
  const glm::dvec3 second = glm::normalize(glm::cross(first, other));
  return {first, second, glm::cross(first, second)};
}

glm::dmat3 covariance_axes(std::span<const glm::vec3> points) {
  const Hull hull = convex_hull(points);
  // Around a point of the hull and in its own size: nothing cancels, overflows or vanishes.
  const glm::dvec3 origin = hull.points[0];
  double size = 0.0;
  for (const glm::dvec3& p : hull.points) {
    const glm::dvec3 reach = glm::abs(p - origin);
    size = std::max({size, reach.x, reach.y, reach.z});
  }
  if (size == 0.0) return glm::dmat3(1.0);
  const auto local = [&](std::size_t i) { return (hull.points[i] - origin) / size; };
  SurfaceCovariance surface;
  for (const glm::uvec3& t : hull.triangles) surface.add(local(t.x), local(t.y), local(t.z));
  if (hull.triangles.empty()) {  // a convex polygon, a segment
    for (std::size_t i = 2; i < hull.points.size(); ++i)
      surface.add(local(0), local(i - 1), local(i));
  }
  if (surface.area() == 0.0) return axes_along(local(hull.points.size() - 1));
  return symmetric_eigen(surface.covariance()).vectors;
}

/// A box along three orthonormal axes around the parallelepiped.
OrientedBox orthogonal_box(const OrientedBox& skew, double error) {
  std::array<glm::dvec3, 3> edges{skew.half_axes[0], skew.half_axes[1], skew.half_axes[2]};
  std::stable_sort(edges.begin(), edges.end(), [](const glm::dvec3& a, const glm::dvec3& b) {
    return glm::length(a) > glm::length(b);
  });
  glm::dmat3 axes(1.0);
  if (glm::length(edges[0]) > 0.0) {
    axes = axes_along(edges[0]);
    const glm::dvec3 rest = edges[1] - axes[0] * glm::dot(axes[0], edges[1]);
    if (glm::length(rest) > 1e-12 * glm::length(edges[0])) {
      axes[1] = glm::normalize(rest);
      axes[2] = glm::cross(axes[0], axes[1]);
    }
  }
  OrientedBox result{skew.center, axes};
  for (int i = 0; i < 3; ++i) {
    double reach = 0.0;
    double size = 0.0;
    for (const glm::dvec3& edge : edges) {
      reach += std::abs(glm::dot(axes[i], edge));
      size += absolute_sum(edge);
    }
    result.half_axes[i] *= reach + 16.0 * epsilon * size + 2.0 * error;
  }
  return result;
}

}  // namespace

double OrientedBox::volume() const { return 8.0 * std::abs(glm::determinant(half_axes)); }

OrientedBox oriented(const Aabb& box) {
  if (!box.valid()) return nothing();
  const glm::dvec3 low(box.min);
  const glm::dvec3 high(box.max);
  OrientedBox result{box.center(), glm::dmat3(0.0)};
  // The sum of two floats may need more digits than a double has.
  const glm::dvec3 half = glm::max(result.center - low, high - result.center);
  for (int i = 0; i < 3; ++i) result.half_axes[i][i] = half[i] * (1.0 + 2.0 * epsilon);
  return result;
}

OrientedBox box_along(const glm::dmat3& axes, std::span<const glm::vec3> points) {
  if (points.empty()) return nothing();
  // Measured from one of the points, so that only the box's own size is rounded.
  const glm::dvec3 origin(points[0]);
  glm::dvec3 low(0.0);
  glm::dvec3 high(0.0);
  double size = 0.0;
  for (const glm::vec3& point : points) {
    const glm::dvec3 way = glm::dvec3(point) - origin;
    const glm::dvec3 along(glm::dot(axes[0], way), glm::dot(axes[1], way), glm::dot(axes[2], way));
    low = glm::min(low, along);
    high = glm::max(high, along);
    size = std::max(size, absolute_sum(way));
  }
  if (size == 0.0) return {origin, glm::dmat3(0.0)};
  const glm::dvec3 middle = (low + high) * 0.5;
  const glm::dvec3 offset = axes * middle;
  OrientedBox box{origin + offset, axes};
  // The centre is a sum of the origin and the offset; the axes are orthonormal to a few ulp.
  const double error = 16.0 * epsilon * size + 2.0 * epsilon * absolute_sum(box.center);
  for (int i = 0; i < 3; ++i) {
    box.half_axes[i] *= (high[i] - low[i]) * 0.5 + error;
  }
  return box;
}

OrientedBox covariance_box(std::span<const glm::vec3> points) {
  if (points.empty()) return box_along(glm::dmat3(1.0), points);
  return box_along(covariance_axes(points), points);
}

OrientedBox transformed(const OrientedBox& box, const glm::dmat4x3& transform) {
  const glm::dmat3 linear(transform);
  OrientedBox image{linear * box.center + transform[3], linear * box.half_axes};
  double magnitude = absolute_sum(transform[3]);  // of all terms that were added
  for (int column = 0; column < 3; ++column) {
    double size = std::abs(box.center[column]);
    for (int i = 0; i < 3; ++i) size += std::abs(box.half_axes[i][column]);
    magnitude += absolute_sum(linear[column]) * size;
  }
  const double error = 4.0 * epsilon * magnitude;  // bounds the length of any point's error
  const glm::dmat3& h = image.half_axes;
  const double volume = glm::determinant(h);
  const double lengths = glm::length(h[0]) * glm::length(h[1]) * glm::length(h[2]);
  if (!(std::abs(volume) > 1e-6 * lengths)) return orthogonal_box(image, error);
  // A half-axis must grow by the error over its distance from the plane of the two others.
  const glm::dvec3 growth(glm::length(glm::cross(h[1], h[2])), glm::length(glm::cross(h[2], h[0])),
                          glm::length(glm::cross(h[0], h[1])));
  for (int i = 0; i < 3; ++i) {
    image.half_axes[i] *= 1.0 + 2.0 * error * growth[i] / std::abs(volume) + 4.0 * epsilon;
  }
  return image;
}

}  // namespace vislab
