// The cases of `./lab bench frustum`.
#pragma once

#include <vector>

#include "experiments/bench/bench.h"

namespace vislab {

/// frustum.flat against the culler of Filament, Bullet's tree, a bare loop, and itself.
void add_flat_cases(std::vector<BenchCase>& cases);
/// frustum.bvh over objects that stand still.
void add_bvh_cases(std::vector<BenchCase>& cases);
/// Updating and culling when some of the objects move.
void add_moving_cases(std::vector<BenchCase>& cases);

}  // namespace vislab
