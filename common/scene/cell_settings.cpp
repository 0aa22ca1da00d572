#include "common/scene/cell_settings.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "common/scene/cell_check.h"
#include "common/scene/convex_region.h"
#include "common/scene/error.h"

namespace vislab {
namespace {

constexpr double repeated_m = 1e-6;  // corners nearer to each other are the same one
/// The sine of a turn that counts as none: decimals that are rounded to six digits put a corner so
/// far off a straight edge.
constexpr double straight = 1e-6;

std::vector<ConvexRegion> read_boxes(const Settings& table) {
  const std::vector<glm::dvec3> corners = table.points("boxes");
  if (corners.empty() || corners.size() % 2 != 0) {
    throw InputError(table.where() +
                     ": `boxes` is wrong; it must be a lower and an upper corner for each box");
  }
  std::vector<ConvexRegion> regions;
  for (std::size_t i = 0; i < corners.size(); i += 2) {
    if (!glm::all(glm::lessThan(corners[i], corners[i + 1]))) {
      throw InputError(table.where() + ": box " + std::to_string(i / 2) +
                       " of `boxes` is wrong; its lower corner must be below its upper one on " +
                       "every axis");
    }
    regions.push_back(box_region(corners[i], corners[i + 1]));
  }
  return regions;
}

ConvexRegion read_planes(const Settings& table) {
  const std::vector<glm::dvec3> points = table.points("through");
  const std::vector<glm::dvec3> normals = table.points("inward");
  if (points.size() != normals.size()) {
    throw InputError(table.where() + ": `through` and `inward` must have an entry for each plane");
  }
  std::vector<Plane> planes;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double length = glm::length(normals[i]);
    if (!(length > 0.0 && std::isfinite(length))) {
      throw InputError(table.where() + ": vector " + std::to_string(i) +
                       " of `inward` is wrong; it must not be zero");
    }
    const glm::dvec3 normal = normals[i] / length;
    planes.push_back({normal, -glm::dot(normal, points[i])});
  }
  std::optional<ConvexRegion> region = region_inside(std::move(planes));
  if (!region) {
    throw InputError(table.where() +
                     ": the planes bound no region; they must enclose one on all sides");
  }
  return *region;
}

Cell read_cell(const Settings& table) {
  Cell cell;
  if (table.has("boxes") == table.has("through")) {
    throw InputError(table.where() + ": a cell needs either `boxes` or `through` and `inward`");
  }
  if (table.has("boxes")) {
    cell.regions = read_boxes(table);
  } else {
    cell.regions = {read_planes(table)};
  }
  for (const ConvexRegion& region : cell.regions) cell.bounds.extend(region.bounds);
  table.done();
  return cell;
}

/// Corners without those that repeat the one before.
ConvexPolygon without_repeated(const std::vector<glm::dvec3>& corners) {
  ConvexPolygon polygon;
  for (const glm::dvec3& corner : corners) {
    if (polygon.empty() || glm::distance(corner, polygon.back()) > repeated_m) {
      polygon.push_back(corner);
    }
  }
  while (polygon.size() > 1 && glm::distance(polygon.back(), polygon.front()) <= repeated_m) {
    polygon.pop_back();
  }
  return polygon;
}

/// Every corner turns left or goes straight on, and all of them together turn once round: a star
/// turns left everywhere as well, but twice round.
bool turns_once_round(const ConvexPolygon& polygon, const glm::dvec3& normal) {
  const std::size_t count = polygon.size();
  double turned = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3& here = polygon[(i + 1) % count];
    const glm::dvec3 in = glm::normalize(here - polygon[i]);
    const glm::dvec3 out = glm::normalize(polygon[(i + 2) % count] - here);
    const double left = glm::dot(glm::cross(in, out), normal);
    const double ahead = glm::dot(in, out);
    const bool turns_back = ahead < 0.0 && left <= straight;
    if (!(left >= -straight) || turns_back) return false;
    turned += std::atan2(left, ahead);
  }
  return turned < 3.0 * std::numbers::pi;
}

void require_convex(const Settings& table, const Portal& portal) {
  for (const glm::dvec3& corner : portal.polygon) {
    const double off = std::abs(portal.plane.signed_distance(corner));
    if (off <= cell_tolerance_m) continue;
    throw InputError(table.where() +
                     ": `corners` is wrong; it must be a polygon in one plane, but " +
                     "a corner is " + std::to_string(off) + " m away from that of the others");
  }
  if (!turns_once_round(portal.polygon, portal.plane.normal)) {
    throw InputError(
        table.where() +
        ": `corners` is wrong; it must be a convex polygon, whose outline turns left " +
        "at each corner and once round in all");
  }
}

void read_portal(const Settings& table, std::size_t cells, std::vector<Portal>& portals) {
  const auto last = static_cast<std::int64_t>(cells) - 1;
  const auto from = static_cast<CellId>(table.whole("from", 0, last));
  const auto to = static_cast<CellId>(table.whole("to", 0, last));
  const ConvexPolygon corners = without_repeated(table.points("corners"));
  table.done();
  if (from == to) throw InputError(table.where() + ": `from` and `to` must be different cells");
  if (corners.size() < 3 || !(area(corners) > 0.0)) {
    throw InputError(
        table.where() +
        ": `corners` is wrong; it must be a polygon of three different corners or more");
  }
  portals.push_back(make_portal(corners, from, to));
  require_convex(table, portals.back());
  portals.push_back(make_portal({corners.rbegin(), corners.rend()}, to, from));
}

}  // namespace

DescribedCells read_cells(const Settings& scene) {
  DescribedCells described;
  if (scene.has("cells")) {
    for (const Settings& table : scene.tables("cells")) described.cells.push_back(read_cell(table));
  }
  if (scene.has("portals")) {
    if (described.cells.empty()) {
      throw InputError(scene.where() + ": `portals` needs `cells` beside it");
    }
    for (const Settings& table : scene.tables("portals")) {
      read_portal(table, described.cells.size(), described.portals);
    }
  }
  return described;
}

}  // namespace vislab
