#include "experiments/verbs/table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>

namespace vislab {
namespace {

bool is_number(const TableValue& value) {
  return std::holds_alternative<double>(value) || std::holds_alternative<std::uint64_t>(value);
}

std::string short_number(double value) {
  if (std::isnan(value)) return "-";
  char text[32];
  const double size = std::abs(value);
  if (size >= 1e5 || (size > 0.0 && size < 1e-3)) {
    std::snprintf(text, sizeof text, "%.3g", value);
  } else {
    const int before = size < 1.0 ? 1 : static_cast<int>(std::log10(size)) + 1;
    std::snprintf(text, sizeof text, "%.*f", std::max(0, 4 - before), value);
  }
  return text;
}

nlohmann::ordered_json to_json(const TableValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* number = std::get_if<double>(&value)) {
    return std::isfinite(*number) ? nlohmann::ordered_json(*number) : nlohmann::ordered_json();
  }
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return *count;
  if (const auto* flag = std::get_if<bool>(&value)) return *flag;
  return nullptr;
}

std::string to_csv(const TableValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    if (text->find_first_of(",\"\n") == std::string::npos) return *text;
    std::string quoted = "\"";
    for (const char c : *text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
  }
  const nlohmann::ordered_json json = to_json(value);
  return json.is_null() ? "" : json.dump();
}

/// Characters, not bytes, of UTF-8 text.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

}  // namespace

std::string to_text(const TableValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* number = std::get_if<double>(&value)) return short_number(*number);
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return std::to_string(*count);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "yes" : "no";
  return "-";
}

void Table::add(std::vector<TableValue> row) {
  if (row.size() != columns_.size()) throw std::logic_error("a row does not fit its table");
  rows_.push_back(std::move(row));
}

void Table::print_text(std::ostream& out) const {
  std::vector<std::vector<std::string>> lines{columns_};
  for (const auto& row : rows_) {
    std::vector<std::string>& line = lines.emplace_back();
    for (const TableValue& value : row) line.push_back(to_text(value));
  }
  std::vector<std::size_t> widths(columns_.size(), 0);
  std::vector<bool> right(columns_.size(), false);
  for (const auto& line : lines) {
    for (std::size_t c = 0; c < line.size(); ++c)
      widths[c] = std::max(widths[c], width_of(line[c]));
  }
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    right[c] = std::ranges::any_of(rows_, [&](const auto& row) { return is_number(row[c]); });
  }
  for (const auto& line : lines) {
    std::string text;
    for (std::size_t c = 0; c < line.size(); ++c) {
      const std::string padding(widths[c] - width_of(line[c]), ' ');
      text += (c > 0 ? "  " : "") + (right[c] ? padding + line[c] : line[c] + padding);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out << text << '\n';
  }
}

void Table::print_json(std::ostream& out) const {
  for (const auto& row : rows_) {
    nlohmann::ordered_json object;
    for (std::size_t c = 0; c < columns_.size(); ++c) object[columns_[c]] = to_json(row[c]);
    out << object.dump() << '\n';
  }
}

void Table::print_csv(std::ostream& out) const {
  for (std::size_t c = 0; c < columns_.size(); ++c) out << (c > 0 ? "," : "") << columns_[c];
  out << '\n';
  for (const auto& row : rows_) {
    for (std::size_t c = 0; c < columns_.size(); ++c) out << (c > 0 ? "," : "") << to_csv(row[c]);
    out << '\n';
  }
}

}  // namespace vislab
