// A scene and a path through it, drawn with OSMesa by one method after the other.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "common/judge/image_judge.h"
#include "common/judge/path_truth.h"
#include "common/render/osmesa_device.h"
#include "experiments/run/path_run.h"

namespace vislab {

class Tour {
 public:
  static constexpr Viewport size{512, 512};

  /// Names of data/scenes and data/paths. Traces the truth of all frames, which takes seconds.
  Tour(const std::string& scene, const std::string& path);
  Tour(const Tour&) = delete;
  Tour& operator=(const Tour&) = delete;

  const Path& path() const { return path_; }
  /// Walks the path once. Cullers are built when they are first asked for.
  PathRun walk(const std::string& spec);
  /// Are the images of all frames those of the scene drawn whole, but for disputed pixels?
  bool right(const PathRun& run);

 private:
  Scene scene_;
  Path path_;
  Registry registry_;
  std::unique_ptr<PathTruth> truth_;
  OsMesaDevice plain_device_;
  TimedDevice device_{plain_device_};
  SceneState state_;
  ImageJudge judge_;
  std::map<std::string, std::unique_ptr<ICuller>> cullers_;
};

}  // namespace vislab
