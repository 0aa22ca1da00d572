// The cases of `./lab bench portal`.
#pragma once

#include <vector>

#include "experiments/bench/bench.h"

namespace vislab {

/// Walks through Quake III worlds: what following portals costs a frame, and what it leaves out of
/// what the world's own potentially visible sets and the frustum keep.
void add_walk_cases(std::vector<BenchCase>& cases);

/// Potentially visible sets of these worlds: how long cells and sets take to find, what the sets
/// miss and what they hold too much, the world's own beside the lab's.
void add_set_cases(std::vector<BenchCase>& cases);

}  // namespace vislab
