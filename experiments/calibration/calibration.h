// Measures the table of costs (common/culler/cost_table.h) on this machine.
#pragma once

#include <functional>
#include <span>

#include "common/culler/cost_table.h"

namespace vislab {

/// What each of `items` costs by the times of two works, one pair a turn, at least one: the least
/// time of the larger less that of the smaller, because whatever else the machine does only ever
/// adds; and the quartiles of the turns' own differences, which show how much was added. What is
/// below 0 (the smaller took longer) counts as 0.
Cost cost_of(std::span<const double> larger_ns, std::span<const double> smaller_ns, double items);

/// What the larger of two works costs more than the smaller, for each of the `items` that it does
/// more. Both run in turns, once to warm up and then `repeats` times.
Cost cost_of_more(const std::function<void()>& larger, const std::function<void()>& smaller,
                  double items, int repeats);

/// Draws a sphere and a field of tetrahedra on a device of its own, whole and in pieces, and tests
/// clusters: the same work on every machine. Takes half a second where nothing else runs.
/// Mesa takes the number of threads that it draws with from the process when its first context is
/// made (LP_NUM_THREADS). Drawing a triangle and testing a cluster cost more than 0; throws
/// std::runtime_error if that cannot be told in several attempts.
CostTable calibrate();

}  // namespace vislab
