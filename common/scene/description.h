// Scene descriptions: small TOML files that say where a scene comes from (data/scenes).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>

#include "common/scene/generators/generators.h"

namespace vislab {

/// A file of a package below data/cache, or, without a package, beside the description.
struct FileSource {
  std::string package;  // empty: none
  std::string file;
};

struct MeshSource {
  FileSource source;
  std::uint32_t simplify_triangles = 0;  // 0: as it is
};

struct QuakeSource {
  FileSource source;
};

/// Instances of a mesh along the axes.
struct HaresSource {
  MeshSource mesh;
  HaresParameters parameters;
};

struct SceneDescription {
  std::string name;  // the file's stem
  std::filesystem::path folder;
  std::string description;
  std::string default_path;  // empty: fitted to the scene
  std::variant<MeshSource, QuakeSource, HaresSource, AsteroidBeltParameters, BoxFieldParameters,
               CityParameters, RoomRingParameters>
      source;
};

/// Reads and checks a description. Throws InputError; unknown keys are errors that name the known.
SceneDescription read_scene_description(const std::filesystem::path& file);

}  // namespace vislab
