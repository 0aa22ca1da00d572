#include "common/scene/quake_gaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace vislab {
namespace {

/// A triangle this near to a face covers it; it reaches this much farther than it does.
constexpr double near_m = 0.012;
constexpr double rounding_m = 1e-4;
constexpr double smallest_gap_m2 = 1e-3;

struct Triangle {
  std::array<glm::dvec3, 3> corners;
  glm::dvec3 normal;
};

class GapFinder {
 public:
  GapFinder(const Scene& scene, const QuakeWorld& world)
      : objects_of_leaf_(world.leaves.size()), first_(1, 0) {
    for (ObjectId id = 0; id < scene.objects.size(); ++id) {
      const Object& object = scene.objects[id];
      const Mesh& mesh = scene.meshes[object.mesh];
      const auto leaves = world.leaves_of_object(id);
      for (const std::uint32_t leaf : leaves) objects_of_leaf_[leaf].push_back(id);
      for (std::uint32_t t = 0; !leaves.empty() && t < mesh.triangles.size(); ++t) {
        const auto corners = world_triangle(mesh, object.transform, t);
        const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double length = glm::length(normal);
        if (length > 0.0) triangles_.push_back({corners, normal / length});
      }
      first_.push_back(triangles_.size());
    }
  }

  /// Is more than a little of a face towards an open leaf covered by nothing?
  bool is_bare(const LeafFace& face, std::uint32_t open) const {
    std::vector<ConvexPolygon> bare{face.polygon};
    for (const ObjectId object : objects_of_leaf_[open]) {
      for (std::size_t i = first_[object]; i < first_[object + 1]; ++i) {
        const bool covers = std::ranges::all_of(triangles_[i].corners, [&](const glm::dvec3& p) {
          return std::abs(face.plane.signed_distance(p)) <= near_m;
        });
        if (!covers) continue;
        take_away(triangles_[i], bare);
        if (bare.empty()) return false;
      }
    }
    double sum = 0.0;
    for (const ConvexPolygon& piece : bare) sum += area(piece);
    return sum > smallest_gap_m2;
  }

 private:
  /// Leaves of each piece what lies beyond one of the triangle's edges.
  static void take_away(const Triangle& triangle, std::vector<ConvexPolygon>& pieces) {
    std::vector<ConvexPolygon> left;
    for (ConvexPolygon& piece : pieces) {
      std::vector<ConvexPolygon> beyond;
      ConvexPolygon rest = piece;
      for (std::size_t i = 0; i < 3 && !rest.empty(); ++i) {
        const glm::dvec3& from = triangle.corners[i];
        const glm::dvec3 edge = triangle.corners[(i + 1) % 3] - from;
        const glm::dvec3 inward = glm::normalize(glm::cross(triangle.normal, edge));
        PolygonHalves halves = divided(rest, {inward, near_m - glm::dot(inward, from)}, rounding_m);
        if (!halves.outside.empty()) beyond.push_back(std::move(halves.outside));
        rest = std::move(halves.inside);
      }
      if (rest.empty()) {
        left.push_back(std::move(piece));
        continue;
      }
      for (ConvexPolygon& part : beyond) left.push_back(std::move(part));
    }
    pieces = std::move(left);
  }

  std::vector<std::vector<ObjectId>> objects_of_leaf_;
  std::vector<Triangle> triangles_;
  std::vector<std::size_t> first_;  // by object, and their end
};

}  // namespace

std::size_t count_see_through_leaves(const Scene& scene, const QuakeWorld& world,
                                     const LeafShapes& shapes) {
  const GapFinder finder(scene, world);
  // By solid leaf: the plane of its first bare face, and whether there is one in another plane.
  std::map<std::uint32_t, std::pair<const Plane*, bool>> bare;
  for (const LeafFace& face : shapes.faces) {
    if (face.front == none_id || face.back == none_id) continue;
    const bool front_is_open = world.leaves[face.front].cluster >= 0;
    if (front_is_open == (world.leaves[face.back].cluster >= 0)) continue;
    const std::uint32_t solid = front_is_open ? face.back : face.front;
    const auto known = bare.find(solid);
    if (known != bare.end() && known->second.second) continue;
    if (!finder.is_bare(face, front_is_open ? face.front : face.back)) continue;
    if (known == bare.end()) {
      bare[solid] = {&face.plane, false};
      continue;
    }
    const Plane& other = *known->second.first;
    known->second.second = other.normal != face.plane.normal || other.d != face.plane.d;
  }
  return static_cast<std::size_t>(
      std::ranges::count_if(bare, [](const auto& entry) { return entry.second.second; }));
}

}  // namespace vislab
