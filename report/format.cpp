#include "report/format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>

namespace vislab {
namespace {

constexpr const char* no_value = "–";
constexpr const char* narrow_gap = "\u202F";  // between number and unit; lines do not break there

std::string fixed(double value, int decimals) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.*f", decimals, value);
  return buffer.data();
}

constexpr int most_decimals = 4;

/// Decimals that show three significant digits of the value.
int decimals_for(double value, int most = most_decimals) {
  if (value == 0.0) return 0;
  const int magnitude = static_cast<int>(std::floor(std::log10(std::fabs(value)) + 1e-9));
  return std::clamp(2 - magnitude, 0, most);
}

std::string separate_thousands(std::string digits) {
  const std::size_t point = std::min(digits.find('.'), digits.size());
  const std::size_t first = digits.starts_with('-') ? 1 : 0;
  for (std::size_t at = point; at > first + 3; at -= 3) digits.insert(at - 3, 1, ',');
  return digits;
}

std::string with_decimals(double value, int decimals) {
  return std::isnan(value) ? no_value : separate_thousands(fixed(value, decimals));
}

}  // namespace

std::string format_count(std::uint64_t count) { return separate_thousands(std::to_string(count)); }

std::string format_number(double value) {
  if (!std::isfinite(value)) return no_value;
  if (value > 0.0 && value < 0.00005) return std::string("<") + narrow_gap + "0.0001";
  return with_decimals(value, decimals_for(value));
}

std::string format_apart(double value, double other) {
  if (!std::isfinite(value) || value == other) return format_number(value);
  constexpr int most = 8;
  int decimals = decimals_for(value);
  while (decimals < most && with_decimals(value, decimals) == with_decimals(other, decimals)) {
    ++decimals;
  }
  return decimals == decimals_for(value) ? format_number(value) : with_decimals(value, decimals);
}

std::string format_rounded(double value) {
  if (!std::isfinite(value) || std::fabs(value) < 1000.0) return format_number(value);
  const double unit = std::pow(10.0, std::floor(std::log10(std::fabs(value))) - 2.0);
  return format_number(std::round(value / unit) * unit);
}

std::string format_estimate(const Estimate& estimate) {
  if (!estimate.measured()) return no_value;
  // Two digits of the interval's width, so that a narrow one is not rounded away.
  const double width = estimate.high - estimate.low;
  const int decimals =
      std::max(decimals_for(estimate.value), width > 0.0 ? decimals_for(width) - 1 : 0);
  return with_decimals(estimate.value, decimals) + " (" + with_decimals(estimate.low, decimals) +
         "–" + with_decimals(estimate.high, decimals) + ")";
}

std::string format_percent(double share) {
  if (!std::isfinite(share)) return no_value;
  const double percent = 100.0 * share;
  const double size = std::fabs(percent);
  const int decimals = size >= 9.95 || size == 0.0 ? 0 : std::max(1, decimals_for(percent, 7) - 1);
  return fixed(percent, decimals) + narrow_gap + "%";
}

std::string format_percents(double low, double high) {
  return fixed(100.0 * low, 1) + "–" + fixed(100.0 * high, 1) + narrow_gap + "%";
}

std::string format_of(std::uint64_t part, std::uint64_t whole) {
  return format_count(part) + " of " + format_count(whole);
}

std::string format_bytes(std::uint64_t bytes) {
  constexpr std::array units{"kB", "MB", "GB", "TB"};
  if (bytes < 1000) return std::to_string(bytes) + narrow_gap + "B";
  auto value = static_cast<double>(bytes) / 1000.0;
  std::size_t unit = 0;
  for (; value >= 1000.0 && unit + 1 < units.size(); ++unit) value /= 1000.0;
  return format_number(value) + narrow_gap + units[unit];
}

std::string format_scientific(double value) {
  if (!(value > 0.0)) return format_number(value);
  const int exponent = static_cast<int>(std::floor(std::log10(value)));
  const std::string sign = exponent < 0 ? "−" : "";
  return fixed(value / std::pow(10.0, exponent), 1) + " × 10^" + sign +
         std::to_string(std::abs(exponent)) + "^";
}

std::string format_written(std::string_view number) {
  constexpr std::array digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  const std::size_t e = number.find('e');
  if (e == 0 || e == std::string_view::npos) return std::string(number);
  std::string exponent;
  for (const char c : number.substr(e + 1)) {
    if (c == '-') {
      exponent += "⁻";
    } else if (std::isdigit(static_cast<unsigned char>(c)) == 0) {
      if (c != '+') return std::string(number);  // a word
    } else if (c != '0' || !(exponent.empty() || exponent == "⁻")) {
      exponent += digits[static_cast<std::size_t>(c - '0')];
    }
  }
  const std::string_view factor = number.substr(0, e);
  const std::string times = narrow_gap + std::string("×") + narrow_gap;
  return (factor == "1" ? "" : std::string(factor) + times) + "10" + exponent;
}

std::size_t letters_of(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string markdown_text(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const std::size_t end = c == '`' ? text.find('`', i + 1) : std::string_view::npos;
    if (end != std::string_view::npos && end > i + 1) {
      result += markdown_code(text.substr(i + 1, end - i - 1));
      i = end;
      continue;
    }
    if (c == '\n' || c == '\r' || c == '\t') {
      result += ' ';
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80 && std::ispunct(byte) != 0) result += '\\';
    result += c;
  }
  return result;
}

std::string markdown_code(std::string_view text) {
  std::string result = "`";
  for (const char c : text) result += c == '`' || c == '\n' ? ' ' : c;
  return result + "`";
}

}  // namespace vislab
