#include "common/judge/cell_leaks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "common/geometry/random.h"
#include "common/judge/ray_scene.h"
#include "common/scene/convex_region.h"
#include "common/scene/frame.h"
#include "common/scene/orientation.h"
#include "common/scene/transform.h"

namespace vislab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// What surfaces and edges of portals may miss the cells' boundary by. More than cells and portals
/// may among each other: game worlds round corners after their tree is made.
constexpr double surface_tolerance_m = 1e-3;
constexpr double aside_m =
    0.01;  // of starting points from their region's planes, if it is so thick

struct Line {
  glm::dvec3 from{0.0}, towards{0.0};  // a unit vector

  glm::dvec3 at(double distance) const { return from + towards * distance; }
};

/// How far a line stays in the region it starts in.
double way_through(const ConvexRegion& region, const Line& line) {
  double least = infinity;
  for (const Plane& plane : region.planes) {
    const double approach = -glm::dot(plane.normal, line.towards);
    if (approach > 0.0) least = std::min(least, plane.signed_distance(line.from) / approach);
  }
  return least;
}

/// Where a line leaves a cell, from region to region as they touch; `last` is the last of them.
double way_out(const Cell& cell, const ConvexRegion& first, const Line& line,
               const ConvexRegion*& last) {
  last = &first;
  double way = way_through(first, line);
  // A ray goes straight through each region once.
  for (std::size_t passed = 1; passed < cell.regions.size(); ++passed) {
    const glm::dvec3 beyond = line.at(way + 1e-6);
    const ConvexRegion* next = nullptr;
    double farther = way;
    for (const ConvexRegion& region : cell.regions) {
      if (&region == last || !contains(region, beyond, 1e-5)) continue;
      const double end = way_through(region, line);
      if (end > farther) {
        farther = end;
        next = &region;
      }
    }
    if (next == nullptr) break;
    last = next;
    way = farther;
  }
  return way;
}

/// A point well inside one of the cell's regions, dealt out by number.
std::optional<glm::dvec3> point_in(const ConvexRegion& region, Random& random) {
  for (int attempt = 0; attempt < 64; ++attempt) {
    glm::dvec3 point(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = random.uniform(region.bounds.min[axis], region.bounds.max[axis]);
    }
    if (contains(region, point, attempt < 32 ? -aside_m : -1e-6)) return point;
  }
  return std::nullopt;
}

class LeakFinder {
 public:
  explicit LeakFinder(const Scene& scene)
      : scene_(scene), state_(scene), rays_(scene), portals_(scene.cells.size()) {
    rays_.follow(state_.view());
    for (ObjectId object = 0; object < scene.object_count(); ++object) {
      any_closed_ = any_closed_ || scene.mesh_of(object).closed;
    }
    for (const Portal& portal : scene.portals) portals_[portal.from].push_back(&portal);
  }

  /// Where the line leaves the cell though no portal is there, and sees something behind.
  std::optional<glm::dvec3> leak(CellId cell, const ConvexRegion& region, const Line& line) const {
    const Hit hit = next_hit(line, 0.0);
    if (hit.triangle == none_id) return std::nullopt;
    const ConvexRegion* last = nullptr;
    const double way = way_out(scene_.cells[cell], region, line, last);
    if (hit.distance <= way + surface_tolerance_m ||
        contains(*last, line.at(hit.distance), surface_tolerance_m)) {
      return std::nullopt;
    }
    for (const Portal* portal : portals_[cell]) {
      if (passes(*portal, line, way)) return std::nullopt;
    }
    return line.at(way);
  }

  /// Is the first that the line meets of some closed object its inside?
  bool starts_in_closed_object(const Line& line) const {
    if (!any_closed_) return false;
    std::vector<ObjectId> entered;
    for (Hit hit = next_hit(line, 0.0); hit.triangle != none_id;
         hit = next_hit(line, 1e-6 + hit.distance * (1.0 + 1e-6))) {
      const ObjectId object = scene_.object_of(hit.triangle);
      if (!scene_.mesh_of(object).closed || std::ranges::find(entered, object) != entered.end()) {
        continue;
      }
      if (from_inside(object, hit.triangle, line)) return true;
      entered.push_back(object);
    }
    return false;
  }

 private:
  /// Through the portal, or as good as along its edge, before the line is out of the cell.
  static bool passes(const Portal& portal, const Line& line, double way) {
    const double approach = -glm::dot(portal.plane.normal, line.towards);
    if (!(approach > 0.0)) return false;
    const double distance = portal.plane.signed_distance(line.from) / approach;
    if (distance < 0.0 || (distance - way) * approach > surface_tolerance_m) return false;
    const glm::dvec3 place = line.at(distance);
    for (std::size_t i = 0; i < portal.polygon.size(); ++i) {
      const glm::dvec3& a = portal.polygon[i];
      const glm::dvec3 edge = portal.polygon[(i + 1) % portal.polygon.size()] - a;
      const glm::dvec3 inward = glm::cross(portal.plane.normal, edge);
      if (glm::dot(inward, place - a) < -surface_tolerance_m * glm::length(edge)) return false;
    }
    return true;
  }

  struct Hit {
    TriangleId triangle = none_id;  // none_id: nothing is hit
    double distance = infinity;
  };

  Hit next_hit(const Line& line, double after) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    const glm::vec3 from(line.from - scene_.origin());
    RTCRayHit ray{};
    ray.ray.org_x = from.x;
    ray.ray.org_y = from.y;
    ray.ray.org_z = from.z;
    ray.ray.dir_x = static_cast<float>(line.towards.x);
    ray.ray.dir_y = static_cast<float>(line.towards.y);
    ray.ray.dir_z = static_cast<float>(line.towards.z);
    ray.ray.tnear = static_cast<float>(after);
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = 0xFFFFFFFFU;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(rays_.handle(), &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {rays_.triangle_of(ray.hit.geomID, ray.hit.primID, ray.hit.instID[0]),
            double{ray.ray.tfar}};
  }

  bool from_inside(ObjectId object, TriangleId triangle, const Line& line) const {
    const std::array<glm::dvec3, 3> corners = rays_.triangle(triangle);
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double side = determinant(scene_.objects[object].transform) < 0.0 ? -1.0 : 1.0;
    return side * glm::dot(normal, line.towards) > 0.0;
  }

  const Scene& scene_;
  SceneState state_;
  RayScene rays_;
  bool any_closed_ = false;
  std::vector<std::vector<const Portal*>> portals_;  // by cell they lead out of
};

}  // namespace

CellLeaks find_cell_leaks(const Scene& scene, std::size_t rays_per_cell, std::uint64_t seed) {
  CellLeaks found;
  if (scene.cells.empty()) return found;
  const LeakFinder finder(scene);
  Random random(seed);
  for (CellId cell = 0; cell < scene.cells.size(); ++cell) {
    const std::vector<ConvexRegion>& regions = scene.cells[cell].regions;
    if (regions.empty()) {
      if (found.unchecked_cells++ == 0) found.first_unchecked = cell;
      continue;
    }
    const std::size_t before = found.leaks.count;
    std::size_t looks = 0;
    std::size_t inside_objects = 0;
    for (std::size_t i = 0; i < rays_per_cell; ++i) {
      const ConvexRegion& region = regions[i % regions.size()];
      const std::optional<glm::dvec3> start = point_in(region, random);
      const Line line{start.value_or(glm::dvec3(0.0)), random_direction(random)};
      if (!start) continue;
      if (finder.starts_in_closed_object(line)) {
        ++inside_objects;
        continue;
      }
      ++looks;
      const std::optional<glm::dvec3> place = finder.leak(cell, region, line);
      if (place && found.leaks.count++ == 0) found.leaks = {1, cell, none_id, *place};
    }
    if (found.leaks.count > before) ++found.leaking_cells;
    found.rays += looks;
    found.rays_inside_objects += inside_objects;
    if (looks > inside_objects) continue;
    if (found.unchecked_cells++ == 0) found.first_unchecked = cell;
  }
  return found;
}

}  // namespace vislab
