// The scene and the path that a cell was measured on, loaded again.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/scene/library.h"
#include "experiments/analysis/summary.h"

namespace vislab {

struct StoredScene {
  Scene scene;
  Path path;
};

/// Loads what the cells of blocks were measured on; keeps the last one, because pictures of the
/// same block come one after the other.
class StoredScenes {
 public:
  StoredScenes(std::filesystem::path results, DataFolders folders);

  /// Valid until the next call. Throws InputError if the cell is missing, or if scene or path are
  /// no longer those that were measured.
  const StoredScene& of(const BlockSummary& block, const std::string& cell_id);

 private:
  std::filesystem::path results_;
  DataFolders folders_;
  std::unique_ptr<StoredScene> loaded_;
};

}  // namespace vislab
