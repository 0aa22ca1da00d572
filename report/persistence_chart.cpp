// The chart of the section on how long hidden things stay hidden (persistence_section.h).

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "algorithms/occlusion/persistence.h"
#include "report/chart_legend.h"
#include "report/chart_parts.h"
#include "report/persistence_section.h"

namespace vislab {
namespace {

using namespace chart;

constexpr double left_margin = 62.0, right_margin = 14.0, column_gap = 18.0;
constexpr double panel_height = 150.0, panel_pitch = 206.0;  // with its title and ticks
constexpr double axis_height = 50.0, top_margin = 26.0;
constexpr std::size_t most_in_two_columns = 4;  // panels; more stand in three
constexpr double last_nines = 4.0;              // where shares of 1 are drawn
/// Lines that lie on each other are told apart by moving each a little along the time.
constexpr double sidestep = 0.04;
/// Long times are pooled, first to last, frames: cases get few.
constexpr std::pair<std::size_t, std::size_t> bands[] = {
    {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 6}, {7, 9}, {10, 14}, {15, 21}, {22, 30}};
constexpr const char* formula_style = "dt (6,3) lw 1.6 lc rgb '#333333'";

/// Half as many things appear: as far up everywhere.
double position(double share) {
  return std::min(-std::log10(std::max(1.0 - share, 1e-9)), last_nines);
}

class PersistenceChart {
 public:
  PersistenceChart(const std::vector<PersistenceRow>& rows, std::ostream& out)
      : rows_(rows), out_(out) {
    const bool any = std::ranges::any_of(rows_, has_points);
    for (const PersistenceRow& row : rows_) {
      if (any && !has_points(row)) continue;
      add_new(scenes_, row.scene);
      add_new(paths_, label_of(row));
    }
    std::vector<LegendEntry> entries;
    for (const std::string& path : paths_) {
      entries.push_back(symbol_entry(path, method_look(entries.size()), 0.8));
    }
    entries.push_back(line_entry("0.99 − 0.7 exp(−t)", formula_style));
    legend_ = Legend(std::move(entries));
  }

  void write(const std::filesystem::path& file) {
    columns_ = std::min<std::size_t>(scenes_.size(), scenes_.size() > most_in_two_columns ? 3 : 2);
    const std::size_t columns = std::max<std::size_t>(columns_, 1);
    const std::size_t lines = (scenes_.size() + columns - 1) / columns;
    const double bottom = legend_.height() + axis_height;
    height_ = bottom + static_cast<double>(lines - 1) * panel_pitch + panel_height + top_margin;
    const double gaps = static_cast<double>(columns - 1) * column_gap;
    const double width = (chart_width - left_margin - right_margin - gaps) / columns;
    start_chart(out_, file, height_);
    write_points();
    for (std::size_t s = 0; s < scenes_.size(); ++s) {
      const std::size_t column = s % columns;
      const std::size_t line = s / columns;
      // The lowest panel of a column bears the title of its axis.
      write_panel(s, left_margin + static_cast<double>(column) * (width + column_gap),
                  bottom + static_cast<double>(lines - 1 - line) * panel_pitch, width, column == 0,
                  s + columns >= scenes_.size());
    }
    legend_.write(out_, height_);
    end_chart(out_);
  }

 private:
  static void add_new(std::vector<std::string>& list, const std::string& text) {
    if (std::ranges::find(list, text) == list.end()) list.push_back(text);
  }

  static bool has_points(const PersistenceRow& row) {
    return std::ranges::any_of(bands, [&](const auto& band) {
      return pooled(row.counts.after, band.first, band.second).cases >= least_persistence_cases;
    });
  }

  /// Paths that are named after their scene are the same line in all panels.
  static std::string label_of(const PersistenceRow& row) {
    const std::string prefix = row.scene + "_";
    return row.path.starts_with(prefix) ? row.path.substr(prefix.size()) : row.path;
  }

  std::size_t look_of(const PersistenceRow& row) const {
    return static_cast<std::size_t>(std::ranges::find(paths_, label_of(row)) - paths_.begin());
  }

  /// The row's place among those of its scene, counted from their middle.
  double place_in_panel(std::size_t row) const {
    double before = 0.0;
    double others = 0.0;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      if (r == row || rows_[r].scene != rows_[row].scene || !has_points(rows_[r])) continue;
      before += r < row ? 1.0 : 0.0;
      others += 1.0;
    }
    return before - 0.5 * others;
  }

  void write_points() {
    out_ << "$formula << END\n";
    for (std::uint32_t t = 1; t <= PersistenceCounter::last_time; ++t) {
      out_ << std::log2(t) << ' ' << position(occlusion_culling::Persistence::formula(t)) << '\n';
    }
    out_ << "END\n";
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const double step = sidestep * place_in_panel(r);
      out_ << "$row" << r << " << END\n";
      for (const auto& [first, last] : bands) {
        const StillHidden still = pooled(rows_[r].counts.after, first, last);
        if (still.cases < least_persistence_cases) continue;
        const Estimate share = still.share();
        out_ << 0.5 * std::log2(first * last) + step << ' ' << position(share.value) << ' '
             << position(share.low) << ' ' << position(share.high) << '\n';
      }
      // A data block may not be empty.
      out_ << "NaN NaN NaN NaN\nEND\n";
    }
  }

  static StillHidden pooled(const std::vector<StillHidden>& after, std::size_t first,
                            std::size_t last) {
    StillHidden sum;
    for (std::size_t t = first; t <= last; ++t) {
      sum.cases += after[t].cases;
      sum.hidden += after[t].hidden;
    }
    return sum;
  }

  void write_panel(std::size_t scene, double left, double bottom, double width, bool first,
                   bool last) {
    out_ << "unset label\nunset arrow\nunset object\nset border 3 lc rgb '#444444'\n"
         << "set tics nomirror out scale 0.5\nset errorbars 0\nset grid xtics ytics lt 1 lw 0.5 lc "
            "rgb '#E4E4E4'\n"
         << "unset ylabel\nset title " << quoted(scenes_[scene]) << " offset 0,-0.7\n";
    if (last) {
      out_ << "set xlabel 't: frames hidden in a row' offset 0,0.5\n";
    } else {
      out_ << "unset xlabel\n";
    }
    if (first) {
      out_ << "set label 'p(t): still hidden' at screen " << 12.0 / chart_width << ','
           << (bottom + 0.5 * panel_height) / height_ << " center rotate by 90\n";
    }
    ChartAxis x;
    x.low = -0.2;
    x.high = 5.0;
    for (const int t : columns_ < 3 ? std::vector{1, 2, 3, 4, 6, 8, 12, 16, 30}
                                    : std::vector{1, 2, 4, 8, 16, 30}) {
      x.ticks.emplace_back(std::log2(t), std::to_string(t));
    }
    set_axis(out_, 'x', x);
    ChartAxis y;
    y.low = 0.0;
    y.high = last_nines + 0.2;
    for (const auto& [share, text] :
         {std::pair{0.0, "0"}, std::pair{0.5, "0.5"}, std::pair{0.8, "0.8"}, std::pair{0.9, "0.9"},
          std::pair{0.95, "0.95"}, std::pair{0.99, "0.99"}, std::pair{0.999, "0.999"},
          std::pair{1.0, "1"}}) {
      y.ticks.emplace_back(position(share), first ? text : "");
    }
    set_axis(out_, 'y', y);
    set_margins(out_, left, bottom, width, panel_height, height_);
    out_ << "plot $formula using 1:2 with lines " << formula_style << " notitle";
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      if (rows_[r].scene != scenes_[scene]) continue;
      const Look look = method_look(look_of(rows_[r]));
      out_ << ", \\\n  $row" << r << " using 1:2:3:4 with yerrorlines notitle pt " << look.shape
           << " ps 0.6 lw 1.1 lc rgb '" << look.colour << "'";
    }
    out_ << '\n';
  }

  const std::vector<PersistenceRow>& rows_;
  std::ostream& out_;
  std::vector<std::string> scenes_;
  std::vector<std::string> paths_;
  std::size_t columns_ = 0;
  Legend legend_;
  double height_ = 0.0;
};

}  // namespace

std::string persistence_chart_script(const std::vector<PersistenceRow>& rows,
                                     const std::filesystem::path& file) {
  std::ostringstream out;
  PersistenceChart(rows, out).write(file);
  return out.str();
}

}  // namespace vislab
