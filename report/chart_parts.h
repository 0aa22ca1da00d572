// What the report's charts have in common: their width, the looks of methods, legends, and pieces
// of gnuplot commands. Everything in units of the drawing (1 unit = 1/4 mm as shown), y upwards.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "report/chart_axis.h"

namespace vislab::chart {

constexpr double chart_width = 680.0;
constexpr double legend_text_left = 24.0;  // from the left of an entry's mark

/// How a method is drawn: a colour, and the number of a gnuplot symbol.
struct Look {
  std::string colour;
  int shape = 0;
};

/// Looks repeat after 36 methods. Colours alone repeat after six, in the palette of Okabe and Ito
/// ("Color Universal Design", 2008), which colour-blind readers can tell apart.
Look method_look(std::size_t method);

/// As a text of gnuplot's.
std::string quoted(const std::string& text);

/// How the legend fits under a chart: entries run down the columns.
struct Legend {
  std::vector<double> column_left;
  std::size_t rows = 0;

  double height() const;
  double left(std::size_t entry) const { return column_left[entry / rows]; }
  double middle(std::size_t entry) const;
};

/// The fewest rows whose columns fit beside each other; `texts` in their order.
Legend legend_for(const std::vector<std::string>& texts);

/// `name` is x or y.
void set_axis(std::ostream& out, char name, const ChartAxis& axis);

/// The panel that the next plot fills.
void set_margins(std::ostream& out, double left, double bottom, double width, double height,
                 double chart_height);

}  // namespace vislab::chart
