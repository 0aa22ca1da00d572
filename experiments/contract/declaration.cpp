#include "experiments/contract/declaration.h"

#include <set>

#include "common/scene/error.h"

namespace vislab {
namespace {

std::string incomplete_parameter(const ParameterSpec& parameter) {
  const std::string name = "parameter '" + parameter.name + "' ";
  if (parameter.name.empty()) return "a parameter has no name";
  if (parameter.meaning.empty()) return name + "has no meaning";
  if (parameter.type == ParameterSpec::Type::choice && parameter.choices.empty()) {
    return name + "has no choices";
  }
  if (parameter.min > parameter.max) return name + "has an empty range";
  try {
    const ParameterValues values("", {parameter}, {{parameter.name, parameter.default_value}});
    if (values.choice(parameter.name) != parameter.default_value) {
      return name + "has a default that is not in canonical form";
    }
  } catch (const InputError&) {
    return name + "has a default that it would refuse";
  }
  return {};
}

std::string incomplete_entry(const CullerEntry& entry) {
  const CullerInfo& info = entry.info;
  const std::string family = info.name.substr(0, info.name.find('.'));
  if (info.family != family) return "the family of " + info.name + " is not '" + family + "'";
  if (info.summary.empty()) return info.name + " has no summary";
  if (info.limits.empty()) return info.name + " does not say its limits";
  if (info.cost.empty()) return info.name + " does not say its cost";
  if (info.sources.empty()) return info.name + " names no source";
  std::set<std::string> names;
  for (const ParameterSpec& parameter : info.parameters) {
    const std::string fault = incomplete_parameter(parameter);
    if (!fault.empty()) return info.name + ": " + fault;
    if (!names.insert(parameter.name).second) {
      return info.name + ": two parameters are called " + parameter.name;
    }
  }
  const std::unique_ptr<ICuller> culler = entry.make({info.name, info.parameters, {}});
  if (culler->info().name != info.name || culler->info().family != info.family ||
      culler->info().guarantee != info.guarantee ||
      culler->info().repeatability != info.repeatability ||
      culler->info().granularity != info.granularity ||
      culler->info().needs_device != info.needs_device ||
      culler->info().needs_truth != info.needs_truth) {
    return info.name + " made with its defaults declares something else than the registry's entry";
  }
  return {};
}

/// Values that `parameter` has to refuse.
std::vector<std::string> nonsense(const ParameterSpec& parameter) {
  std::vector<std::string> values = {"", "no such value"};
  if (parameter.type == ParameterSpec::Type::integer) {
    const auto min = static_cast<long long>(parameter.min);
    const auto max = static_cast<long long>(parameter.max);
    values.insert(values.end(), {std::to_string(min - 1), std::to_string(max + 1), "0.5", "1e99"});
  } else if (parameter.type == ParameterSpec::Type::real) {
    values.insert(values.end(), {std::to_string(parameter.min - 1.0),
                                 std::to_string(parameter.max * 1.001 + 1.0), "nan", "inf"});
  }
  return values;
}

/// "" if an InputError with `word` in it is thrown.
std::string refused(const Registry& registry, const std::string& spec, const std::string& word) {
  try {
    registry.make(spec);
  } catch (const InputError& error) {
    if (std::string(error.what()).find(word) != std::string::npos) return {};
    return "the refusal of " + spec + " does not name " + word + ": " + error.what();
  }
  return spec + " was not refused";
}

}  // namespace

std::string incomplete_info(const Registry& registry, const std::string& spec) {
  for (const CullerSpec& stage : parse_chain(spec)) {
    const std::string fault = incomplete_entry(registry.entry(stage.name));
    if (!fault.empty()) return fault;
  }
  const CullerInfo info = registry.make(spec)->info();
  if (info.name.empty() || info.summary.empty() || info.cost.empty() || info.limits.empty() ||
      info.sources.empty()) {
    return "the info of the chain is not complete";
  }
  return {};
}

std::string accepted_nonsense(const Registry& registry, const std::string& spec) {
  for (const CullerSpec& stage : parse_chain(spec)) {
    std::string fault = refused(registry, stage.name + "[no_such=1]", "no_such");
    if (!fault.empty()) return fault;
    for (const ParameterSpec& parameter : registry.entry(stage.name).info.parameters) {
      for (const std::string& value : nonsense(parameter)) {
        fault = refused(registry, stage.name + "[" + parameter.name + "=" + value + "]",
                        parameter.name);
        if (!fault.empty()) return fault;
      }
    }
  }
  return {};
}

}  // namespace vislab
