#include "algorithms/portal/pvs_polygon.h"

#include <algorithm>
#include <limits>

#include "algorithms/portal/convex_cut.h"

namespace vislab::portal_culling {
namespace {

/// Coordinates of some hundred metres are rounded to 1e-13 m: planes that touch both polygons
/// separate them though the sums do not come out equal.
constexpr double rounding_m = 1e-11;

struct Extent {
  double min = std::numeric_limits<double>::max();
  double max = -std::numeric_limits<double>::max();
};

Extent extent_along(const glm::dvec3& normal, const FlowPolygon& polygon) {
  Extent extent;
  for (const glm::dvec3& corner : polygon.corners()) {
    const double at = glm::dot(normal, corner);
    extent.min = std::min(extent.min, at);
    extent.max = std::max(extent.max, at);
  }
  return extent;
}

/// Planes through the edges of one polygon and the corners of the other.
void append_through_edges(const FlowPolygon& edges, const FlowPolygon& corners,
                          const FlowPolygon& first, const FlowPolygon& second, double slack,
                          std::vector<HalfSpace>& found) {
  const std::span<const glm::dvec3> e = edges.corners();
  for (std::size_t i = 0; i < e.size(); ++i) {
    const glm::dvec3& a = e[i];
    const glm::dvec3 along = e[i + 1 == e.size() ? 0 : i + 1] - a;
    const double length_squared = glm::dot(along, along);
    if (!(length_squared > 1e-16)) continue;
    for (const glm::dvec3& corner : corners.corners()) {
      const glm::dvec3 to = corner - a;
      glm::dvec3 normal = glm::cross(along, to);
      const double squared = glm::dot(normal, normal);
      // The corner is too near to the edge's line to give a direction.
      if (!(squared > 1e-12 * length_squared)) continue;
      normal /= std::sqrt(squared);
      Extent before = extent_along(normal, first);
      Extent after = extent_along(normal, second);
      if (after.max <= before.min + rounding_m) {
        normal = -normal;
        std::swap(before.min, before.max);
        std::swap(after.min, after.max);
        before = {-before.min, -before.max};
        after = {-after.min, -after.max};
      }
      if (after.min < before.max - rounding_m) continue;
      if (after.max - before.min < 1e-9) continue;  // both lie in the plane
      const HalfSpace half{normal, after.min - slack};
      const bool known = std::ranges::any_of(found, [&](const HalfSpace& other) {
        return glm::dot(other.normal, normal) > 1.0 - 1e-12 &&
               std::abs(other.offset - half.offset) < 1e-9;
      });
      if (!known) found.push_back(half);
      break;
    }
  }
}

}  // namespace

bool FlowPolygon::clip(const HalfSpace& half) {
  std::array<double, capacity> distance;
  for (std::uint32_t i = 0; i < count_; ++i) distance[i] = half.distance(corners_[i]);
  std::array<glm::dvec3, capacity> kept;
  std::uint32_t count = 0;
  const Cut cut = cut_convex<glm::dvec3>(std::span(corners_).first(count_),
                                         std::span(distance).first(count_), kept, count);
  if (cut == Cut::in_two) {
    std::copy_n(kept.begin(), count, corners_.begin());
    count_ = count;
  }
  return cut != Cut::all_outside;
}

double FlowPolygon::farthest(const HalfSpace& half) const {
  return extent_along(half.normal, *this).max - half.offset;
}

void append_separators(const FlowPolygon& first, const FlowPolygon& second, double slack,
                       std::vector<HalfSpace>& found) {
  append_through_edges(first, second, first, second, slack, found);
  append_through_edges(second, first, first, second, slack, found);
}

}  // namespace vislab::portal_culling
