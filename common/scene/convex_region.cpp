#include "common/scene/convex_region.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/rounding.h"

namespace vislab {
namespace {

void extend(Aabb& box, const glm::dvec3& p) {
  box.extend(glm::vec3(round_down(p.x), round_down(p.y), round_down(p.z)));
  box.extend(glm::vec3(round_up(p.x), round_up(p.y), round_up(p.z)));
}

/// The inside is where the normal points.
Plane plane_at(const glm::dvec3& normal, const glm::dvec3& point) {
  return {normal, -glm::dot(normal, point)};
}

}  // namespace

std::vector<ConvexPolygon> surface_of(const std::vector<Plane>& planes, const glm::dvec3& around,
                                      double reach) {
  std::vector<ConvexPolygon> surface;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    ConvexPolygon polygon = square_on(planes[i], around, reach);
    for (std::size_t k = 0; k < planes.size() && !polygon.empty(); ++k) {
      if (k != i) polygon = divided(polygon, planes[k], 0.0).inside;
    }
    if (!polygon.empty()) surface.push_back(std::move(polygon));
  }
  return surface;
}

std::optional<ConvexRegion> region_inside(std::vector<Plane> planes) {
  // Twice the size of a scene: a region that reaches so far is not bounded.
  const double reach = 2.0 * max_scene_coordinate_m;
  Aabb rough;
  for (const ConvexPolygon& polygon : surface_of(planes, glm::dvec3(0.0), reach)) {
    for (const glm::dvec3& corner : polygon) extend(rough, corner);
  }
  if (rough.empty() || !rough.valid()) return std::nullopt;
  // From so far away corners are rounded to tenths of a millimetre; from near by they are not.
  const glm::dvec3 half = rough.half_size();
  const double near_reach = 2.0 * glm::length(half) + 1.0;
  if (near_reach > 2.0 * max_scene_coordinate_m) return std::nullopt;
  ConvexRegion region;
  glm::dvec3 extent(0.0);
  for (const ConvexPolygon& polygon : surface_of(planes, rough.center(), near_reach)) {
    for (const glm::dvec3& corner : polygon) extend(region.bounds, corner);
  }
  if (region.bounds.empty()) return std::nullopt;
  extent = region.bounds.half_size();
  if (!(std::min({extent.x, extent.y, extent.z}) > 0.0)) return std::nullopt;
  region.planes = std::move(planes);
  return region;
}

ConvexRegion box_region(const glm::dvec3& min, const glm::dvec3& max) {
  ConvexRegion region;
  extend(region.bounds, min);
  extend(region.bounds, max);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 normal(0.0);
    normal[axis] = 1.0;
    region.planes.push_back({normal, -min[axis]});
    region.planes.push_back({-normal, max[axis]});
  }
  return region;
}

ConvexRegion prism_region(const ConvexPolygon& polygon, double reach) {
  const glm::dvec3 normal = glm::normalize(area_vector(polygon));
  const glm::dvec3 onward = normal * reach;
  const glm::dvec3 inward = reach > 0.0 ? normal : -normal;
  ConvexRegion region;
  region.planes.push_back(plane_at(inward, polygon[0]));
  region.planes.push_back(plane_at(-inward, polygon[0] + onward));
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    region.planes.push_back(plane_at(glm::normalize(glm::cross(normal, edge)), polygon[i]));
    extend(region.bounds, polygon[i]);
    extend(region.bounds, polygon[i] + onward);
  }
  return region;
}

bool contains(const ConvexRegion& region, const glm::dvec3& point, double slack) {
  return std::ranges::all_of(
      region.planes, [&](const Plane& plane) { return plane.signed_distance(point) >= -slack; });
}

std::optional<glm::dvec3> shared_point(const ConvexRegion& a, const ConvexRegion& b, double depth) {
  const auto room = static_cast<float>(depth);
  if (glm::any(glm::lessThan(a.bounds.max, b.bounds.min + room)) ||
      glm::any(glm::lessThan(b.bounds.max, a.bounds.min + room))) {
    return std::nullopt;
  }
  std::vector<Plane> planes = a.planes;
  planes.insert(planes.end(), b.planes.begin(), b.planes.end());
  for (Plane& plane : planes) plane.d -= 0.5 * depth;
  const double reach = 4.0 * glm::length(a.bounds.half_size()) + 1.0;
  glm::dvec3 sum(0.0);
  std::size_t count = 0;
  for (const ConvexPolygon& polygon : surface_of(planes, a.bounds.center(), reach)) {
    for (const glm::dvec3& corner : polygon) {
      sum += corner;
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

ConvexPolygon clipped(ConvexPolygon polygon, const ConvexRegion& region, double slack) {
  for (const Plane& plane : region.planes) {
    if (polygon.empty()) break;
    Plane moved = plane;
    moved.d += slack;
    polygon = divided(polygon, moved, 0.0).inside;
  }
  return polygon;
}

}  // namespace vislab
