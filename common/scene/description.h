// Scene descriptions: small TOML files that say where a scene comes from (data/scenes).
//
// A scene is one of the tables `mesh` and `quake3`, a list of tables `meshes` (files that belong
// together, each in the world's frame; what lies exactly where
// the same lies already is left out) or `objects`, or
// a table `generator` with its `kind`. Keys are named as the members below and in generators.h; a
// mesh's file has the keys `package` and `file`. Besides, fields know `edge_m` instead of half
// sizes; objects and the meshes of generators `shape` = "ribbed_sphere" | "bumpy_sphere" instead of
// a file; the generators that are made for occlusion have their own keys (generators/occlusion.h);
// `quake3` knows `cells` = "leaves" | "rooms" | "none", and with rooms `smallest_m3`;
// objects and `mesh` know `up` = "y" | "z", objects `heading_deg`, and every scene without
// cells `offset`. Beside `mesh`, `meshes` and `objects` there may be `cells` and `portals`
// (cell_settings.h); buildings have theirs from the generator (generators/rooms_settings.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "common/scene/cell_settings.h"
#include "common/scene/generators/generators.h"
#include "common/scene/generators/occlusion_settings.h"
#include "common/scene/quake_world.h"

namespace vislab {

/// A file of a package below data/cache, or, without a package, beside the description.
struct FileSource {
  std::string package;  // empty: none
  std::string file;

  friend bool operator==(const FileSource&, const FileSource&) = default;
};

struct MeshSource {
  FileSource source;
  std::uint32_t simplify_triangles = 0;  // 0: as it is

  friend bool operator==(const MeshSource&, const MeshSource&) = default;
};

/// The table `mesh`, or one of the tables `meshes`: a whole file.
struct ModelSource {
  MeshSource mesh;
  bool z_up = false;  // the file's z axis is up, not y
  // Of `meshes` only: objects whose box is longer on any side are left out (skies).
  double largest_m = std::numeric_limits<double>::infinity();
};

struct QuakeSource {
  FileSource source;
  QuakeCellLimits cells;
};

struct RibbedSphereSource {
  std::uint32_t meridians = 100, parallels = 50, ribs = 10;

  friend bool operator==(const RibbedSphereSource&, const RibbedSphereSource&) = default;
};

/// A single mesh: of a file, or made.
using ShapeSource = std::variant<MeshSource, RibbedSphereSource, BumpySphereParameters>;

/// Instances of a mesh along the axes.
struct HaresSource {
  ShapeSource mesh;
  HaresParameters parameters;
};

/// Instances of a mesh, at random in a cube.
struct MeshFieldSource {
  ShapeSource mesh;
  BoxFieldParameters parameters;
};

/// One mesh, and where it stands.
struct PlacedMesh {
  ShapeSource mesh;
  bool z_up = false;    // the mesh's z axis is up, not y
  glm::dvec3 at{0.0};   // middle of the lower side of its box
  double size_m = 1.0;  // longest side of the mesh's box before that is stretched
  // The upright mesh is sheared, x going along with y and z and y with z by the factors
  // [xy, xz, yz], and then stretched along its axes; negative factors mirror.
  glm::dvec3 shear{0.0};
  glm::dvec3 scale{1.0};
  double heading_rad = 0.0;  // counter-clockwise about the vertical, seen from above
};

struct SceneDescription {
  std::string name;  // the file's stem
  std::filesystem::path folder;
  std::string description;
  std::string default_path;  // empty: fitted to the scene
  DescribedCells cells;      // of `mesh`, `meshes` and `objects`
  glm::dvec3 offset{0.0};    // added to all objects' places, metres
  std::variant<ModelSource, std::vector<ModelSource>, QuakeSource, std::vector<PlacedMesh>,
               HaresSource, MeshFieldSource, AsteroidBeltParameters, BoxFieldParameters,
               BumpySphereParameters, CityParameters, GrazingSlabsParameters, HousesParameters,
               RoomRingParameters, SceneMaker>
      source;
};

/// Reads and checks a description. Throws InputError; unknown keys are errors that name the known.
SceneDescription read_scene_description(const std::filesystem::path& file);

}  // namespace vislab
