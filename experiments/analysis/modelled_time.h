// What frames would take at calibrated costs.
#pragma once

#include <vector>

#include "experiments/analysis/summary.h"

namespace vislab {

/// Figure by figure the median of the tables, of which there is at least one.
CostTable median_table(const std::vector<CostTable>& tables);

/// Fills in modelled_frame_ms of all cells from BlockSummary::costs; NaN on modelled devices, whose
/// times are modelled already. All cells of a machine are
/// modelled with one table, so that its noise does not come between them.
void model_frame_times(BlockSummary& block);

}  // namespace vislab
