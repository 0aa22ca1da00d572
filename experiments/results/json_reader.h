// Reading JSON fields with errors that say where and what; what to do about it says the caller.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "common/scene/error.h"

namespace vislab {

/// Parses text; throws InputError that names `where`.
inline nlohmann::json parse_json(const std::string& text, const std::string& where) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception&) {
    throw InputError(where + ": not valid JSON");
  }
}

/// Runs `read`, which takes fields out of parsed JSON, and turns a missing or mistyped field into
/// an InputError that names `where`.
template <typename Function>
auto read_json(const std::string& where, Function&& read) {
  try {
    return read();
  } catch (const nlohmann::json::exception& error) {
    // "[json.exception.out_of_range.403] key 'x' not found": the library's own number says nothing.
    const std::string text = error.what();
    const auto after = text.find("] ");
    throw InputError(where + ": " + (after == std::string::npos ? text : text.substr(after + 2)));
  }
}

}  // namespace vislab
