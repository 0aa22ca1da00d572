// Tables that verbs print: aligned text, or one JSON object a line.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <variant>
#include <vector>

namespace vislab {

/// A value of a table; std::monostate (and NaN) means that it does not apply.
using TableValue = std::variant<std::monostate, std::string, double, std::uint64_t, bool>;

/// The value as tables show it: numbers with four significant digits, "-" for what does not apply.
std::string to_text(const TableValue& value);

class Table {
 public:
  /// Column names are the keys of the JSON objects; metrics go by their own names.
  explicit Table(std::vector<std::string> columns) : columns_(std::move(columns)) {}

  /// One value a column.
  void add(std::vector<TableValue> row);

  /// Columns padded to a common width, numbers with four significant digits.
  void print_text(std::ostream& out) const;
  /// One object a line, numbers in full; what does not apply is null.
  void print_json(std::ostream& out) const;
  /// RFC 4180, one header line.
  void print_csv(std::ostream& out) const;
  void print(std::ostream& out, bool json) const { json ? print_json(out) : print_text(out); }

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<TableValue>> rows_;
};

}  // namespace vislab
