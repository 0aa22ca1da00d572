#include "common/scene/quake_reach.h"

#include <algorithm>
#include <utility>

#include "common/geometry/convex_polygon.h"

namespace vislab {
namespace {

/// What reaches no farther beyond a plane lies on its other side only.
constexpr double rounding_m = 1e-6;

struct Waiting {
  std::int32_t node;
  ConvexPolygon polygon;
};

}  // namespace

void add_leaves_reached(const QuakeWorld& world, const std::array<glm::dvec3, 3>& triangle,
                        std::vector<std::uint32_t>& leaves) {
  std::vector<Waiting> waiting{{0, {triangle.begin(), triangle.end()}}};
  while (!waiting.empty()) {
    Waiting here = std::move(waiting.back());
    waiting.pop_back();
    if (here.node < 0) {
      const auto leaf = static_cast<std::uint32_t>(-(here.node + 1));
      if (world.leaves[leaf].cluster >= 0) leaves.push_back(leaf);
      continue;
    }
    const QuakeNode& node = world.nodes[static_cast<std::size_t>(here.node)];
    const Plane& plane = world.planes[node.plane];
    double lowest = 0.0;
    double highest = 0.0;
    for (const glm::dvec3& corner : here.polygon) {
      const double distance = plane.signed_distance(corner);
      lowest = std::min(lowest, distance);
      highest = std::max(highest, distance);
    }
    if (lowest >= -on_plane_m && highest <= on_plane_m) {
      waiting.push_back({node.back, here.polygon});
      waiting.push_back({node.front, std::move(here.polygon)});
    } else if (lowest >= -rounding_m) {
      waiting.push_back({node.front, std::move(here.polygon)});
    } else if (highest <= rounding_m) {
      waiting.push_back({node.back, std::move(here.polygon)});
    } else {
      PolygonHalves halves = divided(here.polygon, plane, rounding_m);
      waiting.push_back({node.back, std::move(halves.outside)});
      waiting.push_back({node.front, std::move(halves.inside)});
    }
  }
}

}  // namespace vislab
