#include "report/line_chart.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "report/chart_parts.h"

namespace vislab {
namespace {

using namespace chart;

constexpr double panel_left = 92.0, panel_width = 568.0, panel_height = 190.0;
constexpr double y_title_left = 10.0;
constexpr double axis_height = 50.0;  // tick labels and title below the panel
constexpr double top_margin = 10.0;

void write_points(const std::vector<LineSeries>& series, std::ostream& out) {
  for (std::size_t i = 0; i < series.size(); ++i) {
    out << "$line" << i << " << END\n";
    for (const auto& [x, y] : series[i].points) out << x << ' ' << y << '\n';
    out << "END\n";
  }
}

void write_legend(const LineChart& line_chart, const Legend& legend, double height,
                  std::ostream& out) {
  out << "unset label\nunset xlabel\nunset border\nunset tics\nunset grid\nunset logscale\n"
      << "set xrange [0:" << chart_width << "]\nset yrange [0:" << legend.height() << "]\n";
  set_margins(out, 0.0, 0.0, chart_width, legend.height(), height);
  for (std::size_t i = 0; i < line_chart.series.size(); ++i) {
    const Look look = method_look(i);
    out << "set label " << quoted(line_chart.series[i].name) << " at first "
        << legend.left(i) + legend_text_left << ',' << legend.middle(i)
        << " left font ',10.5'\nset arrow from first " << legend.left(i) << ',' << legend.middle(i)
        << " to first " << legend.left(i) + 18.0 << ',' << legend.middle(i)
        << " nohead lw 1.6 lc rgb '" << look.colour << "'\n";
    if (line_chart.over_frames) continue;
    out << "$mark" << i << " << END\n"
        << legend.left(i) + 9.0 << ' ' << legend.middle(i) << "\nEND\n";
  }
  out << "plot";
  for (std::size_t i = 0; !line_chart.over_frames && i < line_chart.series.size(); ++i) {
    const Look look = method_look(i);
    out << (i == 0 ? " " : ", \\\n  ") << "$mark" << i << " using 1:2 with points notitle pt "
        << look.shape << " ps 0.8 lc rgb '" << look.colour << "'";
  }
  out << (line_chart.over_frames ? " NaN notitle\n" : "\n");
}

}  // namespace

std::string line_chart_script(const LineChart& line_chart, const std::filesystem::path& file) {
  std::vector<double> xs;
  std::vector<double> ys;
  std::vector<std::string> names;
  for (const LineSeries& series : line_chart.series) {
    names.push_back(series.name);
    for (const auto& [x, y] : series.points) {
      xs.push_back(x);
      ys.push_back(y);
    }
  }
  if (xs.empty()) throw std::logic_error("line_chart_script: there is no point to draw");
  const Legend legend = legend_for(names);
  const double bottom = legend.height() + axis_height;
  const double height = bottom + panel_height + top_margin;
  std::ostringstream out;
  out.precision(12);
  out << "reset\nunset key\nset terminal svg size " << chart_width << ',' << height
      << " noenhanced font 'Noto Sans,11' background '#FFFFFF'\nset output "
      << quoted(file.string()) << "\nset multiplot\n"
      << "set border 3 lc rgb '#444444'\nset tics nomirror out scale 0.5\n"
      << "set grid xtics ytics lt 1 lw 0.5 lc rgb '#E4E4E4'\nset xlabel "
      << quoted(line_chart.x_title) << " offset 0,0.5\nset label " << quoted(line_chart.y_title)
      << " at screen " << y_title_left / chart_width << ','
      << (bottom + 0.5 * panel_height) / height << " center rotate by 90\n";
  // One value alone gives an axis from zero.
  if (line_chart.over_frames) xs = {std::max(1.0, std::ranges::max(xs))};
  set_axis(out, 'x', positive_axis(xs));
  set_axis(out, 'y', positive_axis(ys));
  set_margins(out, panel_left, bottom, panel_width, panel_height, height);
  write_points(line_chart.series, out);
  out << "plot";
  for (std::size_t i = 0; i < line_chart.series.size(); ++i) {
    const Look look = method_look(i);
    out << (i == 0 ? " " : ", \\\n  ") << "$line" << i << " using 1:2 with "
        << (line_chart.over_frames ? "lines" : "linespoints") << " notitle lw 1.6 lc rgb '"
        << look.colour << "'";
    if (!line_chart.over_frames) out << " pt " << look.shape << " ps 0.8";
  }
  out << '\n';
  write_legend(line_chart, legend, height, out);
  out << "unset multiplot\nunset output\n";
  return out.str();
}

}  // namespace vislab
