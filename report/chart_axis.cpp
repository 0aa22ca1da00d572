#include "report/chart_axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "report/format.h"

namespace vislab {
namespace {

constexpr double widest_linear_ratio = 6.0;
constexpr int wanted_ticks = 6;

/// "10⁻⁴", "0.5", "20", "1,000": no more digits than a round number needs.
std::string tick_label(double value) {
  if (value >= 1.0) {
    const double tenths = std::round(10.0 * value) / 10.0;
    if (tenths == std::round(tenths)) return format_count(static_cast<std::uint64_t>(tenths));
  }
  if (value > 0.0 && value < 0.001) {
    std::array<char, 32> shortest{};
    std::snprintf(shortest.data(), shortest.size(), "%.1e", value);
    std::string label = shortest.data();
    if (label[2] == '0') label.erase(1, 2);  // "5.0e-05"
    return format_written(label);
  }
  std::string label = format_number(value);
  if (label.find('.') != std::string::npos) {
    while (label.ends_with('0')) label.pop_back();
    if (label.ends_with('.')) label.pop_back();
  }
  return label;
}

double decade_below(double value) { return std::pow(10.0, std::floor(std::log10(value) + 1e-9)); }

/// 1, 2, 5 or 10 times a power of ten, at least `value`.
double round_up(double value) {
  const double decade = decade_below(value);
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= value * (1.0 - 1e-9)) return factor * decade;
  }
  return 10.0 * decade;
}

/// Ticks at 1, 2 and 5 times the powers of ten, or at the powers only when those are many.
void add_logarithmic_ticks(ChartAxis& axis, double from) {
  const double decades = std::log10(axis.high / from);
  const int step = static_cast<int>(std::ceil(decades / wanted_ticks));
  const auto first = static_cast<int>(std::floor(std::log10(from) + 1e-9));
  const auto last = static_cast<int>(std::ceil(std::log10(axis.high) - 1e-9));
  for (int exponent = first; exponent <= last; exponent += std::max(1, step)) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor != 1.0 && decades > 2.0) continue;
      const double tick = factor * std::pow(10.0, exponent);
      const bool inside = tick >= from * (1.0 - 1e-9) && tick <= axis.high * (1.0 + 1e-9);
      if (inside) axis.ticks.emplace_back(tick, tick_label(tick));
    }
  }
}

}  // namespace

double ChartAxis::position(double value) const {
  return logarithmic && !(value > 0.0) ? zero : value;
}

double ChartAxis::share(double value) const {
  const double at = position(value);
  if (logarithmic) return std::log(at / low) / std::log(high / low);
  return (at - low) / (high - low);
}

ChartAxis zero_axis() {
  ChartAxis axis;
  axis.low = -0.08;
  axis.high = 1.0;
  axis.ticks = {{0.0, "0"}, {1.0, "1"}};
  return axis;
}

ChartAxis positive_axis(const std::vector<double>& values) {
  ChartAxis axis;
  double least = 0.0;
  double most = 0.0;
  for (const double value : values) {
    if (!(value > 0.0)) continue;
    least = least > 0.0 ? std::min(least, value) : value;
    most = std::max(most, value);
  }
  if (!(most > 0.0)) return axis;
  if (most > widest_linear_ratio * least) {
    axis.logarithmic = true;
    axis.low = axis.zero = least / 1.3;
    axis.high = most * 1.3;
    add_logarithmic_ticks(axis, axis.low);
    return axis;
  }
  const double step = round_up(most / wanted_ticks);
  axis.high = most * 1.08;
  for (int i = 0; i * step <= axis.high; ++i) {
    axis.ticks.emplace_back(i * step, i == 0 ? "0" : tick_label(i * step));
  }
  return axis;
}

ChartAxis logarithmic_axis(const std::vector<double>& values, double least_high,
                           const std::string& zero_label) {
  ChartAxis axis;
  axis.logarithmic = true;
  double least = least_high / 10.0;
  double most = least_high;
  for (const double value : values) {
    if (!(value > 0.0)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  const double from = decade_below(least);
  // Room for the zero below the lowest decade, in proportion to the axis, and for marks around it.
  const double gap = std::pow(10.0, std::max(0.3, 0.14 * std::log10(most / from)));
  axis.zero = from / gap;
  axis.low = axis.zero / std::sqrt(gap);
  axis.zero_band_top = axis.zero * std::sqrt(gap);
  axis.high = most * std::sqrt(gap);
  axis.ticks.emplace_back(axis.zero, zero_label);
  add_logarithmic_ticks(axis, from);
  return axis;
}

}  // namespace vislab
