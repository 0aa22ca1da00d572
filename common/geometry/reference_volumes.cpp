// Idea: CGAL's convex hull, smallest enclosing sphere and optimal bounding box, with the flat cases
//   that they do not take told apart first by exact predicates.
// Guarantee: the hull is exact; the sphere's radius right to a few ulp; the box is not proved to be
//   the smallest.
// Source: CGAL 5.5: convex_hull_3, Min_sphere_of_spheres_d, oriented_bounding_box (the last needs
//   Eigen; the packages are under the GPL).
#include "common/geometry/reference_volumes.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Min_sphere_of_points_d_traits_3.h>
#include <CGAL/Min_sphere_of_spheres_d.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_2.h>
#include <CGAL/convex_hull_3.h>
#include <CGAL/optimal_bounding_box.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>

namespace vislab {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

/// Every point once, in lexicographic order.
std::vector<Point> distinct(std::span<const glm::vec3> points) {
  if (points.empty()) throw std::logic_error("a bounding volume needs at least one point");
  std::vector<Point> result;
  result.reserve(points.size());
  for (const glm::vec3& p : points) result.emplace_back(p.x, p.y, p.z);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

glm::dvec3 vector_of(const Point& p) { return {p.x(), p.y(), p.z()}; }

/// The corners of the convex polygon of points in one plane, which `a`, `b` and `c` span.
std::vector<glm::dvec3> planar_hull(const std::vector<Point>& points, const Point& a,
                                    const Point& b, const Point& c) {
  // Leaving out a coordinate keeps the others exact. Any will do in which a, b and c stay apart.
  using Point2 = Kernel::Point_2;
  int left_out = 0;
  const auto flat = [&](const Point& p) {
    return Point2(p[left_out == 0 ? 1 : 0], p[left_out == 2 ? 1 : 2]);
  };
  while (CGAL::collinear(flat(a), flat(b), flat(c))) ++left_out;
  std::vector<std::pair<Point2, std::size_t>> flattened;
  for (std::size_t i = 0; i < points.size(); ++i) flattened.emplace_back(flat(points[i]), i);
  std::sort(flattened.begin(), flattened.end());
  std::vector<Point2> corners;
  std::vector<Point2> plane_points;
  for (const auto& [p, index] : flattened) plane_points.push_back(p);
  CGAL::convex_hull_2(plane_points.begin(), plane_points.end(), std::back_inserter(corners));
  std::vector<glm::dvec3> result;
  for (const Point2& corner : corners) {
    const auto found = std::lower_bound(flattened.begin(), flattened.end(),
                                        std::pair<Point2, std::size_t>(corner, 0));
    result.push_back(vector_of(points[found->second]));
  }
  return result;
}

}  // namespace

Hull convex_hull(std::span<const glm::vec3> points) {
  const std::vector<Point> all = distinct(points);
  Hull hull;
  const Point& first = all.front();
  if (all.size() == 1) {
    hull.points = {vector_of(first)};
    return hull;
  }
  const Point& last = all.back();  // the ends of sorted collinear points
  const auto off_line = std::find_if(
      all.begin(), all.end(), [&](const Point& p) { return !CGAL::collinear(first, last, p); });
  if (off_line == all.end()) {
    hull.points = {vector_of(first), vector_of(last)};
    return hull;
  }
  const auto off_plane = std::find_if(all.begin(), all.end(), [&](const Point& p) {
    return !CGAL::coplanar(first, last, *off_line, p);
  });
  if (off_plane == all.end()) {
    hull.points = planar_hull(all, first, last, *off_line);
    return hull;
  }
  CGAL::Surface_mesh<Point> mesh;
  CGAL::convex_hull_3(all.begin(), all.end(), mesh);
  std::vector<std::uint32_t> numbers(mesh.num_vertices());
  for (const auto vertex : mesh.vertices()) {
    numbers[vertex] = static_cast<std::uint32_t>(hull.points.size());
    hull.points.push_back(vector_of(mesh.point(vertex)));
  }
  for (const auto face : mesh.faces()) {
    std::vector<std::uint32_t> ring;
    for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face))) {
      ring.push_back(numbers[vertex]);
    }
    for (std::size_t i = 2; i < ring.size(); ++i) {
      hull.triangles.emplace_back(ring[0], ring[i - 1], ring[i]);
    }
  }
  return hull;
}

double smallest_sphere_radius(std::span<const glm::vec3> points) {
  using Traits = CGAL::Min_sphere_of_points_d_traits_3<Kernel, double>;
  const std::vector<Point> all = distinct(points);
  CGAL::Min_sphere_of_spheres_d<Traits> sphere(all.begin(), all.end());
  return sphere.radius();
}

OrientedBox smallest_box(std::span<const glm::vec3> points) {
  const Hull hull = convex_hull(points);
  if (hull.triangles.empty()) return covariance_box(points);
  std::vector<Point> corners;
  corners.reserve(hull.points.size());
  for (const glm::dvec3& p : hull.points) corners.emplace_back(p.x, p.y, p.z);
  std::array<Point, 8> box;
  CGAL::oriented_bounding_box(corners, box,
                              CGAL::parameters::use_convex_hull(false).random_seed(1));
  // Corner 0 is joined to the corners 1, 3 and 5 by edges. The longest edges tell directions best.
  std::array<glm::dvec3, 3> edges;
  for (std::size_t i = 0; i < 3; ++i) {
    edges[i] = vector_of(box[2 * i + 1]) - vector_of(box[0]);
  }
  std::sort(edges.begin(), edges.end(), [](const glm::dvec3& a, const glm::dvec3& b) {
    return glm::dot(a, a) > glm::dot(b, b);
  });
  glm::dmat3 axes;
  axes[0] = glm::normalize(edges[0]);
  axes[1] = glm::normalize(edges[1] - axes[0] * glm::dot(axes[0], edges[1]));
  axes[2] = glm::cross(axes[0], axes[1]);
  return box_along(axes, points);
}

}  // namespace vislab
