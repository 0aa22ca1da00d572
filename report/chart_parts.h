// What the report's charts have in common: their width, the looks of methods, and pieces of gnuplot
// commands. Everything in units of the drawing (1 unit = 1/4 mm as shown), y upwards.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "report/chart_axis.h"

namespace vislab::chart {

constexpr double chart_width = 680.0;

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

/// `name` is x or y.
void set_axis(std::ostream& out, char name, const ChartAxis& axis);

/// Begins a chart of panels in a file, an SVG.
void start_chart(std::ostream& out, const std::filesystem::path& file, double height);
void end_chart(std::ostream& out);

/// The panel that the next plot fills.
void set_margins(std::ostream& out, double left, double bottom, double width, double height,
                 double chart_height);

}  // namespace vislab::chart
