#include "experiments/show/stored_scene.h"

#include "common/scene/error.h"
#include "experiments/results/store.h"

namespace vislab {

StoredScenes::StoredScenes(std::filesystem::path results, DataFolders folders)
    : results_(std::move(results)), folders_(std::move(folders)) {}

const StoredScene& StoredScenes::of(const BlockSummary& block, const std::string& cell_id) {
  const auto is_wanted = [&] {
    return loaded_ != nullptr && loaded_->scene.content_hash() == block.scene_hash &&
           loaded_->path.content_hash() == block.path_hash;
  };
  if (is_wanted()) return *loaded_;
  const std::optional<ResultCell> stored = ResultStore::open(results_).load_cell(cell_id);
  if (!stored) throw InputError("cell " + cell_id + " is missing");
  LoadedScene loaded = load_scene(stored->scene_source, folders_);
  loaded_ = std::make_unique<StoredScene>();
  loaded_->scene = std::move(loaded.scene);
  loaded_->path = load_path(stored->path_source.empty() ? loaded.default_path : stored->path_source,
                            loaded_->scene, block.viewport, block.frames, folders_);
  if (!is_wanted()) {
    throw InputError("scene " + block.scene + " or its path has changed since it was measured");
  }
  return *loaded_;
}

}  // namespace vislab
