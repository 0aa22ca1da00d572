// A chart of lines over a common axis, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace vislab {

struct LineSeries {
  std::string name;                               // in the legend
  std::vector<std::pair<double, double>> points;  // by ascending x
};

struct LineChart {
  std::string x_title, y_title;  // with their units
  std::vector<LineSeries> series;
  bool over_frames = false;  // x are frames: from zero and evenly, without marks
};

/// gnuplot commands that draw it into `file` (SVG, 680 units wide). Axes begin at zero, or are
/// logarithmic where values differ by more than a factor of six. Values must be positive, but for
/// frames. Throws std::logic_error without a point.
std::string line_chart_script(const LineChart& chart, const std::filesystem::path& file);

}  // namespace vislab
