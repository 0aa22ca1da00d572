#include "experiments/matrix/dial_gaps.h"

#include <charconv>
#include <sstream>
#include <utility>

namespace vislab::dial_gaps {
namespace {

toml::array substituted(const toml::array& array, const DialValue& value);

/// Hands `add` the node with the dial's value in all its gaps.
template <typename Add>
void substitute(const toml::node& node, const DialValue& value, Add&& add) {
  if (const toml::table* table = node.as_table()) {
    add(dial_gaps::substituted(*table, value));
  } else if (const toml::array* array = node.as_array()) {
    add(substituted(*array, value));
  } else if (const auto* text = node.as_string(); text != nullptr && text->get() != gap) {
    add(replaced(text->get(), value.text));
  } else if (text != nullptr && value.whole) {
    add(*value.whole);
  } else if (text != nullptr) {
    add(value.number);
  } else if (const auto* whole = node.as_integer()) {
    add(whole->get());
  } else if (const auto* number = node.as_floating_point()) {
    add(number->get());
  } else if (const auto* flag = node.as_boolean()) {
    add(flag->get());
  }
}

toml::array substituted(const toml::array& array, const DialValue& value) {
  toml::array result;
  for (const toml::node& node : array) {
    substitute(node, value, [&](auto filled) { result.push_back(std::move(filled)); });
  }
  return result;
}

}  // namespace

std::string digits_of(double number) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, number).ptr;
  return {digits, end};
}

std::string replaced(std::string text, std::string_view with) {
  for (std::size_t at = 0; (at = text.find(gap, at)) != std::string::npos; at += with.size()) {
    text.replace(at, gap.size(), with);
  }
  return text;
}

toml::table substituted(const toml::table& table, const DialValue& value) {
  toml::table result;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    substitute(node, value, [&](auto filled) { result.insert(name, std::move(filled)); });
  }
  return result;
}

std::string toml_text(const toml::table& table) {
  std::ostringstream text;
  text << toml::toml_formatter(table) << '\n';
  return text.str();
}

}  // namespace vislab::dial_gaps
