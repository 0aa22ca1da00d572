// Scenes and camera paths by name or file. A name is looked up in data/scenes and data/paths
// (NAME.toml); a file may be a scene description (.toml), any mesh that assimp reads (also gzipped,
// .gz), or a Quake III world (.bsp).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/scene/path.h"
#include "common/scene/scene.h"

namespace vislab {

/// Where descriptions and fetched packages are.
struct DataFolders {
  std::filesystem::path data;   // the repository's data/
  std::filesystem::path cache;  // fetched packages, data/cache
};

struct SceneSummary {
  std::string name;
  std::string description;
  std::string default_path;  // name of a path in data/paths, or a path kind
};

/// All scenes of data/scenes, sorted by name. Reads descriptions only.
std::vector<SceneSummary> list_scenes(const DataFolders& folders);

/// A scene with its default path's name ("" when the file says none: a path is then fitted).
struct LoadedScene {
  Scene scene;
  std::string default_path;
  std::string description;  // one sentence; "" for bare meshes and worlds
};

/// Throws InputError that says what is wrong, where, and what would be right; a package that is not
/// there is named.
LoadedScene load_scene(const std::string& name_or_file, const DataFolders& folders);

/// `name_or_file` is a path in data/paths, a .toml or .json file, or "" for a default path that is
/// fitted to the scene (an orbit around a model; a walk between spawn points in a Quake world).
/// `frames` > 0 resamples the path to that many frames, and what moves with it: the same movements
/// in as much time, only seen less often. Throws InputError.
///
/// Keys of every description: `kind` and those of the way (tracks.h), `description`, `frames` (60),
/// `part` (the way's beginning only, as a share of its time, in as many frames: the smaller, the
/// slower the camera; not of recorded ways), `relative` (points count from the middle of the
/// scene's box in radii of its circumscribed sphere), those of the lens (lens_fit.h),
/// `off_axis_deg` (the camera looks so far to the right of where the way looks), `roll_deg` (about
/// the view, the camera's up goes to its left), `eye_offset_m` (to the camera's right, as the eyes
/// of a headset), and the table `motion` (motion_settings.h).
Path load_path(const std::string& name_or_file, const Scene& scene, const Viewport& viewport,
               int frames, const DataFolders& folders);

}  // namespace vislab
