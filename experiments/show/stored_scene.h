// The scene and the path that a cell was measured on, loaded again.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "common/scene/library.h"
#include "experiments/analysis/summary.h"

namespace vislab {

struct StoredScene {
  const Scene& scene;  // of StoredScenes
  Path path;
};

/// Loads what the cells of blocks were measured on. Scenes are kept, because many pictures are of
/// the same ones, and their objects share meshes: a few hundred megabytes for all of the lab's.
/// Threads may ask for scenes at the same time.
class StoredScenes {
 public:
  StoredScenes(std::filesystem::path results, DataFolders folders);

  /// Valid as long as this object. Throws InputError if the cell is missing, or if scene or path
  /// are no longer those that were measured.
  StoredScene of(const BlockSummary& block, const std::string& cell_id);

 private:
  struct Kept {
    std::once_flag once;
    LoadedScene loaded;
  };

  std::filesystem::path results_;
  DataFolders folders_;
  std::mutex mutex_;                  // of the map, not of what it holds
  std::map<std::string, Kept> kept_;  // by the content hash of the scene that was measured
};

}  // namespace vislab
