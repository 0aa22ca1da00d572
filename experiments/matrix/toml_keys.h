// Reading keys of TOML files with errors that say file, line and what would be right. For the .cpp
// files of this folder's libraries only: the TOML parser is a heavy header.
#pragma once

#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/error.h"
#include "experiments/devices/device_spec.h"

namespace vislab::toml_keys {

/// The file's root table. Throws InputError with file and line for malformed text.
inline toml::table parse_file(const std::filesystem::path& file) {
  try {
    return toml::parse_file(file.string());
  } catch (const toml::parse_error& error) {
    throw InputError(file.string() + ":" + std::to_string(error.source().begin.line) + ": " +
                     std::string(error.description()));
  }
}

/// Where a TOML value stands: "file.toml:12".
inline std::string place(const std::string& file, const toml::node& node) {
  return file + ":" + std::to_string(node.source().begin.line);
}

inline void refuse_unknown_keys(const toml::table& table, const std::vector<std::string>& known,
                                const std::string& what, const std::string& file) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (std::ranges::find(known, name) == known.end()) {
      throw InputError(place(file, node) + ": " +
                       unknown_name("key of " + what, name, known).what());
    }
  }
}

template <typename T>
std::optional<T> value_of(const toml::table& table, std::string_view key, const std::string& type,
                          const std::string& file) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  const std::optional<T> value = node->value<T>();
  if (!value) throw InputError(place(file, *node) + ": " + std::string(key) + " must be " + type);
  return value;
}

inline int whole_number(const toml::node& node, std::string_view key, long long min, long long max,
                        const std::string& file) {
  const std::optional<long long> value = node.value_exact<std::int64_t>();
  if (!value || *value < min || *value > max) {
    throw InputError(place(file, node) + ": " + std::string(key) + " must be a whole number from " +
                     std::to_string(min) + " to " + std::to_string(max));
  }
  return static_cast<int>(*value);
}

inline std::vector<std::string> text_list(const toml::node& node, std::string_view key,
                                          const std::string& file) {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty()) {
    throw InputError(place(file, node) + ": " + std::string(key) +
                     " must be a list of texts with at least one entry");
  }
  std::vector<std::string> list;
  for (const toml::node& entry : *array) {
    const std::optional<std::string> text = entry.value_exact<std::string>();
    if (!text) {
      throw InputError(place(file, entry) + ": " + std::string(key) + " must be a list of texts");
    }
    list.push_back(*text);
  }
  return list;
}

inline const toml::array* tables(const toml::table& root, std::string_view key,
                                 const std::string& file) {
  const toml::node* node = root.get(key);
  if (node == nullptr) return nullptr;
  if (!node->is_array_of_tables()) {
    throw InputError(place(file, *node) + ": write [[" + std::string(key) + "]]");
  }
  return node->as_array();
}

/// A device's text as results are kept under it.
inline std::string canonical_device(const std::string& text, const toml::node* node,
                                    const std::string& file) {
  try {
    return parse_device(text).text;
  } catch (const InputError& error) {
    throw InputError((node == nullptr ? file : place(file, *node)) + ": " + error.what());
  }
}

/// How often and where the cells of a matrix or a sweep run.
struct PassSettings {
  int rounds = 5;
  std::uint64_t seed = 1;
  int threads = 2;
  std::string draw = "osmesa";  // as written
  double timeout_s = 300.0;
};

/// The keys of PassSettings.
inline const std::vector<std::string> pass_keys{"rounds", "seed", "threads", "draw", "timeout_s"};

/// Replaces what the table names.
inline void read_pass_settings(const toml::table& root, PassSettings& pass,
                               const std::string& file) {
  if (const auto* node = root.get("rounds")) {
    pass.rounds = whole_number(*node, "rounds", 1, 1000, file);
  }
  if (const auto* node = root.get("seed")) {
    pass.seed = static_cast<std::uint64_t>(whole_number(*node, "seed", 0, 2147483647, file));
  }
  if (const auto* node = root.get("threads")) {
    pass.threads = whole_number(*node, "threads", 1, 1024, file);
  }
  if (auto draw = value_of<std::string>(root, "draw", "a text", file)) pass.draw = *draw;
  if (auto seconds = value_of<double>(root, "timeout_s", "a number of seconds", file)) {
    if (!(*seconds > 0.0)) {
      throw InputError(place(file, *root.get("timeout_s")) + ": timeout_s must be above 0");
    }
    pass.timeout_s = *seconds;
  }
}

}  // namespace vislab::toml_keys
