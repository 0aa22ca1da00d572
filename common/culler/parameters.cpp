#include "common/culler/parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "common/scene/error.h"

namespace vislab {
namespace {

std::string to_text(double value) {
  char buffer[32];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  return {buffer, end};
}

template <typename Number>
bool parse(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// The canonical form of `text`, or "" if it is not allowed.
std::string canonical(const ParameterSpec& spec, const std::string& text) {
  switch (spec.type) {
    case ParameterSpec::Type::boolean:
      if (text == "true" || text == "on" || text == "1") return "true";
      if (text == "false" || text == "off" || text == "0") return "false";
      return "";
    case ParameterSpec::Type::integer: {
      long long value = 0;
      if (!parse(text, value)) return "";
      const auto real = static_cast<double>(value);
      return real >= spec.min && real <= spec.max ? std::to_string(value) : "";
    }
    case ParameterSpec::Type::real: {
      double value = 0.0;
      if (!parse(text, value) || !std::isfinite(value)) return "";
      return value >= spec.min && value <= spec.max ? to_text(value) : "";
    }
    case ParameterSpec::Type::choice:
      return std::ranges::find(spec.choices, text) != spec.choices.end() ? text : "";
  }
  return "";
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

ParameterSpec ParameterSpec::boolean(std::string name, bool fallback, Stage stage,
                                     std::string meaning) {
  return {std::move(name), Type::boolean,     fallback ? "true" : "false", 0.0, 1.0, {}, "",
          stage,           std::move(meaning)};
}

ParameterSpec ParameterSpec::integer(std::string name, long long fallback, long long min,
                                     long long max, std::string unit, Stage stage,
                                     std::string meaning) {
  return {std::move(name),          Type::integer,
          std::to_string(fallback), static_cast<double>(min),
          static_cast<double>(max), {},
          std::move(unit),          stage,
          std::move(meaning)};
}

ParameterSpec ParameterSpec::real(std::string name, double fallback, double min, double max,
                                  std::string unit, Stage stage, std::string meaning) {
  return {std::move(name), Type::real, to_text(fallback), min, max, {},
          std::move(unit), stage,      std::move(meaning)};
}

ParameterSpec ParameterSpec::choice(std::string name, std::string fallback,
                                    std::vector<std::string> choices, Stage stage,
                                    std::string meaning) {
  return {std::move(name), Type::choice,      std::move(fallback), 0.0, 0.0, std::move(choices), "",
          stage,           std::move(meaning)};
}

std::string ParameterSpec::allowed() const {
  switch (type) {
    case Type::boolean:
      return "true or false";
    case Type::integer:
      return "whole numbers from " + std::to_string(static_cast<long long>(min)) + " to " +
             std::to_string(static_cast<long long>(max));
    case Type::real:
      return "numbers from " + to_text(min) + " to " + to_text(max);
    case Type::choice:
      return join(choices);
  }
  return "";
}

ParameterValues::ParameterValues(std::string_view culler, const std::vector<ParameterSpec>& specs,
                                 const std::map<std::string, std::string>& given) {
  for (const ParameterSpec& spec : specs) values_[spec.name] = spec.default_value;
  for (const auto& [name, text] : given) {
    const auto spec = std::ranges::find(specs, name, &ParameterSpec::name);
    if (spec == specs.end()) {
      std::vector<std::string> known;
      for (const ParameterSpec& s : specs) known.push_back(s.name);
      throw unknown_name("parameter of " + std::string(culler), name, known);
    }
    const std::string value = canonical(*spec, text);
    if (value.empty()) {
      throw InputError(std::string(culler) + ": parameter " + name + " = '" + text +
                       "' is not allowed; allowed: " + spec->allowed() +
                       (spec->unit.empty() ? "" : " (" + spec->unit + ")"));
    }
    values_[name] = value;
  }
}

const std::string& ParameterValues::choice(std::string_view name) const {
  const auto it = values_.find(name);
  if (it == values_.end()) throw std::logic_error("undeclared parameter " + std::string(name));
  return it->second;
}

bool ParameterValues::boolean(std::string_view name) const { return choice(name) == "true"; }

long long ParameterValues::integer(std::string_view name) const {
  long long value = 0;
  parse(choice(name), value);
  return value;
}

double ParameterValues::real(std::string_view name) const {
  double value = 0.0;
  parse(choice(name), value);
  return value;
}

}  // namespace vislab
