// The cases of `./lab bench backface`.
#pragma once

#include <vector>

#include "experiments/bench/bench.h"

namespace vislab {

/// Clusters on the bumpy spheres against meshoptimizer's cones: shares and times of tests; whole
/// cullers and chains against backface.polygon, also on scanned figures if they were fetched;
/// building and memory.
void add_cluster_cases(std::vector<BenchCase>& cases);

/// Cones of normals on the same spheres; what is saved by remembering verdicts from frame to frame.
void add_cone_cases(std::vector<BenchCase>& cases);

/// Normal masks: speed of look-ups, and the shares that were predicted.
void add_mask_cases(std::vector<BenchCase>& cases);

/// Tests of single triangles: the forms of backface.polygon, the projected plane, and the kernel.
void add_polygon_cases(std::vector<BenchCase>& cases);

}  // namespace vislab
