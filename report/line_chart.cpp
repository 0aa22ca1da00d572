#include "report/line_chart.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "report/chart_legend.h"
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

}  // namespace

std::string line_chart_script(const LineChart& line_chart, const std::filesystem::path& file) {
  std::vector<double> xs;
  std::vector<double> ys;
  std::vector<LegendEntry> entries;
  for (const LineSeries& series : line_chart.series) {
    const Look look = method_look(entries.size());
    LegendEntry entry = symbol_entry(series.name, look, line_chart.over_frames ? 0.0 : 0.8);
    entry.line = "lw 1.6 lc rgb '" + look.colour + "'";
    entries.push_back(std::move(entry));
    for (const auto& [x, y] : series.points) {
      xs.push_back(x);
      ys.push_back(y);
    }
  }
  if (xs.empty()) throw std::logic_error("line_chart_script: there is no point to draw");
  const Legend legend(std::move(entries));
  const double bottom = legend.height() + axis_height;
  const double height = bottom + panel_height + top_margin;
  std::ostringstream out;
  out.precision(12);
  start_chart(out, file, height);
  out << "set border 3 lc rgb '#444444'\nset tics nomirror out scale 0.5\n"
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
  legend.write(out, height);
  end_chart(out);
  return out.str();
}

}  // namespace vislab
