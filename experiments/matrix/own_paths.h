// The camera paths that scenes name as their own.
#pragma once

#include <map>
#include <string>

#include "common/scene/library.h"

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

 private:
  std::map<std::string, std::string> by_scene_;
};

}  // namespace vislab
