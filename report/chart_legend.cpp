#include "report/chart_legend.h"

#include <algorithm>
#include <ostream>
#include <sstream>
#include <utility>

namespace vislab::chart {
namespace {

constexpr double row_height = 14.0;
constexpr double indent = 14.0;
constexpr double sign_width = 18.0;
constexpr double text_left = 24.0;  // from the left of an entry's sign
constexpr double field_height = 10.0;
constexpr double letter_width = 5.6;  // mean
constexpr double column_gap = 18.0;

}  // namespace

LegendEntry symbol_entry(std::string text, Look look, double size) {
  LegendEntry entry;
  entry.text = std::move(text);
  entry.look = std::move(look);
  entry.symbol_size = size;
  return entry;
}

LegendEntry line_entry(std::string text, std::string style) {
  LegendEntry entry;
  entry.text = std::move(text);
  entry.line = std::move(style);
  return entry;
}

Legend::Legend(std::vector<LegendEntry> entries) : entries_(std::move(entries)) {
  while (rows_ < entries_.size() && !fits(++rows_)) {
  }
}

/// Sets the columns' places.
bool Legend::fits(std::size_t rows) {
  column_left_.clear();
  double right = indent;
  for (std::size_t first = 0; first < entries_.size(); first += rows) {
    column_left_.push_back(right);
    std::size_t longest = 0;
    for (std::size_t i = first; i < std::min(first + rows, entries_.size()); ++i) {
      longest = std::max(longest, entries_[i].text.size());
    }
    right += text_left + letter_width * static_cast<double>(longest) + column_gap;
  }
  return right - column_gap <= chart_width;
}

double Legend::height() const { return static_cast<double>(rows_) * row_height; }

void Legend::write(std::ostream& out, double chart_height) const {
  out << "unset label\nunset arrow\nunset object\nunset title\nunset xlabel\nunset ylabel\n"
      << "unset border\nunset tics\nunset grid\nunset logscale\nset xrange [0:" << chart_width
      << "]\nset yrange [0:" << height() << "]\n";
  set_margins(out, 0.0, 0.0, chart_width, height(), chart_height);
  std::ostringstream places, plots;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const LegendEntry& entry = entries_[i];
    const double left = column_left_[i / rows_];
    const double middle = height() - row_height * (0.5 + static_cast<double>(i % rows_));
    const double right = left + sign_width;
    out << "set label " << quoted(entry.text) << " at first " << left + text_left << ',' << middle
        << " left font ',10.5'\n";
    if (!entry.field.empty()) {
      out << "set object rectangle from first " << left << ',' << middle - 0.5 * field_height
          << " to first " << right << ',' << middle + 0.5 * field_height << " fc rgb '"
          << entry.field << "' fs solid noborder\n";
    }
    if (!entry.line.empty()) {
      out << "set arrow from first " << left << ',' << middle << " to first " << right << ','
          << middle << " nohead " << entry.line << '\n';
    }
    places << 0.5 * (left + right) << ' ' << middle << '\n';
    if (entry.symbol_size > 0.0) {
      plots << (plots.view().empty() ? " " : ", \\\n  ") << "$legend every ::" << i << "::" << i
            << " using 1:2 with points notitle pt " << entry.look.shape << " ps "
            << entry.symbol_size << " lw 1.3 lc rgb '" << entry.look.colour << "'";
    }
  }
  out << "$legend << END\n"
      << places.view() << "END\nplot" << (plots.view().empty() ? " NaN notitle" : plots.view())
      << '\n';
}

}  // namespace vislab::chart
