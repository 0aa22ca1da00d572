// A walk through a Quake III world.
//
// Idea: two openings of the same leaf are joined by a straight line that stays within the leaf,
//   which is convex; such a line is a way if a walker's body meets no triangle along it. Ways
//   between places are the shortest in the graph of openings (Dijkstra 1959), and are then pulled
//   straight where that is free. Where nothing is near below, a way counts several times its
//   length, so that walkers do not fly where they can walk.
// Limits: doors stay closed.
// Cost: O(openings of a leaf squared) lines, each tried against the triangles of the leaves that
//   it passes through.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <queue>
#include <utility>
#include <vector>

#include "common/scene/paths/tracks.h"
#include "common/scene/quake_leaves.h"
#include "common/scene/quake_reach.h"
#include "common/scene/quake_world.h"

namespace vislab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double eye_height_m = 50.0 * quake_unit_m;
constexpr double body_m = 0.35;
constexpr double flight_cost = 4.0;

/// A world's triangles by leaf, for straight lines to be tried against.
class Walls {
 public:
  explicit Walls(const Scene& scene) : world_(*scene.quake), of_leaf_(world_.leaves.size()) {
    std::vector<std::uint32_t> leaves;
    for (const Object& object : scene.objects) {
      const Mesh& mesh = scene.meshes[object.mesh];
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto id = static_cast<std::uint32_t>(triangles_.size());
        triangles_.push_back(world_triangle(mesh, object.transform, t));
        leaves.clear();
        add_leaves_reached(world_, triangles_.back(), leaves);
        for (const std::uint32_t leaf : leaves) of_leaf_[leaf].push_back(id);
      }
    }
  }

  /// Does a line stay in leaves that are not solid, and meet no triangle?
  bool free_line(const glm::dvec3& from, const glm::dvec3& to) const {
    return free_below(0, from, to, from, to);
  }

  /// True if a walker's body fits along the line and beyond its ends.
  bool free_way(const glm::dvec3& from, const glm::dvec3& to) const {
    const glm::dvec3 step = to - from;
    const double flat = std::hypot(step.x, step.z);
    const glm::dvec3 onward = flat > 1e-9 ? glm::dvec3(step.x, 0.0, step.z) * (body_m / flat)
                                          : glm::dvec3(body_m, 0.0, 0.0);
    const glm::dvec3 across(-onward.z, 0.0, onward.x);
    const glm::dvec3 up(0.0, body_m, 0.0);
    if (!free_line(from - onward, from + onward) || !free_line(to - onward, to + onward)) {
      return false;
    }
    return std::ranges::all_of(
        std::array{glm::dvec3(0.0), across, -across, up, -up},
        [&](const glm::dvec3& aside) { return free_line(from + aside, to + aside); });
  }

 private:
  /// The part from `a` to `b` of a line lies in the node's region.
  bool free_below(std::int32_t node, const glm::dvec3& a, const glm::dvec3& b,
                  const glm::dvec3& from, const glm::dvec3& to) const {
    if (node < 0) {
      const auto leaf = static_cast<std::size_t>(-(node + 1));
      if (world_.leaves[leaf].cluster < 0) return false;
      return std::ranges::none_of(
          of_leaf_[leaf], [&](std::uint32_t id) { return meets(triangles_[id], from, to - from); });
    }
    const QuakeNode& record = world_.nodes[static_cast<std::size_t>(node)];
    const Plane& plane = world_.planes[record.plane];
    const double at_a = plane.signed_distance(a);
    const double at_b = plane.signed_distance(b);
    if (at_a >= 0.0 && at_b >= 0.0) return free_below(record.front, a, b, from, to);
    if (at_a < 0.0 && at_b < 0.0) return free_below(record.back, a, b, from, to);
    const glm::dvec3 cut = a + (b - a) * (at_a / (at_a - at_b));
    return free_below(at_a >= 0.0 ? record.front : record.back, a, cut, from, to) &&
           free_below(at_a >= 0.0 ? record.back : record.front, cut, b, from, to);
  }

  /// Moeller and Trumbore 1997, from either side.
  static bool meets(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& from,
                    const glm::dvec3& step) {
    const glm::dvec3 edge1 = corners[1] - corners[0];
    const glm::dvec3 edge2 = corners[2] - corners[0];
    const glm::dvec3 p = glm::cross(step, edge2);
    const double determinant = glm::dot(edge1, p);
    if (determinant == 0.0) return false;
    const glm::dvec3 s = from - corners[0];
    const double u = glm::dot(s, p) / determinant;
    const glm::dvec3 q = glm::cross(s, edge1);
    const double v = glm::dot(step, q) / determinant;
    const double t = glm::dot(edge2, q) / determinant;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 && t <= 1.0;
  }

  const QuakeWorld& world_;
  std::vector<std::array<glm::dvec3, 3>> triangles_;
  std::vector<std::vector<std::uint32_t>> of_leaf_;
};

glm::dvec3 middle_of(const ConvexPolygon& polygon) {
  glm::dvec3 low(infinity);
  glm::dvec3 high(-infinity);
  for (const glm::dvec3& corner : polygon) {
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  return 0.5 * (low + high);
}

/// Places first, then openings, as points; the leaves that each lies in say which may be joined.
class WayFinder {
 public:
  explicit WayFinder(const Scene& scene)
      : world_(*scene.quake), walls_(scene), points_of_leaf_(world_.leaves.size()) {
    for (const QuakePlace& place : world_.places) add(place.eye, {place.leaf, place.leaf});
    const LeafShapes shapes = shapes_of_leaves(world_, scene.bounds());
    for (const LeafFace& face : shapes.faces) {
      if (face.front == none_id || face.back == none_id) continue;
      if (world_.leaves[face.front].cluster < 0 || world_.leaves[face.back].cluster < 0) continue;
      add(crossing(face), {face.front, face.back});
    }
  }

  /// How long the ways from a place to all points are; infinite where there is none.
  const std::vector<double>& lengths_from(std::uint32_t place) {
    const std::size_t count = points_.size();
    length_.assign(count, infinity);
    before_.assign(count, none_id);
    std::vector<std::uint8_t> done(count, 0);
    using Entry = std::pair<double, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
    length_[place] = 0.0;
    waiting.emplace(0.0, place);
    while (!waiting.empty()) {
      const std::uint32_t here = waiting.top().second;
      waiting.pop();
      if (done[here]++ != 0) continue;
      for (const std::uint32_t leaf : points_[here].leaves) {
        for (const std::uint32_t next : points_of_leaf_[leaf]) {
          if (done[next] != 0 || !(length_[here] + cost(here, next) < length_[next])) continue;
          if (!joined(here, next)) continue;
          length_[next] = length_[here] + cost(here, next);
          before_[next] = here;
          waiting.emplace(length_[next], next);
        }
      }
    }
    return length_;
  }

  /// The way of the last call of lengths_from to a point that it reached, pulled straight.
  std::vector<glm::dvec3> way_to(std::uint32_t point) const {
    std::vector<glm::dvec3> corners;
    for (std::uint32_t at = point; at != none_id; at = before_[at]) {
      corners.push_back(points_[at].position);
    }
    std::ranges::reverse(corners);
    std::vector<glm::dvec3> way{corners.front()};
    for (std::size_t here = 0; here + 1 < corners.size();) {
      std::size_t next = corners.size() - 1;
      while (next > here + 1 && !straight(corners, here, next)) --next;
      way.push_back(corners[next]);
      here = next;
    }
    return way;
  }

 private:
  struct Point {
    glm::dvec3 position;
    std::array<std::uint32_t, 2> leaves;  // the same twice for places
    bool near_ground;
  };

  void add(const glm::dvec3& position, const std::array<std::uint32_t, 2>& leaves) {
    const auto id = static_cast<std::uint32_t>(points_.size());
    const bool in_the_air = walls_.free_line(position, position - glm::dvec3(0.0, 2.0, 0.0));
    points_.push_back({position, leaves, !in_the_air});
    points_of_leaf_[leaves[0]].push_back(id);
    if (leaves[1] != leaves[0]) points_of_leaf_[leaves[1]].push_back(id);
  }

  /// Where a walker passes through an opening: at eye height if it goes down to the ground and is
  /// high enough, else in its middle.
  static glm::dvec3 crossing(const LeafFace& face) {
    const glm::dvec3 middle = middle_of(face.polygon);
    if (std::abs(face.plane.normal.y) > 0.01) return middle;
    double low = infinity;
    double high = -infinity;
    for (std::size_t i = 0; i < face.polygon.size(); ++i) {
      const glm::dvec3& a = face.polygon[i];
      const glm::dvec3& b = face.polygon[(i + 1) % face.polygon.size()];
      const glm::dvec2 along(face.plane.normal.z, -face.plane.normal.x);
      const double at_a = glm::dot(along, glm::dvec2(a.x - middle.x, a.z - middle.z));
      const double at_b = glm::dot(along, glm::dvec2(b.x - middle.x, b.z - middle.z));
      if ((at_a < 0.0) == (at_b < 0.0)) continue;
      const double height = a.y + (b.y - a.y) * (at_a / (at_a - at_b));
      low = std::min(low, height);
      high = std::max(high, height);
    }
    if (!(low < high)) return middle;
    return {middle.x, std::min(low + eye_height_m, 0.5 * (low + high)), middle.z};
  }

  double cost(std::uint32_t a, std::uint32_t b) const {
    const double length = glm::distance(points_[a].position, points_[b].position);
    return points_[a].near_ground && points_[b].near_ground ? length : flight_cost * length;
  }

  bool joined(std::uint32_t a, std::uint32_t b) {
    const auto [entry, is_new] = joined_.try_emplace(std::minmax(a, b), false);
    if (is_new) {
      const auto& [first, second] = entry->first;
      entry->second = walls_.free_way(points_[first].position, points_[second].position);
    }
    return entry->second;
  }

  /// Is the straight line free, and not far from the way that it cuts short?
  bool straight(const std::vector<glm::dvec3>& corners, std::size_t from, std::size_t to) const {
    const glm::dvec3 step = corners[to] - corners[from];
    const double length = glm::length(step);
    if (length < 1e-9) return true;
    for (std::size_t i = from + 1; i < to; ++i) {
      const glm::dvec3 arm = corners[i] - corners[from];
      const glm::dvec3 aside = arm - step * (glm::dot(arm, step) / (length * length));
      if (std::abs(aside.y) > 0.5) return false;
    }
    return walls_.free_way(corners[from], corners[to]);
  }

  const QuakeWorld& world_;
  Walls walls_;
  std::vector<Point> points_;
  std::vector<std::vector<std::uint32_t>> points_of_leaf_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> joined_;
  std::vector<double> length_;         // of the last call
  std::vector<std::uint32_t> before_;  // of the last call
};

/// The first place, and then always the one farthest from those that were chosen, among those that
/// have a way from the first.
std::vector<std::uint32_t> chosen_places(const std::vector<QuakePlace>& places,
                                         const std::vector<double>& lengths, int count) {
  std::vector<double> distance(places.size(), infinity);
  std::vector<std::uint32_t> chosen{0};
  while (static_cast<int>(chosen.size()) < count) {
    std::uint32_t farthest = 0;
    double largest = 1.0;  // nearer ones are as good as the same
    for (std::uint32_t i = 0; i < places.size(); ++i) {
      distance[i] = std::min(distance[i], glm::distance(places[i].eye, places[chosen.back()].eye));
      if (std::isinf(lengths[i]) || distance[i] <= largest) continue;
      largest = distance[i];
      farthest = i;
    }
    if (farthest == 0) break;
    chosen.push_back(farthest);
  }
  return chosen;
}

}  // namespace

Track quake_tour_track(const Scene& scene, int places) {
  constexpr double look_rad = 2.0 * std::numbers::pi / 3.0;
  const std::vector<QuakePlace>& all = scene.quake->places;
  WayFinder finder(scene);
  std::vector<std::uint32_t> left = chosen_places(all, finder.lengths_from(0), places);
  std::uint32_t here = 0;
  left.erase(left.begin());
  Walker walker(all[here].eye, all[here].heading_rad);
  walker.turn_by(look_rad);
  while (!left.empty()) {
    const std::vector<double>& lengths = finder.lengths_from(here);
    const auto nearest =
        std::ranges::min_element(left, {}, [&](std::uint32_t place) { return lengths[place]; });
    here = *nearest;
    left.erase(nearest);
    const std::vector<glm::dvec3> way = finder.way_to(here);
    for (std::size_t i = 1; i < way.size(); ++i) walker.go_to(way[i]);
    walker.turn_by(look_rad);
  }
  return walker.track();
}

}  // namespace vislab
