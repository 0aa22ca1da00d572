#include "experiments/matrix/size_coverage.h"

#include <array>
#include <map>
#include <set>
#include <utility>

#include "experiments/matrix/toml_keys.h"

namespace vislab {
namespace {

using namespace toml_keys;

using Dial = std::pair<std::string, std::string>;  // culler, parameter

std::string name_of(const Dial& dial) { return dial.second + " of " + dial.first; }

std::map<Dial, std::string> read_reasons(const std::filesystem::path& path) {
  const std::string file = path.string();
  const toml::table root = parse_file(path);
  refuse_unknown_keys(root, {"without"}, "sizes without a sweep", file);
  std::map<Dial, std::string> reasons;
  const toml::array* const list = tables(root, "without", file);
  if (list == nullptr) return reasons;
  for (const toml::node& node : *list) {
    const toml::table& table = *node.as_table();
    refuse_unknown_keys(table, {"parameter", "cullers", "because"}, "[[without]]", file);
    const auto parameter = value_of<std::string>(table, "parameter", "a text", file);
    const auto because = value_of<std::string>(table, "because", "a text", file);
    const toml::node* const cullers = table.get("cullers");
    if (!parameter || !because || cullers == nullptr) {
      throw InputError(place(file, table) + ": [[without]] needs parameter, cullers and because");
    }
    for (const std::string& culler : text_list(*cullers, "cullers", file)) {
      reasons[{culler, *parameter}] = *because;
    }
  }
  return reasons;
}

/// Wrong variants show a mistake, and the example stands for nothing.
bool is_tuned(const std::string& culler) {
  return !culler.ends_with(".wrong") && !culler.starts_with("skeleton.");
}

}  // namespace

std::string SizeCoverage::text() const {
  std::string all = std::to_string(with_sweep) + " sizes of models have a sweep; without: ";
  for (std::size_t i = 0; i < without.size(); ++i) {
    all += (i == 0 ? "" : ", ") + without[i].parameter + " of " + without[i].culler + " (" +
           without[i].because + ")";
  }
  return all + (without.empty() ? "none" : "");
}

bool is_size_dial(const ParameterSpec& parameter) {
  if (parameter.stage != ParameterSpec::Stage::build) return false;
  constexpr std::array whole{"n", "sectors", "sigma", "test", "area", "scale", "vertices"};
  constexpr std::array ends{"depth",     "size",    "triangles", "boxes",
                            "fragments", "samples", "levels"};
  return std::ranges::count(whole, parameter.name) > 0 ||
         std::ranges::any_of(ends, [&](const char* end) { return parameter.name.ends_with(end); });
}

SizeCoverage size_coverage(const std::vector<SizeSweep>& sweeps, const Registry& registry,
                           const std::filesystem::path& file) {
  std::set<Dial> swept;
  for (const SizeSweep& sweep : sweeps) {
    for (const SizeMethod& method : sweep.methods) swept.insert({method.culler, method.parameter});
  }
  const std::map<Dial, std::string> reasons = read_reasons(file);
  for (const auto& [dial, because] : reasons) {
    if (!registry.entries().contains(dial.first)) continue;
    const std::vector<ParameterSpec>& parameters = registry.entry(dial.first).info.parameters;
    if (std::ranges::find(parameters, dial.second, &ParameterSpec::name) == parameters.end()) {
      throw InputError(file.string() + ": there is no " + name_of(dial));
    }
    if (swept.contains(dial)) {
      throw InputError(file.string() + ": " + name_of(dial) + " has a size sweep; take it out");
    }
  }
  SizeCoverage coverage;
  coverage.with_sweep = swept.size();
  for (const auto& [culler, entry] : registry.entries()) {
    if (!is_tuned(culler)) continue;
    for (const ParameterSpec& parameter : entry.info.parameters) {
      const Dial dial{culler, parameter.name};
      if (!is_size_dial(parameter) || swept.contains(dial)) continue;
      const auto reason = reasons.find(dial);
      if (reason == reasons.end()) {
        throw InputError(name_of(dial) + " has no size sweep: write one, or say in " +
                         file.string() + " why there is none");
      }
      coverage.without.push_back({culler, parameter.name, reason->second});
    }
  }
  return coverage;
}

}  // namespace vislab
