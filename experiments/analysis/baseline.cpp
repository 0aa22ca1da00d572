#include "experiments/analysis/baseline.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <numeric>
#include <set>
#include <tuple>

#include "experiments/matrix/toml_keys.h"
#include "experiments/results/hash.h"

namespace vislab {
namespace {

using namespace toml_keys;

constexpr std::string_view origin_line = "# Measured with: ";

bool is_modelled(const ResultCell& cell) { return cell.key.device.starts_with("modelled"); }

/// Do two runs of the cell give the same sets?
bool repeats(const ResultCell& cell) {
  return cell.repeatability != Repeatability::timing || is_modelled(cell) ||
         cell.key.device.find("synchronous=true") != std::string::npos;
}

BaselineName name_of(const ResultCell& cell) {
  return {cell.scene + ", " + cell.path + ", " + std::to_string(cell.key.viewport.width) + "x" +
              std::to_string(cell.key.viewport.height) + ", " + cell.key.device,
          cell.culler};
}

/// Enough to see a change; "" if no frame has any.
std::string hash_of_all(const ResultCell& cell, std::string CellFrame::*hash) {
  std::string all;
  bool any = false;
  for (const CellFrame& frame : cell.frames) {
    all += frame.*hash + "\n";
    any |= !(frame.*hash).empty();
  }
  return any ? hash_text(all).substr(0, 16) : "";
}

BaselineFacts facts_of(const ResultCell& cell) {
  BaselineFacts facts;
  facts["sets"] = hash_of_all(cell, &CellFrame::set);
  if (auto hash = hash_of_all(cell, &CellFrame::one_sided); !hash.empty()) {
    facts["one_sided"] = std::move(hash);
  }
  if (auto hash = hash_of_all(cell, &CellFrame::surface); !hash.empty()) {
    facts["surfaces"] = std::move(hash);
  }
  std::map<std::string, std::uint64_t> sums;
  for (const CellFrame& frame : cell.frames) {
    sums["submitted_triangles"] += frame.submitted_triangles;
    sums["draws"] += frame.draws;
    sums["pieces"] += frame.pieces;
    for (const auto& [counter, value] : frame.counters) sums[counter] += value;
  }
  for (const auto& [counter, sum] : sums) facts[counter] = std::to_string(sum);
  if (is_modelled(cell) && !cell.rounds.empty()) {
    const std::vector<double>& frames = cell.rounds.front().frame_ms;
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", std::accumulate(frames.begin(), frames.end(), 0.0));
    facts["clock_ms"] = text;
  }
  return facts;
}

bool is_whole_number(const std::string& text) {
  return !text.empty() && text.size() < 19 &&
         std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c) != 0; }) &&
         (text == "0" || text.front() != '0');
}

}  // namespace

Baseline baseline_of(std::span<const ResultCell> cells) {
  Baseline baseline;
  for (const ResultCell& cell : cells) {
    if (cell.status != ResultCell::Status::done || cell.key.replicate != 0) continue;
    if (repeats(cell)) baseline[name_of(cell)] = facts_of(cell);
  }
  return baseline;
}

std::string origin_of(std::span<const ResultCell> cells) {
  std::set<std::string> simd;
  std::map<std::string, std::set<std::string>> facts{{"embree", {}}, {"device", {}}};
  for (const ResultCell& cell : cells) {
    simd.insert(cell.key.simd);
    for (auto& [name, texts] : facts) {
      if (name == "device" && is_modelled(cell)) continue;  // the blocks' names say all of these
      if (const auto found = cell.context.find(name); found != cell.context.end()) {
        texts.insert(found->second);
      }
    }
  }
  std::string text;
  for (const std::set<std::string>& texts : {simd, facts.at("embree"), facts.at("device")}) {
    for (const std::string& one : texts) text += (text.empty() ? "" : "; ") + one;
  }
  return text;
}

std::string load_origin(const std::filesystem::path& file) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line) && line.starts_with('#');) {
    if (line.starts_with(origin_line)) return line.substr(origin_line.size());
  }
  return "unknown";
}

std::string to_toml(const Baseline& baseline, const std::string& origin) {
  std::string text =
      "# What the cullers answer in the matrix smoke (experiments/analysis/baseline.h): one line "
      "a\n"
      "# cell, hashes of all visible sets and sums of all counters. Written by 'vislab baseline "
      "--write'.\n" +
      std::string(origin_line) + origin + "\n";
  std::string block;
  for (const auto& [name, facts] : baseline) {
    if (name.block != block) {
      block = name.block;
      text += "\n[\"" + block + "\"]\n";
    }
    text += "\"" + name.culler + "\" = { ";
    const char* separator = "";
    for (const auto& [fact, value] : facts) {
      text += separator + fact + " = " + (is_whole_number(value) ? value : "\"" + value + "\"");
      separator = ", ";
    }
    text += " }\n";
  }
  return text;
}

Baseline load_baseline(const std::filesystem::path& path) {
  const std::string file = path.string();
  if (!std::filesystem::is_regular_file(path)) {
    throw InputError("there is no " + file + ": 'vislab baseline --write' makes it");
  }
  Baseline baseline;
  for (const auto& [block, node] : parse_file(path)) {
    const toml::table* const cells = node.as_table();
    if (cells == nullptr) {
      throw InputError(place(file, node) + ": write [\"SCENE, PATH, RESOLUTION, DEVICE\"]");
    }
    for (const auto& [culler, cell] : *cells) {
      const toml::table* const facts = cell.as_table();
      if (facts == nullptr) {
        throw InputError(place(file, cell) + ": a cell is written as \"CULLER\" = { sets = … }");
      }
      BaselineFacts& into = baseline[{std::string(block.str()), std::string(culler.str())}];
      for (const auto& [fact, value] : *facts) {
        if (const auto number = value.value_exact<std::int64_t>()) {
          into[std::string(fact.str())] = std::to_string(*number);
        } else if (const auto hash = value.value_exact<std::string>()) {
          into[std::string(fact.str())] = *hash;
        } else {
          throw InputError(place(file, value) + ": " + std::string(fact.str()) +
                           " must be a whole number or a text");
        }
      }
    }
  }
  return baseline;
}

Baseline without(const Baseline& baseline, const std::vector<std::string>& cullers,
                 const std::vector<std::string>& scenes, std::vector<BaselineName>& left_out) {
  Baseline rest;
  for (const auto& [name, facts] : baseline) {
    const bool is_left_out =
        std::ranges::find(cullers, name.culler) != cullers.end() ||
        std::ranges::any_of(scenes, [&, &block = name.block](const auto& scene) {
          return block.starts_with(scene + ", ");
        });
    if (is_left_out) {
      left_out.push_back(name);
    } else {
      rest[name] = facts;
    }
  }
  return rest;
}

std::vector<BaselineChange> changes(const Baseline& before, const Baseline& now) {
  std::vector<BaselineChange> all;
  for (const auto& [name, facts] : before) {
    const auto found = now.find(name);
    if (found == now.end()) {
      all.push_back({name, "", "a cell", ""});
      continue;
    }
    BaselineFacts both = facts;
    both.insert(found->second.begin(), found->second.end());
    for (const auto& [fact, value] : both) {
      const auto text_in = [&](const BaselineFacts& of) {
        const auto at = of.find(fact);
        return at == of.end() ? "" : at->second;
      };
      const std::string was = text_in(facts);
      const std::string is = text_in(found->second);
      if (was != is) all.push_back({name, fact, was, is});
    }
  }
  for (const auto& [name, facts] : now) {
    if (!before.contains(name)) all.push_back({name, "", "", "a cell"});
  }
  std::ranges::sort(all, [](const BaselineChange& a, const BaselineChange& b) {
    return std::tie(a.name, a.fact) < std::tie(b.name, b.fact);
  });
  return all;
}

}  // namespace vislab
