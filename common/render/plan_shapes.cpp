#include "common/render/plan_shapes.h"

#include <algorithm>

#include "common/scene/convex_region.h"

namespace vislab {
namespace {

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Farther than any corner of the region from the middle of its box.
double reach_of(const ConvexRegion& region) {
  return 1.0 + glm::length(glm::dvec3(region.bounds.max) - glm::dvec3(region.bounds.min));
}

}  // namespace

PlanPolygon convex_hull(PlanPolygon points) {
  std::ranges::sort(points, [](const glm::dvec2& a, const glm::dvec2& b) {
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  });
  PlanPolygon hull;
  // Lower chain from the left, then the upper one back.
  for (const bool back : {false, true}) {
    const std::size_t first = hull.size();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const glm::dvec2& p = points[back ? points.size() - 1 - i : i];
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    if (!hull.empty()) hull.pop_back();  // the other chain begins with it
  }
  return hull;
}

PlanPolygon outline_of(const ConvexRegion& region) {
  PlanPolygon points;
  const glm::dvec3 middle = 0.5 * (glm::dvec3(region.bounds.min) + glm::dvec3(region.bounds.max));
  for (const ConvexPolygon& side : surface_of(region.planes, middle, reach_of(region))) {
    for (const glm::dvec3& corner : side) points.push_back(seen_from_above(corner));
  }
  return convex_hull(std::move(points));
}

PlanPolygon cut_at(const ConvexRegion& region, double height) {
  if (height < region.bounds.min.y || height > region.bounds.max.y) return {};
  const glm::dvec3 middle = 0.5 * (glm::dvec3(region.bounds.min) + glm::dvec3(region.bounds.max));
  const Plane level{{0.0, 1.0, 0.0}, -height};
  PlanPolygon cut;
  for (const glm::dvec3& corner :
       clipped(square_on(level, middle, reach_of(region)), region, 0.0)) {
    cut.push_back(seen_from_above(corner));
  }
  return cut;
}

bool cut_at(std::span<const glm::dvec3> polygon, double height, PlanLine& line) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3& a = polygon[i];
    const glm::dvec3& b = polygon[(i + 1) % polygon.size()];
    if ((a.y >= height) == (b.y >= height)) continue;
    line[found++ % 2] = seen_from_above(glm::mix(a, b, (height - a.y) / (b.y - a.y)));
  }
  return found >= 2;
}

}  // namespace vislab
