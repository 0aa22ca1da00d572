// The cases of `./lab bench depth`.
#pragma once

#include <vector>

#include "experiments/bench/bench.h"

namespace vislab {

/// The city of 24,000 occluder triangles and 100,000 boxes: drawing whole and testing before
/// drawing, box queries and what they find; buffers against the brute-force one.
void add_city_cases(std::vector<BenchCase>& cases);

/// The city's figures in the form that other libraries' are listed in. Takes those that were
/// measured by the cases, and measures what is missing.
void print_city_table();

/// How the time of whole cullers grows with the number of hidden objects.
void add_growth_cases(std::vector<BenchCase>& cases);

}  // namespace vislab
