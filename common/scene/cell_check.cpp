#include "common/scene/cell_check.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/scene/convex_region.h"

namespace vislab {
namespace {

void note(CellFault& fault, CellId cell, CellId other, const glm::dvec3& place) {
  if (fault.count++ == 0) fault = {1, cell, other, place};
}

bool in_cell(const Cell& cell, const glm::dvec3& point, double slack) {
  return std::ranges::any_of(
      cell.regions, [&](const ConvexRegion& region) { return contains(region, point, slack); });
}

bool in_any_cell(const Scene& scene, const glm::dvec3& point) {
  return std::ranges::any_of(scene.cells,
                             [&](const Cell& cell) { return in_cell(cell, point, 0.0); });
}

CellFault find_overlaps(const Scene& scene) {
  struct Placed {
    const ConvexRegion* region;
    CellId cell;
  };
  std::vector<Placed> regions;
  for (CellId cell = 0; cell < scene.cells.size(); ++cell) {
    for (const ConvexRegion& region : scene.cells[cell].regions) regions.push_back({&region, cell});
  }
  std::ranges::stable_sort(regions, {}, [](const Placed& r) { return r.region->bounds.min.x; });
  std::set<std::pair<CellId, CellId>> known;
  CellFault overlaps;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    for (std::size_t k = i + 1; k < regions.size(); ++k) {
      if (regions[k].region->bounds.min.x > regions[i].region->bounds.max.x) break;
      const auto cells = std::minmax(regions[i].cell, regions[k].cell);
      if (cells.first == cells.second || known.contains(cells)) continue;
      const std::optional<glm::dvec3> place =
          shared_point(*regions[i].region, *regions[k].region, cell_tolerance_m);
      if (!place) continue;
      known.insert(cells);
      note(overlaps, cells.first, cells.second, *place);
    }
  }
  return overlaps;
}

/// The middle, and points near the corners.
std::vector<glm::dvec3> points_of(const Portal& portal) {
  glm::dvec3 middle(0.0);
  for (const glm::dvec3& corner : portal.polygon) middle += corner;
  middle /= static_cast<double>(portal.polygon.size());
  std::vector<glm::dvec3> points{middle};
  for (const glm::dvec3& corner : portal.polygon) points.push_back(glm::mix(middle, corner, 0.95));
  return points;
}

/// Is the cell on the side of `towards` of the point only, and not on the other?
bool only_behind(const Cell& cell, const glm::dvec3& point, const glm::dvec3& towards) {
  constexpr double step = 2.0 * cell_tolerance_m;
  return in_cell(cell, point - towards * step, -0.5 * step) &&
         !in_cell(cell, point + towards * step, -0.5 * step);
}

/// Narrower than the tolerance, as rounding leaves some between a map's leaves: no point of it has
/// a side.
bool is_sliver(const Portal& portal) {
  double length = 0.0;
  for (std::size_t i = 0; i < portal.polygon.size(); ++i) {
    length += glm::distance(portal.polygon[i], portal.polygon[(i + 1) % portal.polygon.size()]);
  }
  return 2.0 * area(portal.polygon) < cell_tolerance_m * length;
}

void try_portal(const Scene& scene, const Portal& portal, CellCheck& check) {
  const Cell& from = scene.cells[portal.from];
  const Cell& to = scene.cells[portal.to];
  const glm::dvec3 back = portal.plane.normal;
  for (const glm::dvec3& point : points_of(portal)) {
    const bool before = in_cell(from, point, cell_tolerance_m);
    const bool behind = in_cell(to, point, cell_tolerance_m);
    if (before && behind) {
      if (!only_behind(from, point, back) && !only_behind(to, point, -back)) continue;
      return note(check.off, portal.from, portal.to, point);
    }
    const glm::dvec3 missing = point + back * (before ? -2.0 : 2.0) * cell_tolerance_m;
    const bool gap = before != behind && !in_any_cell(scene, missing);
    return note(gap ? check.gaps : check.off, portal.from, portal.to, point);
  }
}

}  // namespace

CellCheck check_cells(const Scene& scene) {
  CellCheck check;
  check.overlaps = find_overlaps(scene);
  for (const Portal& portal : scene.portals) {
    if (!is_sliver(portal)) try_portal(scene, portal, check);
  }
  return check;
}

}  // namespace vislab
