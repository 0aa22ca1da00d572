// data/knees.toml: the knees that the cullers' defaults were chosen by, and what they were found
// from.
//
//   [[knee]]
//   dial = "octree depth"
//   culler = "frustum.octree"
//   parameter = "depth"
//   default = "6"                  as the culler declares it
//   knee = "6"                     the common knee of all scenes
//   note = "…"                     why they differ, or what else is to be known; may be left out
//   sweep = "octree_depth"         of experiments/model_size
//   cost = "decision_us"           what its speed is measured by
//   machine = "…"                  the processor that measured it
//   date = "2026-11-23"            when; several days with commas between them
//   regenerate = "…"               the commands that make this entry again
//   [[knee.scene]]
//   scene, path                    where it was measured
//   knee, best                     values of the dial
//   efficiency, bytes, build_ms, wrong_pixels, over     at the default
//   of_best                        efficiency / that of the best value
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/analysis/knees.h"

namespace vislab {

/// What the file says of one culler's parameter.
struct CommittedKnee {
  std::string dial, culler, parameter, default_value, knee, note, sweep, machine, date;
  std::vector<std::string> scenes;
};

/// The text of the file for complete results. Throws InputError that names the sweeps that are not
/// complete, and what is missing first.
std::string knees_text(const std::vector<SizeResult>& results);

/// Throws InputError that names file, line or key, and what would be right.
std::vector<CommittedKnee> read_knees(const std::filesystem::path& file);

}  // namespace vislab
