// Ways that follow what a scene knows: the places of a Quake III world, portals.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "common/scene/paths/tracks.h"
#include "common/scene/quake_world.h"

namespace vislab {
namespace {

/// All world triangles of a scene, for straight lines to be tried against one by one.
class Obstacles {
 public:
  explicit Obstacles(const Scene& scene) {
    for (const Object& object : scene.objects) {
      const Mesh& mesh = scene.meshes[object.mesh];
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        triangles_.push_back(world_triangle(mesh, object.transform, t));
      }
    }
  }

  /// True if a walker's body fits along the line: the line itself and four beside it meet nothing,
  /// and neither do their prolongations by the body's reach.
  bool free_way(const glm::dvec3& from, const glm::dvec3& to) const {
    constexpr double reach_m = 0.5;
    const glm::dvec3 step = to - from;
    const double length = glm::length(step);
    if (length == 0.0) return false;
    const glm::dvec3 onward = step * (reach_m / length);
    const glm::dvec3 up(0.0, 1.0, 0.0);
    const glm::dvec3 across = glm::cross(onward, up);  // shorter on steep ways
    for (const glm::dvec3& aside : {glm::dvec3(0.0), across, -across, up * 0.3, up * -0.5}) {
      if (first_hit(from + aside - onward, to + aside + onward) <= 1.0) return false;
    }
    return true;
  }

  /// How far one sees on average, metres, from a heading over an angle.
  double openness(const glm::dvec3& eye, double heading_rad, double angle_rad) const {
    constexpr int rays = 8;
    constexpr double farthest_m = 50.0;
    double sum = 0.0;
    for (int i = 1; i <= rays; ++i) {
      const double heading = heading_rad + angle_rad * i / rays;
      const glm::dvec3 onward(std::cos(heading), 0.0, -std::sin(heading));
      sum += std::min(first_hit(eye, eye + onward * farthest_m), 1.0) * farthest_m;
    }
    return sum / rays;
  }

 private:
  /// The parameter from 0 (`from`) to 1 (`to`) of the first triangle met, from either side;
  /// infinite if there is none. Moeller and Trumbore 1997.
  double first_hit(const glm::dvec3& from, const glm::dvec3& to) const {
    const glm::dvec3 step = to - from;
    double first = std::numeric_limits<double>::infinity();
    for (const std::array<glm::dvec3, 3>& corners : triangles_) {
      const glm::dvec3 edge1 = corners[1] - corners[0];
      const glm::dvec3 edge2 = corners[2] - corners[0];
      const glm::dvec3 p = glm::cross(step, edge2);
      const double determinant = glm::dot(edge1, p);
      if (determinant == 0.0) continue;
      const glm::dvec3 s = from - corners[0];
      const double u = glm::dot(s, p) / determinant;
      const glm::dvec3 q = glm::cross(s, edge1);
      const double v = glm::dot(step, q) / determinant;
      const double t = glm::dot(edge2, q) / determinant;
      if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0) first = std::min(first, t);
    }
    return first;
  }

  std::vector<std::array<glm::dvec3, 3>> triangles_;
};

}  // namespace

Track quake_track(const Scene& scene, int places) {
  constexpr double look_rad = 2.0 * std::numbers::pi / 3.0;
  constexpr double longest_way_m = 15.0;
  std::vector<QuakePlace> left = scene.quake->places;
  const Obstacles obstacles(scene);
  Walker walker(left.front().eye, left.front().heading_rad);
  left.erase(left.begin());
  const auto look_about = [&]() {
    const double heading = walker.heading_rad();
    const bool leftward = obstacles.openness(walker.eye(), heading, look_rad) >=
                          obstacles.openness(walker.eye(), heading, -look_rad);
    walker.turn_by(leftward ? look_rad : -look_rad);
  };
  look_about();
  for (int visited = 1; visited < places && !left.empty(); ++visited) {
    const glm::dvec3 here = walker.eye();
    std::stable_sort(left.begin(), left.end(), [&](const QuakePlace& a, const QuakePlace& b) {
      return glm::distance(a.eye, here) < glm::distance(b.eye, here);
    });
    const auto reached = std::find_if(left.begin(), left.end(), [&](const QuakePlace& place) {
      return glm::distance(place.eye, here) <= longest_way_m && obstacles.free_way(here, place.eye);
    });
    const auto next = reached == left.end() ? left.begin() : reached;
    if (reached == left.end()) {
      walker.appear_at(next->eye, next->heading_rad);
    } else {
      walker.go_to(next->eye);
    }
    left.erase(next);
    look_about();
  }
  return walker.track();
}

Track portal_track(const Scene& scene, double eye_height_m) {
  std::vector<glm::dvec3> points;
  CellId here = 0;
  CellId before = none_id;
  do {
    const auto portal = std::find_if(
        scene.portals.begin(), scene.portals.end(),
        [&](const Portal& candidate) { return candidate.from == here && candidate.to != before; });
    if (portal == scene.portals.end()) break;
    Aabb box;
    for (const glm::dvec3& corner : portal->polygon) box.extend(glm::vec3(corner));
    points.emplace_back(box.center().x, box.min.y + eye_height_m, box.center().z);
    before = here;
    here = portal->to;
  } while (here != 0 && points.size() <= scene.cells.size());
  if (here == 0 || points.size() == 1) points.push_back(points.front());
  return walk_track(points, 0.0);
}

}  // namespace vislab
