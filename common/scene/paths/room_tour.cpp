// A way through the rooms of a building, from door to door.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/geometry/convex_polygon.h"
#include "common/scene/paths/tracks.h"

namespace vislab {
namespace {

constexpr double before_door_m = 0.6;
constexpr double lying = 0.7;  // of a portal's normal upward: it is in a floor

/// Where one goes through: a point before the portal, one in it, and one behind.
struct Passage {
  std::vector<glm::dvec3> points;
  CellId to = none_id;
};

/// Nothing for openings that nobody fits through: windows and cracks.
std::optional<Passage> passage_through(const Portal& portal, double eye_height_m) {
  constexpr double least_height_m = 1.5, least_width_m = 0.4;
  glm::dvec3 low = portal.polygon.front();
  glm::dvec3 high = low;
  for (const glm::dvec3& corner : portal.polygon) {
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  const glm::dvec3 size = high - low;
  glm::dvec3 middle = 0.5 * (low + high);
  glm::dvec3 back = portal.plane.normal;
  if (std::abs(back.y) > lying) {
    if (std::min(size.x, size.z) < least_width_m) return std::nullopt;
    back = {0.0, back.y > 0.0 ? 1.0 : -1.0, 0.0};
  } else {
    if (size.y < least_height_m || std::hypot(size.x, size.z) < least_width_m) return std::nullopt;
    middle.y = low.y + std::min(eye_height_m, 0.8 * size.y);
    back = glm::normalize(glm::dvec3(back.x, 0.0, back.z));
  }
  return Passage{{middle + back * before_door_m, middle, middle - back * before_door_m}, portal.to};
}

/// Depth first: into every cell that was not visited yet, and back the same way.
class Tour {
 public:
  Tour(const Scene& scene, int rooms, double eye_height_m)
      : passages_(scene.cells.size()), visited_(scene.cells.size(), 0), left_(rooms - 1) {
    for (const Portal& portal : scene.portals) {
      std::optional<Passage> passage = passage_through(portal, eye_height_m);
      if (passage) passages_[portal.from].push_back(std::move(*passage));
    }
    visited_[0] = 1;
    visit_all();
  }

  std::vector<glm::dvec3> points;

 private:
  struct Stop {
    CellId cell = 0;
    std::size_t next = 0;  // of its passages
    const Passage* way_in = nullptr;
  };

  void visit_all() {
    std::vector<Stop> stops{{0, 0, nullptr}};
    while (!stops.empty() && left_ > 0) {
      Stop& here = stops.back();
      if (here.next == passages_[here.cell].size()) {
        if (here.way_in != nullptr) {
          const std::vector<glm::dvec3>& in = here.way_in->points;
          points.insert(points.end(), in.rbegin(), in.rend());
        }
        stops.pop_back();
        continue;
      }
      const Passage& passage = passages_[here.cell][here.next++];
      if (visited_[passage.to] != 0) continue;
      visited_[passage.to] = 1;
      --left_;
      points.insert(points.end(), passage.points.begin(), passage.points.end());
      stops.push_back({passage.to, 0, &passage});
    }
  }

  std::vector<std::vector<Passage>> passages_;  // by cell
  std::vector<std::uint8_t> visited_;
  int left_ = 0;  // rooms to visit
};

}  // namespace

Track room_tour_track(const Scene& scene, int rooms, double eye_height_m) {
  const Tour tour(scene, rooms, eye_height_m);
  if (tour.points.empty()) return {};
  return walk_track(tour.points, 0.0);
}

}  // namespace vislab
