// The legend under a chart: entries run down columns, as few rows as fit into the chart's width.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "report/chart_parts.h"

namespace vislab::chart {

/// A text behind any of a symbol, a line and a field of colour.
struct LegendEntry {
  std::string text;
  Look look;
  double symbol_size = 0.0;  // as gnuplot's; 0: no symbol
  std::string line;          // gnuplot's style; empty: no line
  std::string field;         // colour; empty: no field
};

LegendEntry symbol_entry(std::string text, Look look, double size);
LegendEntry line_entry(std::string text, std::string style);

class Legend {
 public:
  Legend() = default;
  explicit Legend(std::vector<LegendEntry> entries);

  double height() const;

  /// Below the panels of a chart of that height, as its last plot.
  void write(std::ostream& out, double chart_height) const;

 private:
  bool fits(std::size_t rows);

  std::vector<LegendEntry> entries_;
  std::vector<double> column_left_;
  std::size_t rows_ = 0;
};

}  // namespace vislab::chart
