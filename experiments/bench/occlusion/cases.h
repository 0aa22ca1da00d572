// The cases of ./lab bench occlusion.
#pragma once

#include <vector>

#include "experiments/bench/bench.h"

namespace vislab {

/// CHC++ against its ideal, against frustum culling where nothing is hidden, and against
/// stop-and-wait; how its frame times scatter.
void add_coherent_cases(std::vector<BenchCase>& cases);

/// Frame times that the modelled device fitted to OSMesa predicts, ÷ those measured on OSMesa.
void add_prediction_cases(std::vector<BenchCase>& cases);

/// How many queries a second are answered, by how many are asked together, on OSMesa and on the
/// modelled device's presets.
void add_bunch_cases(std::vector<BenchCase>& cases);

}  // namespace vislab
