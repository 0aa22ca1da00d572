// Verdicts on the cells of a block.
#pragma once

#include <vector>

#include "common/judge/path_truth.h"
#include "common/scene/path.h"
#include "experiments/results/store.h"
#include "experiments/run/progress.h"

namespace vislab {

/// Judges all cells (of one scene, path and viewport) whose verdicts are missing or were made by
/// another judge, and stores what it finds. Every distinct set of a frame is judged once; images
/// are drawn only if `drawn`.
void judge_cells(const std::vector<const ResultCell*>& cells, const Scene& scene, const Path& path,
                 const Viewport& viewport, const PathTruth& truth, RayCaster& caster, bool drawn,
                 const ResultStore& store, Progress& progress);

}  // namespace vislab
