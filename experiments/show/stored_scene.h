// The scene and the path that a cell was measured on, loaded again.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/scene/library.h"
#include "experiments/analysis/summary.h"

namespace vislab {

struct StoredScene {
  Scene scene;
  Path path;
};

/// Loads what the cells of blocks were measured on, and keeps what was asked for last, because
/// many pictures are of the same scenes: up to a few million triangles together.
class StoredScenes {
 public:
  StoredScenes(std::filesystem::path results, DataFolders folders);

  /// Valid until the next call. Throws InputError if the cell is missing, or if scene or path are
  /// no longer those that were measured.
  const StoredScene& of(const BlockSummary& block, const std::string& cell_id);

 private:
  struct Kept {
    StoredScene stored;
    std::string path_hash, default_path;
  };

  void load_path_of(Kept& kept, const BlockSummary& block, const std::string& source) const;

  std::filesystem::path results_;
  DataFolders folders_;
  std::vector<std::unique_ptr<Kept>> kept_;  // the last that was asked for in front
};

}  // namespace vislab
