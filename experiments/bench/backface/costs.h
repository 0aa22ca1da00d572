// What a whole culler costs before the first frame: time to build it, and memory.
#pragma once

#include <string>
#include <vector>

#include "experiments/bench/bench.h"

namespace vislab {

/// Appends the cases "WORLD, build" (millions of triangles a second) and "WORLD, memory a triangle"
/// (bytes) of a culler, with its defaults, on a sphere of 1,002,252 triangles: "sphere", "low" or
/// "high" (the bumps).
void add_costs(std::vector<BenchCase>& cases, const std::string& culler, const std::string& world);

}  // namespace vislab
