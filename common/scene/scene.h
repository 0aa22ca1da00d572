// What visibility needs of a scene and nothing else: triangle meshes, objects that place them, and,
// where the source has them, cells, portals and the tree of a Quake III world.
//
// Frames of reference: mesh vertices are float in the mesh's frame; an object's transform takes
// them to the world in double. Consumers that need float world positions (ray tracer, graphics
// device) subtract Scene::origin() first.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/bounds.h"

namespace vislab {

/// Larger world coordinates and smaller scenes are refused: where squares and products of lengths
/// leave float, the ray tracer and the graphics device see nothing.
inline constexpr double max_scene_coordinate_m = 1e11;
inline constexpr double min_scene_extent_m = 1e-11;

using MeshId = std::uint32_t;
using ObjectId = std::uint32_t;
using CellId = std::uint32_t;
/// A triangle of the whole scene: Scene::first_triangle(object) + index in the object's mesh.
using TriangleId = std::uint32_t;
/// "No object", "no triangle", "no cell": never a valid id.
inline constexpr std::uint32_t none_id = 0xFFFFFFFFU;

struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;  // counter-clockwise seen from outside
  Aabb bounds;                        // of the vertices that triangles use
  /// Every connected part is closed, consistently oriented and outward (see is_closed_outward).
  bool closed = false;
  /// Closed, and the surface does not intersect or touch itself (see solid_mesh.h): from outside
  /// nothing but front faces can be seen.
  bool solid = false;
};

/// An instance of a mesh.
struct Object {
  MeshId mesh = 0;
  glm::dmat4x3 transform{1.0};  // mesh frame to world; affine, not singular; may mirror
  CellId cell = none_id;
};

/// A convex opening between two cells. Counter-clockwise seen from cell `from`, world frame.
struct Portal {
  std::vector<glm::dvec3> polygon;
  CellId from = none_id;
  CellId to = none_id;
  Plane plane{};  // of the polygon; inside is the side of `from`
};

/// A portal whose plane is found from its corners (Newell).
Portal make_portal(std::vector<glm::dvec3> polygon, CellId from, CellId to);

/// Inside all planes.
struct ConvexRegion {
  Aabb bounds;
  std::vector<Plane> planes;
};

/// A room: a union of convex regions, world frame. What lies in it is seen from elsewhere through
/// portals only.
struct Cell {
  Aabb bounds;
  std::vector<ConvexRegion> regions;
  std::vector<ObjectId> objects;  // that reach into it where the scene puts them; ascending
};

struct QuakeWorld;  // common/scene/quake_world.h

/// Things that were repaired or tolerated while the scene was loaded, counted.
struct SceneReport {
  std::size_t zero_area_triangles = 0;
  std::size_t unused_bad_vertices = 0;
  std::size_t open_meshes = 0;
  std::size_t self_intersecting_meshes = 0;  // closed, but not solid
};

/// Immutable after finish(). Movement and visibility toggles live in SceneState.
class Scene {
 public:
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<Object> objects;
  std::vector<Cell> cells;
  std::vector<Portal> portals;
  std::shared_ptr<const QuakeWorld> quake;  // null unless the scene is a Quake III world
  SceneReport report;

  /// Validates everything and computes what the functions below return. To be called once, after
  /// the public members are filled. Throws InputError for used vertices that are NaN or infinite,
  /// indices out of range, coordinates and extents beyond the limits above (a scene whose meshes
  /// are all single points may have no extent), meshes without a triangle, singular transforms, no
  /// object at all, or 2^32 - 1 triangles and more. Unused vertices that are NaN or infinite are
  /// removed. Fills Mesh::bounds, Mesh::closed, Mesh::solid and the report. O(n log n) in the
  /// meshes, O(n) in the objects.
  void finish();

  std::size_t object_count() const { return objects.size(); }
  /// Triangles of all objects, instances counted each.
  std::size_t triangle_count() const { return first_triangle_.back(); }
  const Mesh& mesh_of(ObjectId object) const { return meshes[objects[object].mesh]; }
  TriangleId first_triangle(ObjectId object) const { return first_triangle_[object]; }
  std::uint32_t triangle_count(ObjectId object) const {
    return first_triangle_[object + 1] - first_triangle_[object];
  }
  /// The object a triangle belongs to. O(log objects).
  ObjectId object_of(TriangleId triangle) const;

  /// World box of everything, as built.
  const Aabb& bounds() const { return bounds_; }
  /// World point that is subtracted before world positions are rounded to float.
  const glm::dvec3& origin() const { return origin_; }
  /// Hash of meshes, objects, cells, portals and the Quake world; 32 hexadecimal digits. Equal
  /// content gives an equal hash on every machine; names do not count.
  const std::string& content_hash() const { return content_hash_; }

 private:
  std::vector<TriangleId> first_triangle_{0};  // object_count + 1
  Aabb bounds_;
  glm::dvec3 origin_{0.0};
  std::string content_hash_;
};

/// Vertices of a triangle in the world, double, in the mesh's order: clockwise seen from outside
/// where the transform mirrors.
std::array<glm::dvec3, 3> world_triangle(const Mesh& mesh, const glm::dmat4x3& transform,
                                         std::uint32_t triangle);

/// True if every connected part of the mesh is closed (each edge borne by two triangles that run
/// along it in opposite directions, vertices at equal positions taken as one) and encloses a
/// positive volume. Necessary for a solid, and enough if no part intersects itself. O(n log n).
bool is_closed_outward(const Mesh& mesh);

}  // namespace vislab
