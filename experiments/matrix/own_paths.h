// The camera paths that scenes name as their own.
#pragma once

#include <map>
#include <string>

#include "common/scene/library.h"
#include "experiments/matrix/matrix.h"
#include "experiments/results/cell.h"

namespace vislab {

/// A run on a scene that names no path, and one that names the scene's own, are the same.
class OwnPaths {
 public:
  explicit OwnPaths(std::map<std::string, std::string> by_scene);
  /// Of all scenes that are described in data/scenes; of none if a description is wrong, which
  /// whoever loads that scene is told.
  explicit OwnPaths(const DataFolders& folders);

  /// `path`, or if it is empty the scene's own; "" if that is fitted to the scene.
  std::string resolved(const std::string& scene, const std::string& path) const;

  /// Was the cell measured on the block's scene and path, by their names?
  bool is_on(const ResultCell& cell, const Block& block) const;

 private:
  std::map<std::string, std::string> by_scene_;
};

}  // namespace vislab
