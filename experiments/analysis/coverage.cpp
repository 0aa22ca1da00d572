#include "experiments/analysis/coverage.h"

#include <map>
#include <set>

#include "experiments/matrix/toml_keys.h"

namespace vislab {
namespace {

using namespace toml_keys;

/// Failures of which the atlas itself knows: errata (X9) and open questions (O13) are others.
bool is_row(const std::string& failure) { return failure.starts_with('F'); }

std::map<std::string, std::string> read_reasons(const toml::table& root, const std::string& file) {
  std::map<std::string, std::string> reasons;
  const toml::array* const list = root["without"].as_array();
  if (list == nullptr) return reasons;
  for (const toml::node& node : *list) {
    const toml::table* const table = node.as_table();
    if (table == nullptr) throw InputError(place(file, node) + ": write [[without]], a table");
    refuse_unknown_keys(*table, {"failure", "because"}, "[[without]]", file);
    const auto failure = value_of<std::string>(*table, "failure", "a text", file);
    const auto because = value_of<std::string>(*table, "because", "a text", file);
    if (!failure || !because) {
      throw InputError(place(file, *table) + ": [[without]] needs failure and because");
    }
    reasons[*failure] = *because;
  }
  return reasons;
}

/// Names of all cullers that the sweeps measure.
std::set<std::string> cullers_of(const std::vector<Sweep>& sweeps) {
  std::set<std::string> names;
  for (const Sweep& sweep : sweeps) {
    for (const Block& block : sweep.blocks) {
      for (const BlockCuller& culler : block.cullers) {
        for (const CullerSpec& stage : parse_chain(culler.chain)) names.insert(stage.name);
      }
    }
  }
  return names;
}

std::vector<std::pair<std::string, std::string>> read_cullers_without(
    const toml::table& root, const std::vector<Sweep>& sweeps, const std::string& file) {
  std::vector<std::pair<std::string, std::string>> without;
  const toml::array* const list = root["culler"].as_array();
  if (list == nullptr) return without;
  const std::set<std::string> swept = cullers_of(sweeps);
  for (const toml::node& node : *list) {
    const toml::table* const table = node.as_table();
    if (table == nullptr) throw InputError(place(file, node) + ": write [[culler]], a table");
    refuse_unknown_keys(*table, {"name", "because"}, "[[culler]]", file);
    const auto name = value_of<std::string>(*table, "name", "a text", file);
    const auto because = value_of<std::string>(*table, "because", "a text", file);
    if (!name || !because) {
      throw InputError(place(file, *table) + ": [[culler]] needs name and because");
    }
    if (swept.contains(*name)) {
      throw InputError(place(file, *table) + ": " + *name +
                       " stands in a sweep, so no reason is needed");
    }
    without.emplace_back(*name, *because);
  }
  return without;
}

/// "; without: F13 (…), …", or nothing.
std::string listed(const std::string& start,
                   const std::vector<std::pair<std::string, std::string>>& entries) {
  std::string text;
  for (const auto& [name, because] : entries) {
    text += (text.empty() ? "; " + start + ": " : ", ") + name + " (" + because + ")";
  }
  return text;
}

}  // namespace

std::string AtlasCoverage::text() const {
  return std::to_string(with_sweep) + " of " + std::to_string(entries) +
         " entries of the failure atlas have a sweep" + listed("without", without) +
         listed("cullers without", cullers_without);
}

AtlasCoverage atlas_coverage(const std::vector<Sweep>& sweeps, const std::filesystem::path& path) {
  const std::string file = path.string();
  const toml::table root = parse_file(path);
  refuse_unknown_keys(root, {"entries", "without", "culler"}, "the coverage of the atlas", file);
  const toml::node* const entries = root.get("entries");
  if (entries == nullptr) throw InputError(file + ": entries, the number of rows, is missing");
  AtlasCoverage coverage;
  coverage.entries = static_cast<std::size_t>(whole_number(*entries, "entries", 1, 1000, file));
  coverage.cullers_without = read_cullers_without(root, sweeps, file);
  std::map<std::string, std::string> reasons = read_reasons(root, file);
  std::set<std::string> swept;
  for (const Sweep& sweep : sweeps) {
    if (is_row(sweep.failure)) swept.insert(sweep.failure);
  }
  for (std::size_t i = 1; i <= coverage.entries; ++i) {
    const std::string row = "F" + std::to_string(i);
    const auto reason = reasons.find(row);
    const bool has_sweep = swept.erase(row) > 0;
    if (has_sweep == (reason != reasons.end())) {
      throw InputError(file + ": " + row +
                       (has_sweep ? " has a sweep, so no reason is needed"
                                  : " has no sweep; say why in a table [[without]]"));
    }
    if (has_sweep) {
      ++coverage.with_sweep;
      continue;
    }
    coverage.without.emplace_back(row, reason->second);
    reasons.erase(reason);
  }
  if (!swept.empty() || !reasons.empty()) {
    throw InputError(file + ": the atlas has no row " +
                     (swept.empty() ? reasons.begin()->first : *swept.begin()) + "; it ends at F" +
                     std::to_string(coverage.entries));
  }
  return coverage;
}

}  // namespace vislab
