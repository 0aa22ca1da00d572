// "${dial}" in the tables of a stress sweep, filled with a value of its dial. For the .cpp files of
// this folder's libraries only: the TOML parser is a heavy header.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "experiments/matrix/toml_keys.h"

namespace vislab::dial_gaps {

inline constexpr std::string_view gap = "${dial}";

/// One value of the dial: a whole number stays one, for keys that ask for whole numbers.
struct DialValue {
  std::optional<std::int64_t> whole;
  double number = 0.0;
  std::string text;
};

/// The shortest text that is read as the same number.
std::string digits_of(double number);

/// Every gap in the text becomes `with`.
std::string replaced(std::string text, std::string_view with);

/// A text that is nothing but a gap becomes the number; in others the gaps become its digits.
toml::table substituted(const toml::table& table, const DialValue& value);

/// The table as the text of a file.
std::string toml_text(const toml::table& table);

}  // namespace vislab::dial_gaps
