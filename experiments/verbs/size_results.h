// Which stored cells belong to which size sweep.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/analysis/knees.h"
#include "experiments/verbs/verbs.h"

namespace vislab {

/// Every size sweep of the lab, measured or not, by name, with what is stored of each as it is
/// described now. `cells` are those that count, `blocks` what summarise() makes of them or of some
/// of them. Results hold no pointers into either.
std::vector<SizeResult> size_results(const Lab& lab, const std::vector<JudgedCell>& cells,
                                     const std::vector<BlockSummary>& blocks);

/// `blocks` without those that hold nothing but cells of size sweeps.
std::vector<BlockSummary> without_size_sweeps(const Lab& lab, const std::vector<JudgedCell>& cells,
                                              std::vector<BlockSummary> blocks);

}  // namespace vislab
