// What matrices plan and a results folder does not hold.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "experiments/analysis/matrix_share.h"
#include "experiments/matrix/matrix.h"
#include "experiments/results/cell.h"

namespace vislab {

/// A chain or a whole block that a matrix plans, and that is not there.
struct PlannedGap {
  std::string name;  // the chain's short name (the control: "none (again)"), or the block's title
  std::string reason;
};

struct PlannedGaps {
  /// By the id of any cell that is there: what its block lacks.
  std::map<std::string, std::vector<PlannedGap>> of_block_with;
  std::vector<PlannedGap> blocks;  // of which nothing is there
  /// Of every matrix with a cell that is there, however few they are; in the matrices' order.
  std::vector<MatrixShare> matrices;
};

/// Results do not say which matrices were run; one of which more than half of the cells are there
/// counts as run, for it was, or was interrupted; gaps are told of these only, shares of all.
/// `cells` are those that count. A cell belongs to a planned block if scene, path, size, frames,
/// device and seed are the same.
PlannedGaps find_planned_gaps(const std::vector<Matrix>& matrices,
                              const std::vector<const ResultCell*>& cells, const Registry& cullers);

/// All matrices of the folder; one that cannot be read says nothing of gaps.
std::vector<Matrix> readable_matrices(const std::filesystem::path& folder, const Registry& cullers);

}  // namespace vislab
