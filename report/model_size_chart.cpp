#include "report/model_size_chart.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

#include "report/chart_legend.h"
#include "report/chart_parts.h"

namespace vislab {
namespace {

using namespace chart;

constexpr double panel_left = 74.0, panel_gap = 74.0, panel_height = 130.0;
constexpr double right_margin = 16.0, top_margin = 10.0;
constexpr double axis_height = 48.0;  // tick labels and title below a panel
constexpr double y_title_offset = 58.0;
constexpr double digit_width = 6.5, tick_gap = 8.0;  // of tick labels
constexpr int ring = 6, dot = 7;
constexpr const char* knee_line = "dt (2,4) lw 1.2 lc rgb '#777777'";

using Figure = std::function<double(const SizePoint&, std::size_t value)>;

/// What a row of panels shows, and a column.
struct Measure {
  std::string title;
  Figure figure;
  ChartAxis axis;
};

std::vector<double> figures_of(const SizeVerdict& verdict, const Figure& figure) {
  std::vector<double> figures;
  for (const SizeCurve& scene : verdict.scenes) {
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      if (!scene.points[i].was_measured()) continue;
      const double value = figure(scene.points[i], i);
      if (!std::isnan(value)) figures.push_back(value);
    }
  }
  return figures;
}

ChartAxis axis_of(const std::vector<double>& figures) {
  const double most = figures.empty() ? 0.0 : std::ranges::max(figures);
  if (!(most > 0.0)) return positive_axis({1.0});
  const bool has_zero = std::ranges::count(figures, 0.0) > 0;
  return has_zero ? logarithmic_axis(figures, most, "0") : positive_axis(figures);
}

class SizeChart {
 public:
  SizeChart(const SizeSweep& sweep, const SizeVerdict& verdict, std::ostream& out)
      : sweep_(sweep), verdict_(verdict), out_(out) {
    const auto add = [&](std::vector<Measure>& to, const std::string& title, const Figure& figure) {
      to.push_back({title, figure, axis_of(figures_of(verdict_, figure))});
    };
    if (size_changes()) {
      add(columns_, "memory of the model (kB)", [](const SizePoint& point, std::size_t) {
        return static_cast<double>(point.bytes) / 1e3;
      });
      add(columns_, "time to build it (ms)",
          [](const SizePoint& point, std::size_t) { return point.build_ms; });
    } else {
      columns_.push_back(
          {sweep.dial + (sweep.unit.empty() ? "" : " (" + sweep.unit + ")"),
           [](const SizePoint&, std::size_t value) { return static_cast<double>(value); },
           {}});
    }
    add(rows_, "efficiency ÷ best",
        [](const SizePoint& point, std::size_t) { return point.relative; });
    add(rows_, "over-inclusion", [](const SizePoint& point, std::size_t) { return point.over; });
    std::vector<LegendEntry> entries;
    for (const SizeCurve& scene : verdict.scenes) {
      entries.push_back(symbol_entry(scene.scene + (scene.path.empty() ? "" : ", " + scene.path),
                                     method_look(entries.size()), 0.8));
    }
    entries.push_back(symbol_entry("ring: knee", Look{"#000000", ring}, 1.5));
    entries.push_back(symbol_entry("black: default", Look{"#000000", dot}, 0.5));
    legend_ = Legend(std::move(entries));
    const auto columns = static_cast<double>(columns_.size());
    panel_width_ =
        (chart_width - panel_left - right_margin - (columns - 1.0) * panel_gap) / columns;
    if (!size_changes()) columns_.front().axis = dial_axis();
  }

  void write(const std::filesystem::path& file) {
    const auto rows = static_cast<double>(rows_.size());
    height_ = legend_.height() + rows * (axis_height + panel_height + top_margin);
    start_chart(out_, file, height_);
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      for (std::size_t column = 0; column < columns_.size(); ++column) write_panel(row, column);
    }
    legend_.write(out_, height_);
    end_chart(out_);
  }

 private:
  bool size_changes() const {
    return std::ranges::any_of(verdict_.scenes, [](const SizeCurve& scene) {
      std::vector<std::uint64_t> sizes;
      for (const SizePoint& point : scene.points) {
        if (point.was_measured()) sizes.push_back(point.bytes);
      }
      return std::ranges::adjacent_find(sizes, std::ranges::not_equal_to()) != sizes.end();
    });
  }

  /// Labels stand so far apart that they do not run into each other.
  ChartAxis dial_axis() const {
    ChartAxis axis;
    axis.low = -0.5;
    axis.high = static_cast<double>(sweep_.values.size()) - 0.5;
    std::size_t longest = 0;
    for (const std::string& value : sweep_.values) longest = std::max(longest, value.size());
    const double room = panel_width_ / static_cast<double>(sweep_.values.size());
    const double needed = digit_width * static_cast<double>(longest) + tick_gap;
    const auto step = static_cast<std::size_t>(std::max(1.0, std::ceil(needed / room)));
    for (std::size_t i = 0; i < sweep_.values.size(); i += step) {
      axis.ticks.emplace_back(static_cast<double>(i), sweep_.values[i]);
    }
    return axis;
  }

  void write_panel(std::size_t row, std::size_t column) {
    const Measure& x = columns_[column];
    const Measure& y = rows_[row];
    const double left = panel_left + static_cast<double>(column) * (panel_width_ + panel_gap);
    const double bottom =
        legend_.height() + axis_height +
        static_cast<double>(rows_.size() - 1 - row) * (axis_height + panel_height + top_margin);
    out_ << "unset label\nunset arrow\nunset object\nset border 3 lc rgb '#444444'\n"
         << "set tics nomirror out scale 0.5\nset grid xtics ytics lt 1 lw 0.5 lc rgb '#E4E4E4'\n"
         << "unset title\nunset ylabel\nset xlabel " << quoted(x.title)
         << " offset 0,0.5\nset label " << quoted(y.title) << " at screen "
         << (left - y_title_offset) / chart_width << ',' << (bottom + 0.5 * panel_height) / height_
         << " center rotate by 90\n";
    set_axis(out_, 'x', x.axis);
    set_axis(out_, 'y', y.axis);
    set_margins(out_, left, bottom, panel_width_, panel_height, height_);
    if (row == 0) {
      out_ << "set arrow from graph 0, first " << knee_efficiency << " to graph 1, first "
           << knee_efficiency << " nohead " << knee_line << " back\n";
    }
    const std::string name = std::to_string(row) + "_" + std::to_string(column) + "_";
    write_points(name, x, y);
    plot(name);
  }

  /// A block a scene, interrupted where nothing was measured, and one for its knee and its default.
  void write_points(const std::string& name, const Measure& x, const Measure& y) {
    for (std::size_t s = 0; s < verdict_.scenes.size(); ++s) {
      const SizeCurve& scene = verdict_.scenes[s];
      const auto line = [&](std::size_t i) {
        const SizePoint& point = scene.points[i];
        const double at = point.was_measured() ? x.figure(point, i) : NAN;
        const double figure = point.was_measured() ? y.figure(point, i) : NAN;
        if (std::isnan(at) || std::isnan(figure)) {
          out_ << "NaN NaN\n";
        } else {
          out_ << x.axis.position(at) << ' ' << y.axis.position(figure) << '\n';
        }
      };
      out_ << "$line" << name << s << " << END\n";
      for (std::size_t i = 0; i < scene.points.size(); ++i) line(i);
      out_ << "END\n$default" << name << s << " << END\n";
      line(verdict_.method.default_value);
      out_ << "END\n$knee" << name << s << " << END\n";
      if (scene.knee) {
        line(*scene.knee);
      } else {
        out_ << "NaN NaN\n";
      }
      out_ << "END\n";
    }
  }

  void plot(const std::string& name) {
    out_ << "plot";
    for (std::size_t s = 0; s < verdict_.scenes.size(); ++s) {
      const Look look = method_look(s);
      out_ << (s == 0 ? " " : ", \\\n  ") << "$line" << name << s
           << " using 1:2 with linespoints notitle pt " << look.shape << " ps 0.7 lw 1.3 lc rgb '"
           << look.colour << "', \\\n  $default" << name << s
           << " using 1:2 with points notitle pt " << dot << " ps 0.5 lc rgb '#000000', \\\n  $knee"
           << name << s << " using 1:2 with points notitle pt " << ring
           << " ps 1.7 lw 1.3 lc rgb '#000000'";
    }
    out_ << '\n';
  }

  const SizeSweep& sweep_;
  const SizeVerdict& verdict_;
  std::ostream& out_;
  std::vector<Measure> columns_, rows_;
  Legend legend_;
  double panel_width_ = 0.0, height_ = 0.0;
};

}  // namespace

std::string size_chart_script(const SizeSweep& sweep, const SizeVerdict& verdict,
                              const std::filesystem::path& file) {
  std::ostringstream script;
  script.precision(12);
  SizeChart(sweep, verdict, script).write(file);
  return script.str();
}

}  // namespace vislab
