#include "report/chart_parts.h"

#include <algorithm>
#include <array>
#include <sstream>

namespace vislab::chart {
namespace {

constexpr double legend_row = 14.0;
constexpr double legend_indent = 14.0;
constexpr double legend_letter = 5.6;  // mean width of a letter
constexpr double legend_gap = 18.0;    // between columns

/// Okabe's and Ito's, without yellow, which fades on white.
constexpr std::array<const char*, 6> colours{"#0072B2", "#D55E00", "#009E73",
                                             "#CC79A7", "#E69F00", "#56B4E9"};
/// gnuplot's filled circle, square, triangles, diamond and pentagon.
constexpr std::array<int, 6> shapes{7, 5, 9, 13, 11, 15};

std::string ticks(const ChartAxis& axis) {
  std::string list;
  for (const auto& [position, label] : axis.ticks) {
    std::ostringstream entry;
    entry << quoted(label) << ' ' << position;
    list += (list.empty() ? "" : ", ") + entry.str();
  }
  return "(" + list + ")";
}

}  // namespace

Look method_look(std::size_t method) {
  // Shapes go on by one more after each turn of the colours, so that pairs do not repeat soon.
  const std::size_t turn = method / colours.size();
  return {colours[method % colours.size()], shapes[(method + turn) % shapes.size()]};
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '\n') {
      result += "\\n";
      continue;
    }
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

double Legend::height() const { return static_cast<double>(rows) * legend_row; }

double Legend::middle(std::size_t entry) const {
  return height() - legend_row * (0.5 + static_cast<double>(entry % rows));
}

Legend legend_for(const std::vector<std::string>& texts) {
  Legend legend;
  for (legend.rows = 1; legend.rows <= texts.size(); ++legend.rows) {
    legend.column_left.clear();
    double right = legend_indent;
    for (std::size_t first = 0; first < texts.size(); first += legend.rows) {
      legend.column_left.push_back(right);
      std::size_t longest = 0;
      for (std::size_t i = first; i < std::min(first + legend.rows, texts.size()); ++i) {
        longest = std::max(longest, texts[i].size());
      }
      right += legend_text_left + legend_letter * static_cast<double>(longest) + legend_gap;
    }
    if (right - legend_gap <= chart_width) break;
  }
  legend.rows = std::min(legend.rows, texts.size());
  return legend;
}

void set_axis(std::ostream& out, char name, const ChartAxis& axis) {
  out << (axis.logarithmic ? "set logscale " : "unset logscale ") << name << '\n'
      << "set " << name << "range [" << axis.low << ':' << axis.high << "]\n"
      << "set " << name << "tics " << ticks(axis) << '\n';
}

void set_margins(std::ostream& out, double left, double bottom, double width, double height,
                 double chart_height) {
  out << "set lmargin at screen " << left / chart_width << '\n'
      << "set rmargin at screen " << (left + width) / chart_width << '\n'
      << "set bmargin at screen " << bottom / chart_height << '\n'
      << "set tmargin at screen " << (bottom + height) / chart_height << '\n';
}

}  // namespace vislab::chart
