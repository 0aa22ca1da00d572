// What matrices plan and a results folder does not hold.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "experiments/analysis/matrix_share.h"
#include "experiments/matrix/matrix.h"
#include "experiments/matrix/own_paths.h"
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
  /// Of every matrix that was run, in the matrices' order.
  std::vector<MatrixShare> matrices;
};

/// What the matrices that were `run`, by name, plan and `cells`, those that count, do not hold. A
/// cell belongs to a planned block if scene, path (OwnPaths), size, frames, device and seed are the
/// same.
PlannedGaps find_planned_gaps(const std::vector<Matrix>& matrices, const std::set<std::string>& run,
                              const std::vector<const ResultCell*>& cells, const Registry& cullers,
                              const OwnPaths& paths);

/// All matrices of the folder; one that cannot be read says nothing of gaps.
std::vector<Matrix> readable_matrices(const std::filesystem::path& folder, const Registry& cullers);

}  // namespace vislab
