// Tables of TOML files, read key by key; whatever was not asked for is an error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace vislab {

/// A table of a settings file. Every get names a key, its type and its range; done() then refuses
/// the keys that nobody asked for, naming those that are known. All errors are InputError and say
/// file, table and key. Copies share the table and what has been asked for.
class Settings {
 public:
  /// Reads a TOML file. Throws InputError with the line for malformed text.
  static Settings from_file(const std::filesystem::path& file);
  /// The same for text; `where` begins messages.
  static Settings from_text(const std::string& text, const std::string& where);

  bool has(const std::string& key) const;
  /// Required unless a fallback is given.
  std::string text(const std::string& key,
                   const std::optional<std::string>& fallback = std::nullopt) const;
  double number(const std::string& key, double low, double high,
                std::optional<double> fallback = std::nullopt) const;
  std::int64_t whole(const std::string& key, std::int64_t low, std::int64_t high,
                     std::optional<std::int64_t> fallback = std::nullopt) const;
  bool flag(const std::string& key, bool fallback) const;
  /// [x, y, z]
  glm::dvec3 point(const std::string& key,
                   const std::optional<glm::dvec3>& fallback = std::nullopt) const;
  /// [[x, y, z], …]
  std::vector<glm::dvec3> points(const std::string& key) const;
  Settings table(const std::string& key) const;
  /// [[key]] … [[key]]; at least one.
  std::vector<Settings> tables(const std::string& key) const;

  void done() const;
  /// File and table, to begin messages with.
  const std::string& where() const { return where_; }

 private:
  struct State;
  Settings(std::shared_ptr<State> state, std::string where);

  std::shared_ptr<State> state_;
  std::string where_;
};

}  // namespace vislab
