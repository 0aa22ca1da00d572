// Cullers by name, and chains of them by specification text.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/culler/culler.h"

namespace vislab {

/// How a culler enters the registry: its declaration with default parameters, and how to make one.
struct CullerEntry {
  CullerInfo info;
  std::function<std::unique_ptr<ICuller>(const ParameterValues&)> make;
};

/// One stage of a chain: `name[parameter=value,...]`.
struct CullerSpec {
  std::string name;
  std::map<std::string, std::string> parameters;  // as given
};

/// Splits "a[x=1,y=2] > b" into stages. Throws InputError that shows where the text is wrong.
std::vector<CullerSpec> parse_chain(std::string_view text);

class Registry {
 public:
  /// Throws std::logic_error if the name is taken.
  void add(CullerEntry entry);

  /// All entries, sorted by name.
  const std::map<std::string, CullerEntry, std::less<>>& entries() const { return entries_; }
  /// Throws InputError with the list of known names.
  const CullerEntry& entry(std::string_view name) const;

  /// A culler, or a chain of cullers, from its text. Throws InputError for unknown names and
  /// parameters that are unknown or out of range.
  std::unique_ptr<ICuller> make(std::string_view text) const;

  /// The text with all parameters written out, in the order of declaration: the key under which
  /// results are kept. Two texts that mean the same chain give the same key.
  std::string canonical(std::string_view text) const;
  /// The same with parameters at their defaults left out: for tables and charts.
  std::string short_name(std::string_view text) const;

 private:
  std::map<std::string, CullerEntry, std::less<>> entries_;
};

}  // namespace vislab
