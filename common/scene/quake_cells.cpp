#include "common/scene/quake_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>

#include "common/scene/error.h"
#include "common/scene/quake_gaps.h"
#include "common/scene/quake_leaves.h"

namespace vislab {
namespace {

constexpr double convex_tolerance_m = 0.01;
/// Leaves' boxes are in whole units; compilers are up to two off.
constexpr double box_tolerance_m = 4.0 * quake_unit_m;
constexpr double smallest_opening_m2 = 1e-4;

/// A face as one of its cells sees it.
struct CellFace {
  std::uint32_t face = 0;
  bool in_front = false;  // the cell is in front of it
};

struct Piece {
  Plane plane;
  ConvexPolygon polygon;
};

struct WorkCell {
  std::vector<std::uint32_t> leaves;
  std::vector<CellFace> faces;
};

class CellMaker {
 public:
  CellMaker(const QuakeWorld& world, LeafShapes shapes, const QuakeCellLimits& limits)
      : shapes_(std::move(shapes)), limits_(limits), cell_of_leaf_(world.leaves.size(), none_id) {
    for (std::uint32_t leaf = 0; leaf < world.leaves.size(); ++leaf) {
      if (world.leaves[leaf].cluster < 0 || shapes_.faces_of_leaf[leaf].empty()) continue;
      cell_of_leaf_[leaf] = static_cast<CellId>(cells_.size());
      WorkCell cell;
      cell.leaves.push_back(leaf);
      for (const std::uint32_t face : shapes_.faces_of_leaf[leaf]) {
        cell.faces.push_back({face, shapes_.faces[face].front == leaf});
      }
      cells_.push_back(std::move(cell));
    }
  }

  QuakeCells run() {
    if (limits_.cells == QuakeCellLimits::Cells::leaves) return result();
    while (join_pass([&](CellId a, CellId b) { return convex_together(a, b); })) {
    }
    while (join_pass([&](CellId a, CellId b) {
      return std::min(volume(cells_[a]), volume(cells_[b])) < limits_.smallest_m3;
    })) {
    }
    return result();
  }

 private:
  CellId cell_beyond(const CellFace& face) const {
    const LeafFace& shape = shapes_.faces[face.face];
    const std::uint32_t leaf = face.in_front ? shape.back : shape.front;
    return leaf == none_id ? none_id : cell_of_leaf_[leaf];
  }

  /// Joins pairs that `join` allows, those first that share most; true if there were any.
  template <typename Join>
  bool join_pass(Join&& join) {
    struct Pair {
      double area;
      CellId a, b;
    };
    std::vector<Pair> pairs;
    for (CellId a = 0; a < cells_.size(); ++a) {
      std::map<CellId, double> shared;
      for (const CellFace& face : cells_[a].faces) {
        const CellId b = cell_beyond(face);
        if (b != none_id && b > a) shared[b] += area(shapes_.faces[face.face].polygon);
      }
      for (const auto& [b, shared_area] : shared) pairs.push_back({shared_area, a, b});
    }
    std::ranges::stable_sort(pairs, std::ranges::greater(), &Pair::area);
    std::vector<std::uint8_t> touched(cells_.size(), 0);
    bool any = false;
    for (const Pair& pair : pairs) {
      if (touched[pair.a] || touched[pair.b] || !join(pair.a, pair.b)) continue;
      touched[pair.a] = touched[pair.b] = 1;
      unite(pair.a, pair.b);
      any = true;
    }
    return any;
  }

  void unite(CellId a, CellId b) {
    WorkCell& into = cells_[a];
    WorkCell& from = cells_[b];
    std::erase_if(into.faces, [&](const CellFace& face) { return cell_beyond(face) == b; });
    for (const CellFace& face : from.faces) {
      if (cell_beyond(face) != a) into.faces.push_back(face);
    }
    for (const std::uint32_t leaf : from.leaves) cell_of_leaf_[leaf] = a;
    into.leaves.insert(into.leaves.end(), from.leaves.begin(), from.leaves.end());
    from = {};
  }

  /// Is no corner of either cell behind a face of the other that they do not share?
  bool convex_together(CellId a, CellId b) const { return none_behind(a, b) && none_behind(b, a); }

  bool none_behind(CellId a, CellId b) const {
    for (const CellFace& face : cells_[a].faces) {
      if (cell_beyond(face) == b) continue;
      const Plane& plane = shapes_.faces[face.face].plane;
      const double sign = face.in_front ? 1.0 : -1.0;
      for (const CellFace& other : cells_[b].faces) {
        for (const glm::dvec3& corner : shapes_.faces[other.face].polygon) {
          if (sign * plane.signed_distance(corner) < -convex_tolerance_m) return false;
        }
      }
    }
    return true;
  }

  double volume(const WorkCell& cell) const {
    double sum = 0.0;
    for (const CellFace& face : cell.faces) {
      const LeafFace& shape = shapes_.faces[face.face];
      const double cone = glm::dot(area_vector(shape.polygon), shape.polygon[0]);
      sum += face.in_front ? -cone : cone;  // outward
    }
    return sum / 6.0;
  }

  QuakeCells result() const {
    QuakeCells found;
    std::vector<CellId> name(cells_.size(), none_id);
    for (CellId id = 0; id < cells_.size(); ++id) {
      if (cells_[id].leaves.empty()) continue;
      name[id] = static_cast<CellId>(found.cells.size());
      found.cells.push_back(finished(cells_[id]));
    }
    found.cell_of_leaf.resize(cell_of_leaf_.size(), none_id);
    for (std::size_t leaf = 0; leaf < cell_of_leaf_.size(); ++leaf) {
      if (cell_of_leaf_[leaf] != none_id) found.cell_of_leaf[leaf] = name[cell_of_leaf_[leaf]];
    }
    add_portals(name, found.portals);
    return found;
  }

  Cell finished(const WorkCell& work) const {
    Cell cell;
    for (const std::uint32_t leaf : work.leaves) {
      ConvexRegion region;
      for (const std::uint32_t id : shapes_.faces_of_leaf[leaf]) {
        const LeafFace& face = shapes_.faces[id];
        Plane plane = face.plane;
        if (face.front != leaf) plane = {-plane.normal, -plane.d};
        const bool known = std::ranges::any_of(region.planes, [&](const Plane& other) {
          return other.normal == plane.normal && other.d == plane.d;
        });
        if (!known) region.planes.push_back(plane);
        for (const glm::dvec3& corner : face.polygon) region.bounds.extend(glm::vec3(corner));
      }
      cell.bounds.extend(region.bounds);
      cell.regions.push_back(std::move(region));
    }
    return cell;
  }

  void add_portals(const std::vector<CellId>& name, std::vector<Portal>& portals) const {
    // By the cells they join and the side of the plane that each is on.
    std::map<std::pair<CellId, CellId>, std::vector<std::uint32_t>> openings;
    for (std::uint32_t id = 0; id < shapes_.faces.size(); ++id) {
      const LeafFace& face = shapes_.faces[id];
      if (face.front == none_id || face.back == none_id) continue;
      const CellId a = cell_of_leaf_[face.front];
      const CellId b = cell_of_leaf_[face.back];
      if (a == none_id || b == none_id || a == b) continue;
      openings[{name[a], name[b]}].push_back(id);
    }
    for (const auto& [cells, faces] : openings) {
      for (const auto& [plane, polygon] : joined(faces)) {
        portals.push_back({polygon, cells.first, cells.second, plane});
        portals.push_back({{polygon.rbegin(), polygon.rend()},
                           cells.second,
                           cells.first,
                           {-plane.normal, -plane.d}});
      }
    }
  }

  /// Polygons of these faces, which all turn the same way; joined where the union is convex.
  std::vector<Piece> joined(const std::vector<std::uint32_t>& faces) const {
    std::vector<Piece> pieces;
    for (const std::uint32_t id : faces) {
      pieces.push_back({shapes_.faces[id].plane, shapes_.faces[id].polygon});
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      for (std::size_t k = i + 1; k < pieces.size();) {
        std::optional<ConvexPolygon> both =
            united(pieces[i].polygon, pieces[k].polygon, pieces[i].plane);
        if (!both) {
          ++k;
          continue;
        }
        pieces[i].polygon = std::move(*both);
        pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(k));
        k = i + 1;
      }
    }
    return pieces;
  }

  /// The union of two polygons if it is convex and lies in the plane.
  static std::optional<ConvexPolygon> united(const ConvexPolygon& a, const ConvexPolygon& b,
                                             const Plane& plane) {
    for (const glm::dvec3& corner : b) {
      if (std::abs(plane.signed_distance(corner)) > leaf_tolerance_m) return std::nullopt;
    }
    ConvexPolygon corners = a;
    corners.insert(corners.end(), b.begin(), b.end());
    ConvexPolygon hull = hull_in_plane(corners, plane.normal);
    const double sum = area(a) + area(b);
    if (area(hull) > sum * (1.0 + 1e-9) + 1e-9) return std::nullopt;
    return hull;
  }

  /// Counter-clockwise seen from where `normal` points to (Andrew's monotone chain).
  static ConvexPolygon hull_in_plane(ConvexPolygon points, const glm::dvec3& normal) {
    const glm::dvec3 other = std::abs(normal.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(other, normal));
    const glm::dvec3 v = glm::cross(normal, u);
    const auto key = [&](const glm::dvec3& p) { return std::pair(glm::dot(p, u), glm::dot(p, v)); };
    std::ranges::sort(points, {}, key);
    ConvexPolygon hull;
    const auto turns_left = [&](const glm::dvec3& p) {
      const glm::dvec3 edge = hull.back() - hull[hull.size() - 2];
      return glm::dot(glm::cross(edge, p - hull.back()), normal) > 1e-9;
    };
    for (int pass = 0; pass < 2; ++pass) {
      const std::size_t start = hull.size();
      for (const glm::dvec3& p : points) {
        while (hull.size() >= start + 2 && !turns_left(p)) hull.pop_back();
        hull.push_back(p);
      }
      hull.pop_back();
      std::ranges::reverse(points);
    }
    return hull;
  }

  LeafShapes shapes_;
  QuakeCellLimits limits_;
  std::vector<WorkCell> cells_;
  std::vector<CellId> cell_of_leaf_;
};

/// Throws unless what the tree cuts out of the world is the box that the file says; leaves that end
/// where the world does end elsewhere for the file.
void require_boxes(const QuakeWorld& world, const LeafShapes& shapes,
                   const std::vector<std::uint8_t>& open_to_outside) {
  for (std::uint32_t leaf = 0; leaf < world.leaves.size(); ++leaf) {
    if (world.leaves[leaf].cluster < 0 || open_to_outside[leaf] != 0) continue;
    if (shapes.faces_of_leaf[leaf].empty()) continue;
    Aabb box;
    for (const std::uint32_t face : shapes.faces_of_leaf[leaf]) {
      for (const glm::dvec3& corner : shapes.faces[face].polygon) box.extend(glm::vec3(corner));
    }
    const Aabb& said = world.leaves[leaf].bounds;
    const glm::dvec3 difference = glm::max(glm::abs(glm::dvec3(box.min) - glm::dvec3(said.min)),
                                           glm::abs(glm::dvec3(box.max) - glm::dvec3(said.max)));
    const double largest = std::max({difference.x, difference.y, difference.z});
    if (largest <= box_tolerance_m) continue;
    throw InputError("is damaged: its BSP tree puts leaf " + std::to_string(leaf) + " " +
                     std::to_string(largest / quake_unit_m) +
                     " units away from the box that the file gives for it");
  }
}

QuakeReport report_of(const QuakeWorld& world, const LeafShapes& shapes,
                      const std::vector<std::uint8_t>& open_to_outside) {
  QuakeReport report;
  report.leaves_open_to_outside =
      static_cast<std::size_t>(std::ranges::count(open_to_outside, std::uint8_t{1}));
  std::vector<std::uint8_t> counted(world.visible.empty() ? 0 : world.cluster_count, 0);
  for (const LeafFace& face : shapes.faces) {
    if (face.front == none_id || face.back == none_id || world.visible.empty()) continue;
    const std::int32_t front = world.leaves[face.front].cluster;
    const std::int32_t back = world.leaves[face.back].cluster;
    for (const std::int32_t cluster : {front, back}) {
      if (cluster < 0 || counted[static_cast<std::size_t>(cluster)]++ != 0) continue;
      if (!world.sees(cluster, cluster)) ++report.blind_clusters;
    }
    // Compilers leave tiny portals out.
    if (front < 0 || back < 0 || area(face.polygon) < smallest_opening_m2) continue;
    if (!world.sees(front, back) || !world.sees(back, front)) ++report.unseen_neighbours;
  }
  return report;
}

}  // namespace

QuakeCells find_quake_cells(const QuakeWorld& world, const Aabb& bounds,
                            const QuakeCellLimits& limits) {
  LeafShapes shapes = shapes_of_leaves(world, bounds);
  std::vector<std::uint8_t> open_to_outside(world.leaves.size(), 0);
  for (const LeafFace& face : shapes.faces) {
    if (face.front != none_id && face.back != none_id) continue;
    const std::uint32_t leaf = face.front == none_id ? face.back : face.front;
    open_to_outside[leaf] = world.leaves[leaf].cluster >= 0 ? 1 : 0;
  }
  require_boxes(world, shapes, open_to_outside);
  const QuakeReport report = report_of(world, shapes, open_to_outside);
  QuakeCells found = CellMaker(world, std::move(shapes), limits).run();
  found.report = report;
  return found;
}

void add_quake_cells(Scene& scene, QuakeWorld& world, const QuakeCellLimits& limits) {
  if (limits.cells == QuakeCellLimits::Cells::none) return;
  Aabb bounds;
  for (const Object& object : scene.objects) {
    bounds.extend(transformed(bounds_of(scene.meshes[object.mesh].positions), object.transform));
  }
  QuakeCells found = find_quake_cells(world, bounds, limits);
  for (ObjectId object = 0; object < scene.objects.size(); ++object) {
    for (const std::uint32_t leaf : world.leaves_of_object(object)) {
      const CellId cell = found.cell_of_leaf[leaf];
      if (cell == none_id) continue;
      std::vector<ObjectId>& objects = found.cells[cell].objects;
      if (objects.empty() || objects.back() != object) objects.push_back(object);
    }
  }
  world.report = found.report;
  world.report.see_through_leaves =
      count_see_through_leaves(scene, world, shapes_of_leaves(world, bounds));
  world.cell_of_leaf = std::move(found.cell_of_leaf);
  scene.cells = std::move(found.cells);
  scene.portals = std::move(found.portals);
}

}  // namespace vislab
