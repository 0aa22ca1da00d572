#include "report/sweep_chart.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/judge/metrics.h"
#include "report/chart_legend.h"
#include "report/chart_parts.h"
#include "report/format.h"

namespace vislab {
namespace {

using namespace chart;

constexpr double panel_left = 92.0, panel_width = 568.0;
constexpr std::size_t most_in_low_panel = 7;  // lines
constexpr double low_panel = 150.0, high_panel = 210.0;
constexpr double y_title_left = 10.0;
constexpr double axis_height = 50.0;  // tick labels and title below the panel
constexpr double top_margin = 10.0;
constexpr double digit_width = 6.5, tick_gap = 8.0;  // of tick labels
constexpr double rounding = 1e-9;                    // of the largest figure
/// Lines that lie on each other are told apart by moving each a little along the dial.
constexpr double sidestep = 0.024;  // of the distance between two values
constexpr const char* limit_style = "dt (2,4) lw 1.2 lc rgb '#777777'";
constexpr const char* zero_band_colour = "#EEF2F6";
constexpr int ring = 6;

/// The unit of a metric whose name does not say it; "" of a share or a number of things.
std::string unit_beside(const std::string& metric) {
  for (const std::string_view said : {"_px", "_ms", "_us", "bytes"}) {
    if (metric.ends_with(said)) return {};
  }
  for (const Metric& known : metrics()) {
    if (known.name != metric) continue;
    if (known.unit == "count" || known.unit == "ratio") return {};
    return std::string(known.unit);
  }
  return {};
}

class SweepChart {
 public:
  SweepChart(const SweepResult& result, std::ostream& out) : result_(result), out_(out) {
    std::vector<double> figures;
    double most = 0.0;
    std::vector<LegendEntry> entries;
    for (const SweepVerdict& verdict : result.verdicts) {
      entries.push_back(symbol_entry(verdict.culler, method_look(entries.size()), 0.8));
      for (const SweepPoint& point : verdict.points) {
        if (!std::isnan(point.figure)) most = std::max(most, point.figure);
      }
    }
    if (std::ranges::any_of(result.verdicts, has_ring)) {
      entries.push_back(symbol_entry("ring: break point", Look{"#000000", ring}, 1.5));
    }
    common_limit_ = common_limit();
    if (common_limit_ > 0.0) {
      figures.push_back(common_limit_);
      entries.push_back(line_entry("limit", limit_style));
      most = std::max(most, common_limit_);
    }
    least_shown_ = rounding * most;
    for (const SweepVerdict& verdict : result.verdicts) {
      for (const SweepPoint& point : verdict.points) {
        if (!std::isnan(point.figure)) figures.push_back(shown(point.figure));
      }
    }
    const bool has_zero = std::ranges::count(figures, 0.0) > 0;
    if (!(most > 0.0)) {
      axis_ = zero_axis();
    } else {
      axis_ = has_zero ? logarithmic_axis(figures, most, "0") : positive_axis(figures);
    }
    legend_ = Legend(std::move(entries));
  }

  void write(const std::filesystem::path& file) {
    const double bottom = legend_.height() + axis_height;
    panel_height_ = has_many_lines(result_) ? high_panel : low_panel;
    height_ = bottom + panel_height_ + top_margin;
    start_chart(out_, file, height_);
    write_panel(bottom);
    legend_.write(out_, height_);
    end_chart(out_);
  }

 private:
  /// The limit, if it is the same for all methods; else 0.
  double common_limit() const {
    double limit = 0.0;
    for (const SweepVerdict& verdict : result_.verdicts) {
      if (!verdict.was_measured()) continue;
      if (std::isnan(verdict.limit) || (limit > 0.0 && verdict.limit != limit)) return 0.0;
      limit = verdict.limit;
    }
    return limit;
  }

  /// Short: the text beside the chart says what ratios are to.
  std::string y_title() const {
    const SweepLimit& limit = result_.sweep.limit;
    if (limit.against) return limit.metric + ", ratio";
    const std::string unit = limit.is_counter ? "" : unit_beside(limit.metric);
    return result_.sweep.figure_name() + (unit.empty() ? "" : " (" + unit + ")");
  }

  /// How many values apart the labels stand, so that labels do not run into each other.
  static std::size_t values_per_label(const SweepDial& dial) {
    std::size_t longest = 0;
    for (const std::string& text : dial.texts) {
      longest = std::max(longest, letters_of(format_written(text)));
    }
    const double room = panel_width / static_cast<double>(dial.texts.size());
    const double needed = digit_width * static_cast<double>(longest) + tick_gap;
    const auto least = static_cast<std::size_t>(std::ceil(needed / room));
    for (const std::size_t round : {1, 2, 5, 10, 20, 50}) {
      if (round >= least) return round;
    }
    return least;
  }

  void write_panel(double bottom) {
    const SweepDial& dial = result_.sweep.dial;
    const auto values = static_cast<double>(dial.values.size());
    out_ << "unset label\nunset arrow\nunset object\nset border 3 lc rgb '#444444'\n"
         << "set tics nomirror out scale 0.5\nset grid xtics ytics lt 1 lw 0.5 lc rgb '#E4E4E4'\n"
         << "unset title\nunset ylabel\nset xlabel "
         << quoted(dial.name + (dial.unit.empty() ? "" : " (" + dial.unit + ")"))
         << " offset 0,0.5\nset label " << quoted(y_title()) << " at screen "
         << y_title_left / chart_width << ',' << (bottom + 0.5 * panel_height_) / height_
         << " center rotate by 90\n";
    ChartAxis x;
    x.low = -0.5;
    x.high = values - 0.5;
    for (std::size_t i = 0; i < dial.texts.size(); i += values_per_label(dial)) {
      x.ticks.emplace_back(static_cast<double>(i), format_written(dial.texts[i]));
    }
    set_axis(out_, 'x', x);
    set_axis(out_, 'y', axis_);
    set_margins(out_, panel_left, bottom, panel_width, panel_height_, height_);
    if (axis_.logarithmic && axis_.zero_band_top > 0.0) {
      out_ << "set object rectangle from graph 0, graph 0 to graph 1, first " << axis_.zero_band_top
           << " fc rgb '" << zero_band_colour << "' fs solid noborder behind\n";
    }
    if (common_limit_ > 0.0) {
      out_ << "set arrow from graph 0, first " << axis_.position(common_limit_)
           << " to graph 1, first " << axis_.position(common_limit_) << " nohead " << limit_style
           << " back\n";
    }
    write_points();
    plot(" using 1:2 with linespoints");
  }

  /// One data block a method; values without a figure interrupt the line.
  void write_points() {
    const auto methods = static_cast<double>(result_.verdicts.size());
    for (std::size_t m = 0; m < result_.verdicts.size(); ++m) {
      const SweepVerdict& verdict = result_.verdicts[m];
      const double step = sidestep * (static_cast<double>(m) - 0.5 * (methods - 1.0));
      const auto row = [&](std::size_t i, double figure) {
        out_ << static_cast<double>(i) + step << ' ';
        if (std::isnan(figure)) {
          out_ << "NaN\n";
        } else {
          out_ << axis_.position(shown(figure)) << '\n';
        }
      };
      out_ << "$method" << m << " << END\n";
      for (std::size_t i = 0; i < verdict.points.size(); ++i) row(i, verdict.points[i].figure);
      out_ << "END\n";
      if (!has_ring(verdict)) continue;
      out_ << "$break" << m << " << END\n";
      row(*verdict.break_point, verdict.points[*verdict.break_point].figure);
      out_ << "END\n";
    }
  }

  /// What is left of a difference of equal numbers is zero.
  double shown(double figure) const { return figure < least_shown_ ? 0.0 : figure; }

  static bool has_ring(const SweepVerdict& verdict) {
    return verdict.break_point && !std::isnan(verdict.points[*verdict.break_point].figure);
  }

  void plot(const std::string& how) {
    out_ << "plot";
    for (std::size_t m = 0; m < result_.verdicts.size(); ++m) {
      const Look look = method_look(m);
      out_ << (m == 0 ? " " : ", \\\n  ") << "$method" << m << how << " notitle pt " << look.shape
           << " ps 0.8 lw 1.3 lc rgb '" << look.colour << "'";
      if (!has_ring(result_.verdicts[m])) continue;
      out_ << ", \\\n  $break" << m << " using 1:2 with points notitle pt " << ring
           << " ps 1.9 lw 1.3 lc rgb '#000000'";
    }
    out_ << '\n';
  }

  const SweepResult& result_;
  std::ostream& out_;
  double common_limit_ = 0.0, least_shown_ = 0.0;
  ChartAxis axis_;
  Legend legend_;
  double height_ = 0.0, panel_height_ = 0.0;
};

}  // namespace

bool has_sweep_chart(const SweepResult& result) {
  return std::ranges::any_of(result.verdicts,
                             [](const SweepVerdict& verdict) { return verdict.worst.has_value(); });
}

bool has_many_lines(const SweepResult& result) {
  return result.verdicts.size() > most_in_low_panel;
}

std::string sweep_chart_script(const SweepResult& result, const std::filesystem::path& file) {
  std::ostringstream script;
  script.precision(12);
  SweepChart(result, script).write(file);
  return script.str();
}

}  // namespace vislab
