#include "common/scene/cell_objects.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "common/scene/convex_region.h"

namespace vislab {
namespace {

struct PlacedRegion {
  Aabb box;  // with the slack
  const ConvexRegion* region = nullptr;
  CellId cell = none_id;
};

bool overlap(const Aabb& a, const Aabb& b) {
  return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}

std::vector<PlacedRegion> regions_by_x(const Scene& scene) {
  const glm::vec3 slack(static_cast<float>(2.0 * reach_slack_m));
  std::vector<PlacedRegion> regions;
  for (CellId cell = 0; cell < scene.cells.size(); ++cell) {
    for (const ConvexRegion& region : scene.cells[cell].regions) {
      regions.push_back({{region.bounds.min - slack, region.bounds.max + slack}, &region, cell});
    }
  }
  std::ranges::stable_sort(regions, {}, [](const PlacedRegion& r) { return r.box.min.x; });
  return regions;
}

bool reaches_into(const Scene& scene, const Object& object, const PlacedRegion& place) {
  const Mesh& mesh = scene.meshes[object.mesh];
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::array<glm::dvec3, 3> corners = world_triangle(mesh, object.transform, t);
    Aabb box;
    for (const glm::dvec3& corner : corners) {
      if (contains(*place.region, corner, reach_slack_m)) return true;
      box.extend(glm::vec3(corner));
    }
    if (!overlap(box, place.box)) continue;
    const ConvexPolygon triangle(corners.begin(), corners.end());
    if (!clipped(triangle, *place.region, reach_slack_m).empty()) return true;
  }
  return false;
}

}  // namespace

void list_objects_of_cells(Scene& scene) {
  for (Cell& cell : scene.cells) cell.objects.clear();
  const std::vector<PlacedRegion> regions = regions_by_x(scene);
  std::vector<Aabb> boxes;
  for (const Object& object : scene.objects) {
    boxes.push_back(transformed(bounds_of(scene.meshes[object.mesh].positions), object.transform));
  }
  std::vector<ObjectId> order(scene.objects.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](ObjectId id) { return boxes[id].min.x; });
  // Regions that begin left of an object's right end stay until they end left of its left end.
  std::vector<const PlacedRegion*> open;
  std::size_t next = 0;
  for (const ObjectId id : order) {
    const Aabb& box = boxes[id];
    while (next < regions.size() && regions[next].box.min.x <= box.max.x) {
      open.push_back(&regions[next++]);
    }
    std::erase_if(open, [&](const PlacedRegion* r) { return r->box.max.x < box.min.x; });
    for (const PlacedRegion* place : open) {
      std::vector<ObjectId>& listed = scene.cells[place->cell].objects;
      const bool known = !listed.empty() && listed.back() == id;
      if (!known && overlap(box, place->box) && reaches_into(scene, scene.objects[id], *place)) {
        listed.push_back(id);
      }
    }
  }
  for (Cell& cell : scene.cells) std::ranges::sort(cell.objects);
}

}  // namespace vislab
