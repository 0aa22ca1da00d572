#include "report/chart_parts.h"

#include <array>
#include <sstream>

namespace vislab::chart {
namespace {

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

void set_axis(std::ostream& out, char name, const ChartAxis& axis) {
  out << (axis.logarithmic ? "set logscale " : "unset logscale ") << name << '\n'
      << "set " << name << "range [" << axis.low << ':' << axis.high << "]\n"
      << "set " << name << "tics " << ticks(axis) << '\n';
}

void start_chart(std::ostream& out, const std::filesystem::path& file, double height) {
  out << "reset\nunset key\nset terminal svg size " << chart_width << ',' << height
      << " noenhanced font 'Noto Sans,11' background '#FFFFFF'\nset output "
      << quoted(file.string()) << "\nset multiplot\n";
}

void end_chart(std::ostream& out) { out << "unset multiplot\nunset output\n"; }

void set_margins(std::ostream& out, double left, double bottom, double width, double height,
                 double chart_height) {
  out << "set lmargin at screen " << left / chart_width << '\n'
      << "set rmargin at screen " << (left + width) / chart_width << '\n'
      << "set bmargin at screen " << bottom / chart_height << '\n'
      << "set tmargin at screen " << (bottom + height) / chart_height << '\n';
}

}  // namespace vislab::chart
