// What the negative controls of all families share: a table of mistakes, of which a parameter picks
// one.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "common/culler/culler.h"

namespace vislab {

/// A mistake that a source or an engine makes, in parts of sentences. Families add how it is made.
struct Mistake {
  const char* name;
  const char* says;    // what the source says or does
  const char* wrong;   // what is wrong with it
  const char* damage;  // what it does
  const char* source;
};

/// The parameter `error`, one choice for each mistake of a table; the first is the default.
template <typename Mistakes>
ParameterSpec error_parameter(const Mistakes& mistakes) {
  std::vector<std::string> names;
  std::string meaning = "the mistake:";
  for (const Mistake& mistake : mistakes) {
    names.emplace_back(mistake.name);
    meaning += std::string(names.size() > 1 ? "; " : " ") + mistake.name + " " + mistake.damage;
  }
  return ParameterSpec::choice("error", names.front(), names, ParameterSpec::Stage::build, meaning);
}

/// The mistake of the table that `error` names.
template <typename Mistakes>
const auto& chosen_mistake(const Mistakes& mistakes, const ParameterValues& values) {
  for (const auto& mistake : mistakes) {
    if (values.choice("error") == mistake.name) return mistake;
  }
  throw std::logic_error("an allowed mistake is not in the table");
}

/// What the control declares once the mistake is chosen.
inline CullerInfo info_of(CullerInfo control, const Mistake& mistake) {
  control.summary = std::string(mistake.says) + ". Wrong: " + mistake.wrong + ".";
  control.limits = std::string("Wrong on purpose: ") + mistake.damage + ".";
  control.sources = {mistake.source};
  return control;
}

}  // namespace vislab
