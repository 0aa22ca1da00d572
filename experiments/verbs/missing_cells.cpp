#include "experiments/verbs/missing_cells.h"

#include <set>
#include <tuple>

#include "common/scene/error.h"

namespace vislab {
namespace {

/// What tells blocks apart, as their descriptions name it.
using BlockName = std::tuple<std::string, std::string, int, int, int, std::string, std::uint64_t>;

/// A chain and its number among several of the same: the control is the second none.
using Place = std::pair<std::string, int>;

struct StoredBlock {
  std::vector<std::string> ids;
  std::set<Place> places;
};

BlockName name_of(const Block& block, const OwnPaths& paths) {
  return {block.scene,
          paths.resolved(block.scene, block.path),
          block.viewport.width,
          block.viewport.height,
          block.frames,
          block.device,
          block.seed};
}

/// The second name is of blocks that take as many frames as the path has.
std::pair<BlockName, BlockName> names_of(const ResultCell& cell, const OwnPaths& paths) {
  BlockName name{cell.scene_source,
                 paths.resolved(cell.scene_source, cell.path_source),
                 cell.key.viewport.width,
                 cell.key.viewport.height,
                 static_cast<int>(cell.frames.size()),
                 cell.key.device,
                 cell.key.seed};
  BlockName all = name;
  std::get<4>(all) = 0;
  return {std::move(name), std::move(all)};
}

std::set<Place> planned_places(const Block& block) {
  std::set<Place> places;
  for (const BlockCuller& culler : block.cullers) places.emplace(culler.chain, culler.replicate);
  return places;
}

MatrixShare share_of(const Matrix& matrix, const std::map<BlockName, StoredBlock>& stored,
                     const Registry& cullers, const OwnPaths& paths) {
  MatrixShare share{matrix.name, 0, 0, {}};
  for (const Block& block : matrix.blocks) {
    const auto found = stored.find(name_of(block, paths));
    for (const Place& place : planned_places(block)) {
      ++share.planned;
      if (found != stored.end() && found->second.places.contains(place)) {
        ++share.present;
      } else {
        ++share.missing[cullers.short_name(place.first)];
      }
    }
  }
  return share;
}

}  // namespace

PlannedGaps find_planned_gaps(const std::vector<Matrix>& matrices, const std::set<std::string>& run,
                              const std::vector<const ResultCell*>& cells, const Registry& cullers,
                              const OwnPaths& paths) {
  std::map<BlockName, StoredBlock> stored;
  for (const ResultCell* cell : cells) {
    const auto [name, all] = names_of(*cell, paths);
    for (const BlockName& one : {name, all}) {
      stored[one].ids.push_back(cell->key.id());
      stored[one].places.emplace(cell->key.chain, cell->key.replicate);
    }
  }
  PlannedGaps gaps;
  std::set<std::pair<BlockName, Place>> told;  // several matrices may plan the same
  for (const Matrix& matrix : matrices) {
    if (!run.contains(matrix.name)) continue;
    gaps.matrices.push_back(share_of(matrix, stored, cullers, paths));
    const std::string reason = "the matrix " + matrix.name +
                               " plans this, and nothing of it was measured with the sources as "
                               "they are ('vislab run " +
                               matrix.name + "')";
    for (const Block& block : matrix.blocks) {
      const BlockName name = name_of(block, paths);
      const auto found = stored.find(name);
      if (found == stored.end()) {
        if (told.emplace(name, Place()).second) gaps.blocks.push_back({block.title(), reason});
        continue;
      }
      for (const Place& place : planned_places(block)) {
        if (found->second.places.contains(place) || !told.emplace(name, place).second) continue;
        const auto& [chain, replicate] = place;
        const std::string again = replicate > 0 ? " (again)" : "";
        for (const std::string& id : found->second.ids) {
          gaps.of_block_with[id].push_back({cullers.short_name(chain) + again, reason});
        }
      }
    }
  }
  return gaps;
}

std::vector<Matrix> readable_matrices(const std::filesystem::path& folder,
                                      const Registry& cullers) {
  std::vector<Matrix> matrices;
  for (const auto& [name, description] : list_matrices(folder)) {
    try {
      matrices.push_back(load_matrix(name, folder, cullers));
    } catch (const InputError&) {
      continue;  // 'vislab plan' says what is wrong with it
    }
  }
  return matrices;
}

}  // namespace vislab
