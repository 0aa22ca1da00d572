#include "report/main_chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "experiments/analysis/chains.h"
#include "report/chart_legend.h"
#include "report/chart_parts.h"

namespace vislab {
namespace {

using namespace chart;

constexpr std::array<double, 2> panel_left{92.0, 414.0};
constexpr double panel_width = 256.0, panel_height = 190.0;
constexpr std::array<double, 2> y_title_distance{82.0, 46.0};  // from the panel's left
constexpr double axis_height = 50.0;                           // tick labels and title
constexpr double top_margin = 24.0;
constexpr double per_million = 1e6;
constexpr const char* zero_band_colour = "#EEF2F6";
constexpr const char* none_style = "dt (2,4) lw 1.2 lc rgb '#777777'";
constexpr const char* wrong_colour = "#B8B8B8";
constexpr int wrong_shape = 2, oracle_shape = 6;  // gnuplot's cross and open circle

struct Point {
  double ratio = 0.0;              // frame_ms ÷ that of none
  std::array<double, 2> errors{};  // false pixels a million; over
};

struct Series {
  std::string name;
  Look look;
  std::vector<Point> points;
};

bool is_comparable(const BlockSummary& block) {
  return block.drawn && is_of_one_machine(block) && block.device_models.empty();
}

bool is_shown(const CellSummary& cell) {
  const bool is_none = cell.anchor && cell.canonical == "none";
  return cell.judged && cell.pixels > 0 && cell.against_none.measured() && !is_none && !cell.paints;
}

Point point_of(const CellSummary& cell) {
  const double share = static_cast<double>(cell.false_px) / static_cast<double>(cell.pixels);
  return {cell.against_none.value, {per_million * share, std::isnan(cell.over) ? 0.0 : cell.over}};
}

/// What is wrong on purpose first, so that it lies below the others; the oracles last.
std::vector<Series> series_of(const std::vector<BlockSummary>& blocks) {
  std::map<std::string, Series> families;
  Series wrong{"wrong on purpose", {wrong_colour, wrong_shape}, {}};
  Series oracles{"oracle: knows the answer", {"#000000", oracle_shape}, {}};
  for (const BlockSummary& block : blocks) {
    if (!is_comparable(block)) continue;
    for (const CellSummary& cell : block.cells) {
      if (!is_shown(cell)) continue;
      const bool is_wrong = cell.guarantee == Guarantee::erroneous;
      Series& series = cell.anchor ? oracles
                       : is_wrong  ? wrong
                                   : families[family_of_chain(cell.canonical)];
      series.points.push_back(point_of(cell));
    }
  }
  std::vector<Series> all{std::move(wrong)};
  std::size_t next = 0;
  for (auto& [name, series] : families) {
    series.name = name == "chain" ? "chains of several" : name;
    series.look = method_look(next++);
    all.push_back(std::move(series));
  }
  all.push_back(std::move(oracles));
  std::erase_if(all, [](const Series& series) { return series.points.empty(); });
  return all;
}

class MainChart {
 public:
  explicit MainChart(const std::vector<BlockSummary>& blocks) : series_(series_of(blocks)) {
    std::vector<double> ratios{1.0};
    std::array<std::vector<double>, 2> errors;
    std::vector<LegendEntry> entries;
    for (const Series& series : series_) {
      for (const Point& point : series.points) {
        ratios.push_back(point.ratio);
        for (std::size_t i = 0; i < 2; ++i) errors[i].push_back(point.errors[i]);
      }
      entries.push_back(symbol_entry(series.name, series.look, 0.9));
    }
    entries.push_back(line_entry("time of drawing everything", none_style));
    legend_ = Legend(std::move(entries));
    x_axis_ = positive_axis(ratios);
    y_axes_ = {logarithmic_axis(errors[0], 10.0, "0"), logarithmic_axis(errors[1], 1.0, "0")};
    bottom_ = legend_.height() + axis_height;
    height_ = bottom_ + panel_height + top_margin;
  }

  void write(const std::filesystem::path& file, std::ostream& out) const {
    start_chart(out, file, height_);
    for (std::size_t i = 0; i < series_.size(); ++i) {
      out << "$series" << i << " << END\n";
      for (const Point& point : series_[i].points) {
        out << point.ratio << ' ' << y_axes_[0].position(point.errors[0]) << ' '
            << y_axes_[1].position(point.errors[1]) << '\n';
      }
      out << "END\n";
    }
    for (std::size_t panel = 0; panel < 2; ++panel) write_panel(panel, out);
    legend_.write(out, height_);
    end_chart(out);
  }

 private:
  void write_panel(std::size_t panel, std::ostream& out) const {
    constexpr std::array titles{"a   Errors", "b   Over-inclusion"};
    constexpr std::array y_titles{"false pixels in a million",
                                  "kept but invisible ÷ visible (over)"};
    const ChartAxis& y_axis = y_axes_[panel];
    out << "unset label\nunset arrow\nunset object\nset border 3 lc rgb '#444444'\n"
        << "set tics nomirror out scale 0.5\nset grid xtics ytics lt 1 lw 0.5 lc rgb '#E4E4E4'\n"
        << "set title " << quoted(titles[panel]) << " offset 0,-0.6 font ',12'\nunset ylabel\n"
        << "set xlabel " << quoted("time of a frame ÷ that of drawing everything")
        << " offset 0,0.5\n"
        << "set label " << quoted(y_titles[panel]) << " at screen "
        << (panel_left[panel] - y_title_distance[panel]) / chart_width << ','
        << (bottom_ + 0.5 * panel_height) / height_ << " center rotate by 90\n";
    set_axis(out, 'x', x_axis_);
    set_axis(out, 'y', y_axis);
    set_margins(out, panel_left[panel], bottom_, panel_width, panel_height, height_);
    // Zero has no place on a logarithmic axis: a band sets it apart.
    out << "set object rectangle from graph 0, graph 0 to graph 1, first " << y_axis.zero_band_top
        << " fc rgb '" << zero_band_colour << "' fs solid noborder behind\n"
        << "set arrow from first 1, graph 0 to first 1, graph 1 nohead " << none_style
        << " back\nplot";
    for (std::size_t i = 0; i < series_.size(); ++i) {
      out << (i == 0 ? " " : ", \\\n  ") << "$series" << i << " using 1:" << panel + 2
          << " with points notitle pt " << series_[i].look.shape << " ps 0.6 lw 1.2 lc rgb '"
          << series_[i].look.colour << "'";
    }
    out << '\n';
  }

  std::vector<Series> series_;
  Legend legend_;
  ChartAxis x_axis_;
  std::array<ChartAxis, 2> y_axes_;
  double bottom_ = 0.0, height_ = 0.0;
};

}  // namespace

bool has_main_chart(const std::vector<BlockSummary>& blocks) {
  return std::ranges::any_of(blocks, [](const BlockSummary& block) {
    return is_comparable(block) && std::ranges::any_of(block.cells, [](const CellSummary& cell) {
             return is_shown(cell) && !cell.anchor;
           });
  });
}

std::string main_chart_script(const std::vector<BlockSummary>& blocks,
                              const std::filesystem::path& file) {
  std::ostringstream out;
  out.precision(12);
  MainChart(blocks).write(file, out);
  return out.str();
}

}  // namespace vislab
