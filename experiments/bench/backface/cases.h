// The cases of `./lab bench backface`.
#pragma once

#include <vector>

#include "experiments/bench/bench.h"

namespace vislab {

/// Clusters on the bumpy spheres against meshoptimizer's cones: shares and times of tests; whole
/// cullers and chains against backface.polygon; building and memory.
void add_cluster_cases(std::vector<BenchCase>& cases);

}  // namespace vislab
