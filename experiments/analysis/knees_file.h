// data/knees.toml: the knees that the cullers' defaults were chosen by, and what they were found
// from.
//
//   [[knee]]
//   dial = "octree depth"
//   culler = "frustum.octree"
//   parameter = "depth"
//   chain = "frustum.octree[…]"    the culler as it is by default, with all parameters
//   default = "4"                  as the culler declares it
//   knee = "3"                     the common knee of all scenes
//   may_be_knee = ["3", "4"]       all values that may be it, as far as the intervals tell
//   off_knee = "…"                 why the default is none of these; only if it is none
//   note = "…"                     what else is to be known of the default; may be left out
//   sweep = "octree_depth"         of experiments/model_size
//   cost = "decision_us"           what its speed is measured by
//   cpu, compiler, revision        what measured it ("+": with changes since that revision)
//   date = "2026-11-23"            when; several days with commas between them
//   rounds, threads                how
//   regenerate = "…"               the commands that make this entry again
//   [[knee.scene]]
//   scene, path                    where it was measured
//   knee, best                     values of the dial
//   default_of_best                efficiency at the default / that of the best value, with
//   default_of_best_low, …_high    its interval (95 %)
//   default_efficiency, default_bytes, default_build_ms, default_wrong_pixels, default_over
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "experiments/analysis/knees.h"

namespace vislab {

/// What the file says of one culler's parameter.
struct CommittedKnee {
  std::string dial, culler, parameter, chain, default_value, knee, note, off_knee, sweep;
  std::vector<std::string> may_be_knee;
  std::map<std::string, std::string> provenance;  // as SizeResult has it
  std::vector<std::string> scenes;
};

/// The text of the file for complete results. Throws InputError that names the sweeps that are not
/// complete, and what is missing first.
std::string knees_text(const std::vector<SizeResult>& results);

/// Throws InputError that names file, line or key, and what would be right.
std::vector<CommittedKnee> read_knees(const std::filesystem::path& file);

}  // namespace vislab
