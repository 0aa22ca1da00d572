#include "experiments/matrix/own_paths.h"

#include <utility>

#include "common/scene/error.h"

namespace vislab {

OwnPaths::OwnPaths(std::map<std::string, std::string> by_scene) : by_scene_(std::move(by_scene)) {}

OwnPaths::OwnPaths(const DataFolders& folders) {
  try {
    for (const SceneSummary& scene : list_scenes(folders)) {
      by_scene_[scene.name] = scene.default_path;
    }
  } catch (const InputError&) {
    by_scene_.clear();
  }
}

std::string OwnPaths::resolved(const std::string& scene, const std::string& path) const {
  if (!path.empty()) return path;
  const auto own = by_scene_.find(scene);
  return own == by_scene_.end() ? "" : own->second;
}

bool OwnPaths::is_on(const ResultCell& cell, const Block& block) const {
  return cell.scene_source == block.scene &&
         resolved(cell.scene_source, cell.path_source) == resolved(block.scene, block.path);
}

}  // namespace vislab
