// The charts of size sweeps: speed and accuracy of a method against the size of its model.
#pragma once

#include <filesystem>
#include <string>

#include "experiments/analysis/knees.h"

namespace vislab {

/// gnuplot commands that draw a method's curves, one a scene, into `file` (SVG, 680 units wide):
/// efficiency as a share of the best, and over-inclusion, against what build() left in memory and
/// against how long it took. Where that is the same for all values (dials that are turned when
/// asked, not when built), against the dial's values, at equal distances. Knees are ringed,
/// defaults are black.
std::string size_chart_script(const SizeSweep& sweep, const SizeVerdict& verdict,
                              const std::filesystem::path& file);

}  // namespace vislab
