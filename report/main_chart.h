// The chart of everything in one: time against error, each method on each scene, by family.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/analysis/summary.h"

namespace vislab {

/// True if any method was judged and timed against none on a block that was drawn, on a real device
/// and on one machine.
bool has_main_chart(const std::vector<BlockSummary>& blocks);

/// gnuplot commands that draw it into `file` (SVG, 680 units wide): a mark for each such method and
/// block, against_none across, false pixels and over upwards. Chains of several methods, the
/// oracles and what is wrong on purpose have marks of their own.
std::string main_chart_script(const std::vector<BlockSummary>& blocks,
                              const std::filesystem::path& file);

}  // namespace vislab
