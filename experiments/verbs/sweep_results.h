// Which stored cells belong to which stress sweep.
//   RESULTS/stress/NAME/cells.json   ids of the cells at each value of the dial
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "experiments/analysis/break_points.h"
#include "experiments/run/matrix_runner.h"
#include "experiments/verbs/verbs.h"

namespace vislab {

/// Notes the cells of a run. `first_block` is where the sweep's blocks begin among those that were
/// run. What was noted before is kept: a run may look at some of the cells only.
void note_sweep_cells(const Sweep& sweep, const RunOutcome& outcome, std::size_t first_block,
                      const std::filesystem::path& results);

/// Every sweep of the lab, measured or not, by failure, and what is stored of it. `cells` are those
/// that count. Throws InputError for sweeps and notes that are wrong.
std::vector<SweepResult> sweep_results(const Lab& lab, const std::filesystem::path& results,
                                       const std::vector<JudgedCell>& cells);

/// The blocks that hold anything else than cells of sweeps, and the others.
std::pair<std::vector<BlockSummary>, std::vector<BlockSummary>> split_sweeps(
    std::vector<BlockSummary> blocks, const std::filesystem::path& results);

}  // namespace vislab
