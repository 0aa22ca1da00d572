#include "common/scene/settings.h"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/scene/error.h"
#include "common/scene/file_bytes.h"

namespace vislab {

struct Settings::State {
  toml::table table;
  std::set<std::string> asked;

  const toml::node* find(const std::string& key) {
    asked.insert(key);
    return table.get(key);
  }
};

namespace {

std::string in_range(double low, double high) {
  std::string text = "a number";
  if (std::isfinite(low)) text += " from " + std::to_string(low);
  if (std::isfinite(high)) text += " to " + std::to_string(high);
  return text;
}

std::optional<glm::dvec3> point_of(const toml::node& node) {
  const toml::array* const list = node.as_array();
  if (list == nullptr || list->size() != 3) return std::nullopt;
  glm::dvec3 point(0.0);
  for (int i = 0; i < 3; ++i) {
    const std::optional<double> value = (*list)[static_cast<std::size_t>(i)].value<double>();
    if (!value || !std::isfinite(*value)) return std::nullopt;
    point[i] = *value;
  }
  return point;
}

}  // namespace

Settings::Settings(std::shared_ptr<State> state, std::string where)
    : state_(std::move(state)), where_(std::move(where)) {}

Settings Settings::from_file(const std::filesystem::path& file) {
  return from_text(read_bytes(file), file.string());
}

Settings Settings::from_text(const std::string& text, const std::string& where) {
  try {
    auto state = std::make_shared<State>();
    state->table = toml::parse(text);
    return {state, where};
  } catch (const toml::parse_error& error) {
    throw InputError(where + ", line " + std::to_string(error.source().begin.line) + ": " +
                     std::string(error.description()));
  }
}

namespace {

[[noreturn]] void fail(const std::string& where, const std::string& key,
                       const toml::node* const node, const std::string& right) {
  throw InputError(where + ": `" + key + "` " + (node == nullptr ? "is missing" : "is wrong") +
                   "; it must be " + right);
}

}  // namespace

bool Settings::has(const std::string& key) const { return state_->find(key) != nullptr; }

std::string Settings::text(const std::string& key,
                           const std::optional<std::string>& fallback) const {
  const toml::node* const node = state_->find(key);
  if (node == nullptr && fallback) return *fallback;
  if (node == nullptr || !node->is_string()) fail(where_, key, node, "a text in quotes");
  return node->as_string()->get();
}

double Settings::number(const std::string& key, double low, double high,
                        std::optional<double> fallback) const {
  const toml::node* const node = state_->find(key);
  if (node == nullptr && fallback) return *fallback;
  const bool numeric = node != nullptr && node->is_number();
  const double value = numeric ? *node->value<double>() : 0.0;
  if (!numeric || !(value >= low && value <= high)) fail(where_, key, node, in_range(low, high));
  return value;
}

std::int64_t Settings::whole(const std::string& key, std::int64_t low, std::int64_t high,
                             std::optional<std::int64_t> fallback) const {
  const toml::node* const node = state_->find(key);
  if (node == nullptr && fallback) return *fallback;
  const bool integral = node != nullptr && node->is_integer();
  const std::int64_t value = integral ? node->as_integer()->get() : 0;
  if (!integral || value < low || value > high) {
    fail(where_, key, node,
         "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  }
  return value;
}

bool Settings::flag(const std::string& key, bool fallback) const {
  const toml::node* const node = state_->find(key);
  if (node == nullptr) return fallback;
  if (!node->is_boolean()) fail(where_, key, node, "true or false");
  return node->as_boolean()->get();
}

glm::dvec3 Settings::point(const std::string& key,
                           const std::optional<glm::dvec3>& fallback) const {
  const toml::node* const node = state_->find(key);
  if (node == nullptr && fallback) return *fallback;
  const std::optional<glm::dvec3> point = node == nullptr ? std::nullopt : point_of(*node);
  if (!point) fail(where_, key, node, "three finite numbers [x, y, z]");
  return *point;
}

std::vector<glm::dvec3> Settings::points(const std::string& key) const {
  const toml::node* const node = state_->find(key);
  const toml::array* const list = node == nullptr ? nullptr : node->as_array();
  const std::string right = "a list of points [x, y, z]";
  if (list == nullptr || list->empty()) fail(where_, key, node, right);
  std::vector<glm::dvec3> points;
  for (const toml::node& element : *list) {
    const std::optional<glm::dvec3> point = point_of(element);
    if (!point) fail(where_, key, node, right);
    points.push_back(*point);
  }
  return points;
}

Settings Settings::table(const std::string& key) const {
  const toml::node* const node = state_->find(key);
  if (node == nullptr || !node->is_table()) fail(where_, key, node, "a table");
  auto state = std::make_shared<State>();
  state->table = *node->as_table();
  return {state, where_ + ", " + key};
}

std::vector<Settings> Settings::tables(const std::string& key) const {
  const toml::node* const node = state_->find(key);
  const toml::array* const list = node == nullptr ? nullptr : node->as_array();
  const std::string right = "a list of tables";
  if (list == nullptr || list->empty()) fail(where_, key, node, right);
  std::vector<Settings> tables;
  for (const toml::node& element : *list) {
    if (!element.is_table()) fail(where_, key, node, right);
    auto state = std::make_shared<State>();
    state->table = *element.as_table();
    tables.push_back({state, where_ + ", " + key + " " + std::to_string(tables.size())});
  }
  return tables;
}

void Settings::done() const {
  for (const auto& [key, value] : state_->table) {
    const std::string name(key.str());
    if (state_->asked.contains(name)) continue;
    const std::vector<std::string> known(state_->asked.begin(), state_->asked.end());
    throw InputError(where_ + ": " + unknown_name("key", name, known).what());
  }
}

}  // namespace vislab
