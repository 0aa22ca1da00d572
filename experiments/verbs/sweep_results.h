// Which stored cells belong to which stress sweep.
//   RESULTS/stress/NAME/cells.json   for each value of the dial: hash of what the sweep said of it,
//                                    and the id of each method's cell; ids that were noted once
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "experiments/analysis/break_points.h"
#include "experiments/run/matrix_runner.h"
#include "experiments/verbs/verbs.h"

namespace vislab {

/// Notes the cells of a run, each instead of the one that the same method had at that value.
/// `first_block` is where the sweep's blocks begin among those that were run. What was noted of
/// methods that this run did not look at is kept if the sweep still says the same of that value.
void note_sweep_cells(const Sweep& sweep, const RunOutcome& outcome, std::size_t first_block,
                      const std::filesystem::path& results);

/// Every sweep of the lab, measured or not, by failure, then those that were run from other files,
/// and what is stored of each as it is described now. `cells` are those that count. A sweep that
/// cannot be read is left out, and why is said on stderr. Throws InputError for notes that are
/// wrong, and where no method has the counter that a sweep asks for.
std::vector<SweepResult> sweep_results(const Lab& lab, const std::filesystem::path& results,
                                       const std::vector<JudgedCell>& cells);

/// The blocks that hold anything else than cells of sweeps, and those of the sweeps as they are
/// described now. Cells of sweeps that have changed or are gone are in neither.
std::pair<std::vector<BlockSummary>, std::vector<BlockSummary>> split_sweeps(
    const Lab& lab, std::vector<BlockSummary> blocks, const std::filesystem::path& results);

}  // namespace vislab
