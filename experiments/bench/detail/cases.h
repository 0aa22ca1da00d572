// The cases of `./lab bench detail`.
#pragma once

#include <vector>

#include "experiments/bench/bench.h"

namespace vislab {

/// The greatest area and the most pixel centres that an object loses, as shares of what the
/// threshold allows.
void add_loss_cases(std::vector<BenchCase>& cases);

/// The exact areas against the printed estimate: time to decide about a swarm.
void add_time_cases(std::vector<BenchCase>& cases);

}  // namespace vislab
