#include "experiments/verbs/size_results.h"

#include <algorithm>
#include <map>
#include <set>

#include "experiments/matrix/own_paths.h"

namespace vislab {
namespace {

using CellsById = std::map<std::string, const ResultCell*>;

CellsById by_id(const std::vector<JudgedCell>& cells) {
  CellsById ids;
  for (const JudgedCell& judged : cells) ids[judged.cell.key.id()] = &judged.cell;
  return ids;
}

/// Was the summary's block run as the sweep's? Scenes are known by what they were loaded from.
bool is_run_of(const BlockSummary& summary, const Block& block, const CellsById& cells,
               const OwnPaths& paths) {
  if (summary.cells.empty() || summary.frames != block.frames) return false;
  const auto found = cells.find(summary.cells.front().id);
  if (found == cells.end()) return false;
  const ResultCell& cell = *found->second;
  return paths.is_on(cell, block) && cell.key.viewport == block.viewport &&
         cell.key.seed == block.seed && cell.key.threads == block.threads &&
         cell.key.device == block.device;
}

const CellSummary* cell_of(const BlockSummary& summary, const std::string& chain) {
  const auto found = std::ranges::find_if(summary.cells, [&](const CellSummary& cell) {
    return cell.canonical == chain && cell.replicate == 0;
  });
  return found == summary.cells.end() ? nullptr : &*found;
}

/// Of several (a scene that was changed since under the same name) the one with most of the cells.
const BlockSummary* run_of(const Block& block, const std::vector<BlockSummary>& blocks,
                           const CellsById& cells, const OwnPaths& paths) {
  const BlockSummary* best = nullptr;
  std::ptrdiff_t most = 0;
  for (const BlockSummary& summary : blocks) {
    if (!is_run_of(summary, block, cells, paths)) continue;
    const auto count = std::ranges::count_if(block.cullers, [&](const BlockCuller& culler) {
      return cell_of(summary, culler.chain) != nullptr;
    });
    if (count <= most) continue;
    most = count;
    best = &summary;
  }
  return best;
}

}  // namespace

std::vector<SizeResult> size_results(const Lab& lab, const std::vector<JudgedCell>& cells,
                                     const std::vector<BlockSummary>& blocks) {
  const CellsById ids = by_id(cells);
  const OwnPaths paths(lab.data);
  std::vector<SizeResult> results;
  for (const SizeSweep& sweep : load_size_sweeps(lab.size_sweeps, lab.cullers)) {
    std::vector<const BlockSummary*> runs;
    for (const Block& block : sweep.blocks) runs.push_back(run_of(block, blocks, ids, paths));
    results.push_back(find_knees(sweep, [&](std::size_t block, const std::string& chain) {
      if (runs[block] == nullptr) return SizeCell{};
      return SizeCell{runs[block], cell_of(*runs[block], chain)};
    }));
  }
  return results;
}

std::vector<BlockSummary> without_size_sweeps(const Lab& lab, const std::vector<JudgedCell>& cells,
                                              std::vector<BlockSummary> blocks) {
  const CellsById ids = by_id(cells);
  const OwnPaths paths(lab.data);
  const std::vector<SizeSweep> sweeps = load_size_sweeps(lab.size_sweeps, lab.cullers);
  std::erase_if(blocks, [&](const BlockSummary& summary) {
    std::set<std::string> chains;
    for (const SizeSweep& sweep : sweeps) {
      for (const Block& block : sweep.blocks) {
        if (!is_run_of(summary, block, ids, paths)) continue;
        for (const BlockCuller& culler : block.cullers) chains.insert(culler.chain);
      }
    }
    return !chains.empty() && std::ranges::all_of(summary.cells, [&](const CellSummary& cell) {
      return chains.contains(cell.canonical);
    });
  });
  return blocks;
}

}  // namespace vislab
