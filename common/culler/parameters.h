// Parameters of cullers: declared once, and from that declaration listed, validated, swept and
// documented.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace vislab {

/// One parameter. Values are kept as text in a canonical form: "true"/"false", an integer, a real
/// as the shortest decimal that reads back the same, or one of the choices.
struct ParameterSpec {
  enum class Type { boolean, integer, real, choice };
  enum class Stage { build, query };  // does changing it need a new build()?

  std::string name;
  Type type = Type::real;
  std::string default_value;
  double min = 0.0, max = 0.0;       // integer and real: allowed range, both ends included
  std::vector<std::string> choices;  // choice: what is allowed
  std::string unit;                  // "" for pure numbers
  Stage stage = Stage::query;
  std::string meaning;  // one sentence: what it does and what breaks when it changes

  static ParameterSpec boolean(std::string name, bool fallback, Stage stage, std::string meaning);
  static ParameterSpec integer(std::string name, long long fallback, long long min, long long max,
                               std::string unit, Stage stage, std::string meaning);
  static ParameterSpec real(std::string name, double fallback, double min, double max,
                            std::string unit, Stage stage, std::string meaning);
  static ParameterSpec choice(std::string name, std::string fallback,
                              std::vector<std::string> choices, Stage stage, std::string meaning);

  /// "0 to 18", "true or false", "aabb, sphere".
  std::string allowed() const;
};

/// Values for all parameters of a culler, validated.
class ParameterValues {
 public:
  ParameterValues() = default;
  /// Defaults overridden by `given`. Throws InputError that names culler, parameter and what is
  /// allowed.
  ParameterValues(std::string_view culler, const std::vector<ParameterSpec>& specs,
                  const std::map<std::string, std::string>& given);

  bool boolean(std::string_view name) const;
  long long integer(std::string_view name) const;
  double real(std::string_view name) const;
  const std::string& choice(std::string_view name) const;

  /// All values by name, canonical.
  const std::map<std::string, std::string, std::less<>>& all() const { return values_; }

 private:
  std::map<std::string, std::string, std::less<>> values_;
};

}  // namespace vislab
