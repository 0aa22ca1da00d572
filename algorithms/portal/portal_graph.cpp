#include "algorithms/portal/portal_graph.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "algorithms/portal/window_cover.h"
#include "common/geometry/frustum.h"

namespace vislab::portal_culling {
namespace {

/// How far what lies in a cell may reach beyond the cell's planes: coordinates are rounded.
constexpr double region_slack_m = 1e-4;

/// A convex polygon whose edges are moved outward in its plane by `slack`; corners are moved by at
/// most ten times that.
ConvexPolygon enlarged(const ConvexPolygon& polygon, const glm::dvec3& normal, double slack) {
  ConvexPolygon larger;
  const std::size_t count = polygon.size();
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3& here = polygon[i];
    const glm::dvec3 in = glm::normalize(here - polygon[(i + count - 1) % count]);
    const glm::dvec3 out = glm::normalize(polygon[(i + 1) % count] - here);
    const glm::dvec3 a = glm::cross(in, normal);  // outward
    const glm::dvec3 b = glm::cross(out, normal);
    const double reach = std::min(1.0 / std::max(1.0 + glm::dot(a, b), 1e-6), 5.0);
    larger.push_back(here + (a + b) * (slack * reach));
  }
  return larger;
}

/// Corners without those that repeat the one before.
ConvexPolygon clean(const ConvexPolygon& corners) {
  ConvexPolygon polygon;
  for (const glm::dvec3& corner : corners) {
    if (polygon.empty() || glm::length(corner - polygon.back()) > 1e-9) polygon.push_back(corner);
  }
  while (polygon.size() > 1 && glm::length(polygon.back() - polygon.front()) <= 1e-9) {
    polygon.pop_back();
  }
  return polygon;
}

Aabb grown(const Aabb& box, float by) { return {box.min - glm::vec3(by), box.max + glm::vec3(by)}; }

}  // namespace

void PortalGraph::build(const Scene& scene) {
  add_openings(scene);
  add_regions(scene);
  add_objects(scene);
}

void PortalGraph::add_openings(const Scene& scene) {
  openings_.clear();
  corners_.clear();
  first_opening_.assign(scene.cells.size() + 1, 0);
  std::vector<std::uint32_t> order(scene.portals.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return scene.portals[i].from; });
  for (const std::uint32_t i : order) {
    const Portal& portal = scene.portals[i];
    const ConvexPolygon polygon = clean(portal.polygon);
    if (polygon.size() < 3) continue;
    Opening opening;
    opening.to = portal.to;
    opening.plane = portal.plane;
    opening.first_corner = static_cast<std::uint32_t>(corners_.size());
    for (const glm::dvec3& corner : enlarged(polygon, portal.plane.normal, portal_slack_m)) {
      corners_.push_back(corner);
    }
    opening.corner_count = static_cast<std::uint32_t>(corners_.size()) - opening.first_corner;
    openings_.push_back(opening);
    ++first_opening_[portal.from + 1];
  }
  std::partial_sum(first_opening_.begin(), first_opening_.end(), first_opening_.begin());
}

void PortalGraph::add_regions(const Scene& scene) {
  regions_.clear();
  cell_of_region_.clear();
  std::vector<Aabb> boxes;
  for (CellId cell = 0; cell < scene.cells.size(); ++cell) {
    for (const ConvexRegion& region : scene.cells[cell].regions) {
      regions_.push_back(region);
      cell_of_region_.push_back(cell);
      boxes.push_back(grown(region.bounds, static_cast<float>(2.0 * region_slack_m)));
    }
  }
  region_tree_.build(boxes);
}

void PortalGraph::add_objects(const Scene& scene) {
  objects_of_.assign(scene.cells.size(), {});
  free_.clear();
  std::vector<std::uint8_t> placed(scene.object_count(), 0);
  for (CellId cell = 0; cell < scene.cells.size(); ++cell) {
    objects_of_[cell] = scene.cells[cell].objects;
    for (const ObjectId object : objects_of_[cell]) placed[object] = 1;
  }
  for (ObjectId object = 0; object < scene.object_count(); ++object) {
    if (!placed[object]) free_.push_back(object);
  }
}

template <typename Visit>
void PortalGraph::for_each_region_near(const Aabb& box, Visit&& visit) const {
  const auto overlap = [](const Aabb& a, const Aabb& b) {
    return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
  };
  if (regions_.empty()) return;
  std::array<std::uint32_t, 128> stack;
  std::size_t size = 0;
  stack[size++] = Bvh::root;
  while (size > 0) {
    const std::uint32_t node = stack[--size];
    const SpatialNode& at = region_tree_.nodes()[node];
    if (!overlap(at.box, box)) continue;
    for (const ObjectId region : region_tree_.objects_at(node)) visit(region);
    for (std::uint32_t i = 0; i < at.child_count; ++i) stack[size++] = at.first_child + i;
  }
}

bool PortalGraph::start_cells(const Camera& camera, std::vector<CellId>& cells) const {
  cells.clear();
  const Lens& lens = camera.lens;
  const glm::dvec3 middle = camera.pose.eye - camera.pose.back * lens.near_m;
  WindowPiece window{{{{lens.left, lens.bottom},
                       {lens.right, lens.bottom},
                       {lens.right, lens.top},
                       {lens.left, lens.top}}},
                     4};
  Aabb box;
  for (const glm::dvec2& p : window.span()) {
    box.extend(glm::vec3(middle + camera.pose.right * p.x + camera.pose.up * p.y));
  }
  WindowCover cover(window);
  for_each_region_near(grown(box, 1e-4F), [&](std::uint32_t id) {
    WindowPiece reached = window;
    std::array<WindowLine, WindowPiece::capacity> lines;
    const std::vector<Plane>& planes = regions_[id].planes;
    const bool knows_all = planes.size() <= lines.size();
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const Plane& plane = planes[i];
      const WindowLine line{glm::dot(plane.normal, camera.pose.right),
                            glm::dot(plane.normal, camera.pose.up), plane.signed_distance(middle)};
      if (knows_all) lines[i] = line;
      if (!reached.cut(line.moved(region_slack_m))) return;
    }
    if (knows_all) cover.take_away({lines.data(), planes.size()});
    const CellId cell = cell_of_region_[id];
    if (std::ranges::find(cells, cell) == cells.end()) cells.push_back(cell);
  });
  return cover.complete();
}

void PortalGraph::cells_of(const Aabb& box, std::vector<CellId>& cells) const {
  cells.clear();
  for_each_region_near(box, [&](std::uint32_t id) {
    for (Plane plane : regions_[id].planes) {
      plane.d += region_slack_m;
      if (surely_outside(plane, box)) return;
    }
    const CellId cell = cell_of_region_[id];
    if (std::ranges::find(cells, cell) == cells.end()) cells.push_back(cell);
  });
}

std::size_t PortalGraph::bytes() const {
  std::size_t total =
      openings_.capacity() * sizeof(Opening) + first_opening_.capacity() * sizeof(std::uint32_t) +
      corners_.capacity() * sizeof(glm::dvec3) + region_tree_.bytes() +
      cell_of_region_.capacity() * sizeof(CellId) + free_.capacity() * sizeof(ObjectId);
  for (const ConvexRegion& region : regions_) {
    total += sizeof(region) + region.planes.capacity() * sizeof(Plane);
  }
  for (const auto& objects : objects_of_) {
    total += sizeof(objects) + objects.capacity() * sizeof(ObjectId);
  }
  return total;
}

}  // namespace vislab::portal_culling
