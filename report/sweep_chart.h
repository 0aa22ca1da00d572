// The chart of a stress sweep: the figure that it looks at over its dial, one line a method.
#pragma once

#include <filesystem>
#include <string>

#include "experiments/analysis/break_points.h"

namespace vislab {

/// Does any method have a figure to be drawn?
bool has_sweep_chart(const SweepResult& result);

/// Is the chart a high one, as there are many lines to tell apart?
bool has_many_lines(const SweepResult& result);

/// gnuplot commands that draw the sweep's chart into `file` (SVG, 680 units wide). The dial's
/// values stand at equal distances. Break points are ringed.
std::string sweep_chart_script(const SweepResult& result, const std::filesystem::path& file);

}  // namespace vislab
