// What a Quake III world (IBSP, version 0x2e) knows besides its triangles: the BSP tree, the
// potentially visible set of each cluster, and where its players may stand.
//
// Everything is in the lab's frame: Quake's (x, y, z), z up, becomes (x, z, -y) / 32 in metres. The
// scale is a power of two, so that no coordinate is rounded; a player's eye is then 1.56 m high.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/scene/content_hash.h"
#include "common/scene/scene.h"

namespace vislab {

inline constexpr double quake_unit_m = 1.0 / 32.0;

struct QuakeNode {
  std::uint32_t plane = 0;           // of QuakeWorld::planes
  std::int32_t front = 0, back = 0;  // a node if >= 0, else leaf -(value + 1)
};

struct QuakeLeaf {
  std::int32_t cluster = -1;  // -1: solid, or outside of the world
  std::int32_t area = -1;     // areas are separated by doors
  Aabb bounds;
  ObjectId object = none_id;  // the faces that this leaf was given
};

/// A brush model: a door, a platform, a trigger. Not part of the world's potentially visible set.
struct QuakeBrushModel {
  Aabb bounds;                // as placed
  ObjectId object = none_id;  // none if the model has no face that is drawn
  std::string class_name;     // of the entity that it belongs to: func_door, …; empty if none
};

/// Where a player starts or picks something up: reachable, so the potentially visible sets hold
/// here.
struct QuakePlace {
  std::string class_name;
  glm::dvec3 eye{0.0};       // raised to eye height where there is room
  double heading_rad = 0.0;  // about the y axis; 0 looks along +x, as in Quake
  std::uint32_t leaf = 0;
};

/// What is odd about a world, counted while its cells were found.
struct QuakeReport {
  // Not solid, and reaching to where the world ends: a crack in its hull, unless nothing can be
  // seen from there.
  std::size_t leaves_open_to_outside = 0;
  std::size_t blind_clusters = 0;     // that do not see themselves
  std::size_t unseen_neighbours = 0;  // openings between clusters that do not see each other
  // Solid, but bare on several sides (see quake_gaps.h). Fewer than the places where one sees
  // through what is solid: sight that goes in at one solid leaf and out at another is found by rays
  // only (judge/cell_leaks.h).
  std::size_t see_through_leaves = 0;
};

struct QuakeWorld {
  std::vector<Plane> planes;  // inside = in front
  std::vector<QuakeNode> nodes;
  std::vector<QuakeLeaf> leaves;
  std::vector<QuakeBrushModel> brush_models;
  std::vector<std::map<std::string, std::string>> entities;  // keys and values as in the file
  std::vector<QuakePlace> places;
  std::vector<std::uint32_t> leaf_of_object;  // by object; none_id for brush models
  std::vector<std::uint32_t> first_leaf;      // by object, and their end: indices of leaf_lists
  std::vector<std::uint32_t> leaf_lists;      // see leaves_of_object
  std::vector<CellId> cell_of_leaf;           // none_id: solid or outside; empty without cells
  std::uint32_t cluster_count = 0;
  std::uint32_t bytes_per_cluster = 0;
  std::vector<std::uint8_t> visible;  // bit sets, one row a cluster; empty: all see all
  QuakeReport report;                 // of a world with cells

  /// The leaf a point lies in; points on a plane are in front of it. O(depth).
  std::uint32_t leaf_at(const glm::dvec3& point) const;
  /// The leaves that are not solid and that an object reaches into, ascending: those to which the
  /// file gives any of its faces, and those that its triangles reach into. Empty for brush models,
  /// which move.
  std::span<const std::uint32_t> leaves_of_object(ObjectId object) const {
    return std::span(leaf_lists)
        .subspan(first_leaf[object], first_leaf[object + 1] - first_leaf[object]);
  }
  /// What the file's own potentially visible set says; not exactly symmetric: `from` is the
  /// viewer's cluster. False if either is -1.
  bool sees(std::int32_t from, std::int32_t to) const;
  /// Why the file's potentially visible sets must not be followed, to go on from "the world …";
  /// empty if nothing is known against them.
  std::string doubt_about_sets() const;
};

/// What becomes a cell (see quake_cells.h).
struct QuakeCellLimits {
  enum class Cells { leaves, rooms, none };
  Cells cells = Cells::leaves;
  double smallest_m3 = 0.0;  // rooms: smaller ones are joined with a neighbour
};

/// Reads a world file. One object for the faces of each leaf that has any: polygons, meshes and
/// patches, the patches cut into a grid of fixed fineness so that neighbours meet. A face in
/// several leaves goes to the first, faces in none to one more object; each brush model with faces
/// is an object too. Left out are billboards, faces marked as not drawn, and patch triangles
/// without area. Sky is kept: it bounds the world. `scene.quake` is set, and cells and portals are
/// found. Not yet finished; `name` is the file's stem. Throws InputError for anything that is
/// missing, out of range or of another version.
Scene import_quake_world(const std::filesystem::path& file, const QuakeCellLimits& limits = {});

void add_to_hash(ContentHash& hash, const QuakeWorld& world);

}  // namespace vislab
