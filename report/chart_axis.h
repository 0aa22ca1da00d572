// Axes of the report's charts: range, ticks, and where a value lies.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace vislab {

/// One axis. On a logarithmic axis zero lies at the lower end, set apart from the lowest decade.
struct ChartAxis {
  bool logarithmic = false;
  double low = 0.0, high = 1.0;  // ends of the axis, in the units that it is drawn in
  double zero = 0.0;             // where a value of zero is drawn
  double zero_band_top = 0.0;    // logarithmic: from `low` to here is kept for zero
  std::vector<std::pair<double, std::string>> ticks;  // position and label

  /// Where the value is drawn, in the axis's units: the value itself, or `zero` for zero.
  double position(double value) const;
  /// The same as a share of the axis's length; 0 is the low end.
  double share(double value) const;
};

/// An axis from 0 to 1 for figures that are all 0.
ChartAxis zero_axis();

/// An axis for positive values such as times: from zero, or logarithmic if they differ by more than
/// a factor of six. `values` may be empty.
ChartAxis positive_axis(const std::vector<double>& values);

/// An axis for values that may be zero and differ by orders of magnitude: always logarithmic, zero
/// at the bottom with the label `zero_label`. Ends at `least_high` or higher.
ChartAxis logarithmic_axis(const std::vector<double>& values, double least_high,
                           const std::string& zero_label);

}  // namespace vislab
