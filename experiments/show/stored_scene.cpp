#include "experiments/show/stored_scene.h"

#include <algorithm>

#include "common/scene/error.h"
#include "experiments/results/store.h"

namespace vislab {
namespace {

constexpr std::size_t most_triangles = 8'000'000;

}  // namespace

StoredScenes::StoredScenes(std::filesystem::path results, DataFolders folders)
    : results_(std::move(results)), folders_(std::move(folders)) {}

void StoredScenes::load_path_of(Kept& kept, const BlockSummary& block,
                                const std::string& source) const {
  kept.stored.path = load_path(source.empty() ? kept.default_path : source, kept.stored.scene,
                               block.viewport, block.frames, folders_);
  kept.path_hash = kept.stored.path.content_hash();
}

const StoredScene& StoredScenes::of(const BlockSummary& block, const std::string& cell_id) {
  const auto found = std::ranges::find_if(kept_, [&](const auto& kept) {
    return kept->stored.scene.content_hash() == block.scene_hash;
  });
  if (found != kept_.end() && (*found)->path_hash == block.path_hash) {
    std::rotate(kept_.begin(), found, found + 1);
    return kept_.front()->stored;
  }
  const std::optional<ResultCell> stored = ResultStore::open(results_).load_cell(cell_id);
  if (!stored) throw InputError("cell " + cell_id + " is missing");
  if (found != kept_.end()) {
    std::rotate(kept_.begin(), found, found + 1);
  } else {
    LoadedScene loaded = load_scene(stored->scene_source, folders_);
    auto kept = std::make_unique<Kept>();
    kept->stored.scene = std::move(loaded.scene);
    kept->default_path = loaded.default_path;
    kept_.insert(kept_.begin(), std::move(kept));
    std::size_t triangles = 0;
    const auto first_too_many = std::ranges::find_if(kept_, [&](const auto& one) {
      triangles += one->stored.scene.triangle_count();
      return triangles > most_triangles;
    });
    kept_.erase(std::max(first_too_many, kept_.begin() + 1), kept_.end());
  }
  Kept& kept = *kept_.front();
  load_path_of(kept, block, stored->path_source);
  if (kept.stored.scene.content_hash() != block.scene_hash || kept.path_hash != block.path_hash) {
    throw InputError("scene " + block.scene + " or its path has changed since it was measured");
  }
  return kept.stored;
}

}  // namespace vislab
