// Measures the table of costs (common/culler/cost_table.h) on this machine.
#pragma once

#include <functional>
#include <vector>

#include "common/culler/cost_table.h"

namespace vislab {

/// Median and quartiles of samples, at least one; what is below 0 (the smaller of two works took
/// longer) counts as 0.
Cost cost_of(std::vector<double> samples_ns);

/// What the larger of two works costs more than the smaller, for each of the `items` that it does
/// more. Both run in turns, once to warm up and then `repeats` times, so that whatever else the
/// machine does falls on both.
Cost cost_of_more(const std::function<void()>& larger, const std::function<void()>& smaller,
                  double items, int repeats);

/// Draws a sphere and a field of tetrahedra on a device of its own, whole and in pieces, and tests
/// clusters: the same work on every machine. Takes a quarter of a second where nothing else runs.
/// Mesa takes the number of threads that it draws with from the process when its first context is
/// made (LP_NUM_THREADS).
CostTable calibrate();

}  // namespace vislab
