#include "common/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/geometry/convex_polygon.h"
#include "common/scene/cell_objects.h"
#include "common/scene/content_hash.h"
#include "common/scene/error.h"
#include "common/scene/quake_world.h"
#include "common/scene/solid_mesh.h"
#include "common/scene/transform.h"

namespace vislab {
namespace {

bool finite(const glm::vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

std::string title(const Mesh& mesh, std::size_t index) {
  return "mesh " + std::to_string(index) + (mesh.name.empty() ? "" : " (" + mesh.name + ")");
}

/// Throws unless all indices are in range; gives a mark per vertex: used by a triangle.
std::vector<std::uint8_t> used_vertices(const Mesh& mesh, const std::string& where) {
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = mesh.triangles[t][corner];
      if (vertex >= used.size()) {
        throw InputError(where + ", triangle " + std::to_string(t) + ": vertex index " +
                         std::to_string(vertex) + " is out of range; the mesh has " +
                         std::to_string(used.size()) + " vertices");
      }
      used[vertex] = 1;
    }
  }
  return used;
}

/// Takes unused vertices that are NaN or infinite away; throws for used ones. Gives their number.
std::size_t remove_bad_vertices(Mesh& mesh, const std::vector<std::uint8_t>& used,
                                const std::string& where) {
  std::vector<std::uint32_t> renumbered(mesh.positions.size());
  std::size_t kept = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    renumbered[v] = static_cast<std::uint32_t>(kept);
    if (finite(mesh.positions[v])) {
      mesh.positions[kept++] = mesh.positions[v];
    } else if (used[v] != 0) {
      throw InputError(where + ": vertex " + std::to_string(v) +
                       " is NaN or infinite and a triangle uses it; coordinates must be finite");
    }
  }
  const std::size_t removed = mesh.positions.size() - kept;
  if (removed > 0) {
    mesh.positions.resize(kept);
    for (glm::uvec3& triangle : mesh.triangles) {
      for (int corner = 0; corner < 3; ++corner) triangle[corner] = renumbered[triangle[corner]];
    }
  }
  return removed;
}

bool zero_area(const Mesh& mesh, const glm::uvec3& triangle) {
  const glm::dvec3 a(mesh.positions[triangle.x]);
  const glm::dvec3 b(mesh.positions[triangle.y]);
  const glm::dvec3 c(mesh.positions[triangle.z]);
  return glm::cross(b - a, c - a) == glm::dvec3(0.0);
}

void finish_mesh(Mesh& mesh, std::size_t index, SceneReport& report) {
  const std::string where = title(mesh, index);
  if (mesh.triangles.empty()) {
    throw InputError(where + " has no triangle; a mesh needs at least one");
  }
  const std::vector<std::uint8_t> used = used_vertices(mesh, where);
  report.unused_bad_vertices += remove_bad_vertices(mesh, used, where);
  mesh.bounds = Aabb();
  for (const glm::uvec3& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      mesh.bounds.extend(mesh.positions[triangle[corner]]);
    }
    if (zero_area(mesh, triangle)) ++report.zero_area_triangles;
  }
  if (!mesh.bounds.valid()) {
    throw InputError(where + " is too large for float coordinates");
  }
  mesh.closed = is_closed_outward(mesh);
  mesh.solid = mesh.closed && is_solid(mesh);
  if (!mesh.closed) ++report.open_meshes;
  if (mesh.closed && !mesh.solid) ++report.self_intersecting_meshes;
}

std::string hash_of(const Scene& scene) {
  ContentHash hash;
  hash.add(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) {
    hash.add_list(std::span<const glm::vec3>(mesh.positions));
    hash.add_list(std::span<const glm::uvec3>(mesh.triangles));
  }
  hash.add(scene.objects.size());
  for (const Object& object : scene.objects) {
    hash.add(object.mesh);
    hash.add(object.transform);
    hash.add(object.cell);
  }
  hash.add(scene.cells.size());
  for (const Cell& cell : scene.cells) {
    hash.add(glm::dvec3(cell.bounds.min));
    hash.add(glm::dvec3(cell.bounds.max));
    hash.add(cell.regions.size());
    for (const ConvexRegion& region : cell.regions) {
      hash.add(region.planes.size());
      for (const Plane& plane : region.planes) {
        hash.add(plane.normal);
        hash.add(plane.d);
      }
    }
    hash.add_list(std::span<const ObjectId>(cell.objects));
  }
  hash.add(scene.portals.size());
  for (const Portal& portal : scene.portals) {
    hash.add_list(std::span<const glm::dvec3>(portal.polygon));
    hash.add(portal.from);
    hash.add(portal.to);
  }
  hash.add(scene.quake != nullptr);
  if (scene.quake) add_to_hash(hash, *scene.quake);
  return hash.hex();
}

/// Zero where the scene lies around the world's origin, so that vertices whose world positions are
/// floats already stay as they are; otherwise the centre of the scene.
glm::dvec3 origin_of(const Aabb& bounds) {
  const glm::dvec3 center = bounds.center();
  const bool far_away = glm::length(center) > 16.0 * glm::length(bounds.half_size());
  return far_away ? center : glm::dvec3(0.0);
}

std::string metres(double value) {
  std::ostringstream text;
  text << value << " m";
  return text.str();
}

/// Throws unless the scene lies within the limits of scene.h. Meshes that are single points have no
/// extent to be lost.
void require_scale(const Scene& scene) {
  const Aabb& box = scene.bounds();
  const glm::dvec3 reach = glm::max(glm::abs(glm::dvec3(box.min)), glm::abs(glm::dvec3(box.max)));
  const double farthest = std::max({reach.x, reach.y, reach.z});
  if (farthest > max_scene_coordinate_m) {
    throw InputError("the scene reaches to " + metres(farthest) +
                     " from the origin along an axis; at most " + metres(max_scene_coordinate_m) +
                     " is allowed");
  }
  const glm::dvec3 size = box.half_size() * 2.0;
  const double extent = std::max({size.x, size.y, size.z});
  const bool only_points = std::ranges::all_of(
      scene.meshes, [](const Mesh& mesh) { return mesh.bounds.min == mesh.bounds.max; });
  if (extent < min_scene_extent_m && !only_points) {
    throw InputError("the scene is only " + metres(extent) + " large; at least " +
                     metres(min_scene_extent_m) + " is needed");
  }
}

void require_cell(CellId cell, std::size_t count, const std::string& where) {
  if (cell >= count) {
    throw InputError(where + ": cell " + std::to_string(cell) + " is out of range; there are " +
                     std::to_string(count));
  }
}

}  // namespace

Portal make_portal(std::vector<glm::dvec3> polygon, CellId from, CellId to) {
  Portal portal{std::move(polygon), from, to};
  const glm::dvec3 normal = glm::normalize(area_vector(portal.polygon));
  portal.plane = {normal, -glm::dot(normal, portal.polygon.front())};
  return portal;
}

double determinant(const glm::dmat4x3& transform) {
  return glm::dot(transform[0], glm::cross(transform[1], transform[2]));
}

void require_placing_transform(const glm::dmat4x3& transform, const std::string& where) {
  double lengths = 1.0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) {
      if (!std::isfinite(transform[column][row])) {
        throw InputError(where + ": the transform is not finite");
      }
    }
    if (column < 3) lengths *= glm::length(transform[column]);
  }
  const double volume = determinant(transform);
  if (!(std::abs(volume) > 1e-12 * lengths)) {
    throw InputError(where + ": the transform is singular: its determinant is " +
                     std::to_string(volume));
  }
}

void Scene::finish() {
  if (objects.empty()) throw InputError("the scene has no object; it needs at least one triangle");
  report = SceneReport();
  for (std::size_t i = 0; i < meshes.size(); ++i) finish_mesh(meshes[i], i, report);

  first_triangle_.assign(1, 0);
  first_triangle_.reserve(objects.size() + 1);
  bounds_ = Aabb();
  std::uint64_t triangles = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Object& object = objects[i];
    const std::string where = "object " + std::to_string(i);
    if (object.mesh >= meshes.size()) {
      throw InputError(where + ": mesh " + std::to_string(object.mesh) +
                       " is out of range; there are " + std::to_string(meshes.size()));
    }
    require_placing_transform(object.transform, where);
    if (object.cell != none_id) require_cell(object.cell, cells.size(), where);
    const Aabb box = transformed(meshes[object.mesh].bounds, object.transform);
    if (!box.valid()) throw InputError(where + " is too large for float coordinates");
    bounds_.extend(box);
    triangles += meshes[object.mesh].triangles.size();
    if (triangles >= none_id) {
      throw InputError("the scene has 2^32 - 1 triangles or more, instances counted each");
    }
    first_triangle_.push_back(static_cast<TriangleId>(triangles));
  }
  for (std::size_t i = 0; i < portals.size(); ++i) {
    const std::string where = "portal " + std::to_string(i);
    require_cell(portals[i].from, cells.size(), where);
    require_cell(portals[i].to, cells.size(), where);
    if (portals[i].polygon.size() < 3) throw InputError(where + " has fewer than three corners");
  }
  require_scale(*this);
  const bool listed =
      std::ranges::any_of(cells, [](const Cell& cell) { return !cell.objects.empty(); });
  if (!cells.empty() && !listed) list_objects_of_cells(*this);
  origin_ = origin_of(bounds_);
  content_hash_ = hash_of(*this);
}

ObjectId Scene::object_of(TriangleId triangle) const {
  const auto after = std::upper_bound(first_triangle_.begin(), first_triangle_.end(), triangle);
  return static_cast<ObjectId>(after - first_triangle_.begin() - 1);
}

std::array<glm::dvec3, 3> world_triangle(const Mesh& mesh, const glm::dmat4x3& transform,
                                         std::uint32_t triangle) {
  std::array<glm::dvec3, 3> corners;
  for (int corner = 0; corner < 3; ++corner) {
    const glm::dvec3 p(mesh.positions[mesh.triangles[triangle][corner]]);
    corners[static_cast<std::size_t>(corner)] = transform * glm::dvec4(p, 1.0);
  }
  return corners;
}

}  // namespace vislab
