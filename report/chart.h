// The chart of a block: time against error, two panels with a common legend, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/analysis/summary.h"

namespace vislab {

/// True if the frame times of the block's cells may stand on one axis: they were measured with the
/// drawing in them, and all on the same machine and the same dials of a modelled device.
bool has_time_axis(const BlockSummary& block);

/// The cells that have a point in the chart, in the block's order: measured and judged. A cell's
/// number in charts and tables is its place in the block, from 1.
std::vector<const CellSummary*> charted_cells(const BlockSummary& block);

/// Ascending indices of the points that no other beats in both `x` and `y` (lower is better):
/// the Pareto hull, by x. Of equal points the first stands for all.
std::vector<std::size_t> pareto_hull(const std::vector<double>& x, const std::vector<double>& y);

/// Which methods a chart shows; the anchors always stand in it. An empty function takes all.
using ChartChoice = std::function<bool(const CellSummary& cell)>;

/// gnuplot commands that draw the block's chart into `file` (SVG, 680 × 360 units, shown 17 cm wide
/// and 9 cm high; higher if the legend is long). Cells of one chain that differ in the value of one
/// dial only are joined in the order of the dial, whose values stand at both ends. Without a common
/// time axis the triangles submitted take its place.
std::string chart_script(const BlockSummary& block, const std::filesystem::path& file,
                         const ChartChoice& takes = {});

}  // namespace vislab
