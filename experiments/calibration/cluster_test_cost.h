// What one test of a cluster costs: t_C of the cost model.
#pragma once

#include "common/culler/cost_table.h"

namespace vislab {

/// One cluster of backface.cluster: its kernel over the clusters of a sphere, from eyes around it,
/// divided by their number.
Cost cluster_test_cost(int repeats);

}  // namespace vislab
