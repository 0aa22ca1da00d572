#include "experiments/show/stored_scene.h"

#include "common/scene/error.h"
#include "experiments/results/store.h"

namespace vislab {

StoredScenes::StoredScenes(std::filesystem::path results, DataFolders folders)
    : results_(std::move(results)), folders_(std::move(folders)) {}

StoredScene StoredScenes::of(const BlockSummary& block, const std::string& cell_id) {
  const std::optional<ResultCell> stored = ResultStore::open(results_).load_cell(cell_id);
  if (!stored) throw InputError("cell " + cell_id + " is missing");
  Kept* kept = nullptr;
  {
    const std::scoped_lock lock(mutex_);
    kept = &kept_[block.scene_hash];
  }
  std::call_once(kept->once, [&] { kept->loaded = load_scene(stored->scene_source, folders_); });
  const Scene& scene = kept->loaded.scene;
  const std::string& source =
      stored->path_source.empty() ? kept->loaded.default_path : stored->path_source;
  Path path = load_path(source, scene, block.viewport, block.frames, folders_);
  if (scene.content_hash() != block.scene_hash || path.content_hash() != block.path_hash) {
    throw InputError("scene " + block.scene + " or its path has changed since it was measured");
  }
  return {scene, std::move(path)};
}

}  // namespace vislab
