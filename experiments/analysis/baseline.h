// What cells answered, short enough to be committed, and how it differs from what is answered now.
//
//   ["city_tiny, city_street, 128x128, osmesa"]
//   "frustum.flat" = { sets = "b0c7…", submitted_triangles = 4711, draws = 60, … }
//
// One line a cell: a hash of all frames' sets, and sums of all counters over the frames. Times are
// no part of it, except on modelled devices, whose clock repeats; nor is anything of methods whose
// answers depend on time. Methods go by their short names: a default that changes is a change of
// answers.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "experiments/results/cell.h"

namespace vislab {

struct BaselineName {
  std::string block;   // "city_tiny, city_street, 128x128, osmesa"
  std::string culler;  // short name of the chain
  auto operator<=>(const BaselineName&) const = default;
};

/// By name of the fact: a number or a hash, as text.
using BaselineFacts = std::map<std::string, std::string>;
using Baseline = std::map<BaselineName, BaselineFacts>;

/// Of all cells that are done and whose answers repeat, the A/A control left out.
Baseline baseline_of(std::span<const ResultCell> cells);

/// What the cells were measured with, in a line: instruction sets that the kernels ran with, the
/// ray caster and the renderer. Answers are the same whatever it is, as far as is known; where they
/// are not, it says where to look first.
std::string origin_of(std::span<const ResultCell> cells);

/// TOML text, and back. `origin` becomes a line at the head that is no part of the answers.
/// load_baseline throws InputError that names file and line, and what would be right.
std::string to_toml(const Baseline& baseline, const std::string& origin);
/// The line at the head of the file; "unknown" if it has none.
std::string load_origin(const std::filesystem::path& file);
Baseline load_baseline(const std::filesystem::path& file);

/// Without what cannot be compared: cells with one of `cullers`, which the build lacks, or of one
/// of `scenes`, which are not fetched (both by their names in the baseline). `left_out` gets their
/// names.
Baseline without(const Baseline& baseline, const std::vector<std::string>& cullers,
                 const std::vector<std::string>& scenes, std::vector<BaselineName>& left_out);

/// One fact that is not as it was; "" where there is none.
struct BaselineChange {
  BaselineName name;
  std::string fact;  // "" if the whole cell is new or gone
  std::string before, now;
};

/// Sorted by block, culler and fact.
std::vector<BaselineChange> changes(const Baseline& before, const Baseline& now);

}  // namespace vislab
