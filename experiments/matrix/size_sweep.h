// Sweeps over the size of a model: TOML files that turn one dial of a model's size (how deep a tree
// is, how large a cluster, how wide a buffer) from the smallest model to the largest, on several
// scenes each.
//
//   description = "…"
//   dial = "octree depth"          how the report calls it; several files may turn the same dial
//   unit = "levels"                "" or left out if it has none
//   cullers = ["frustum.octree[depth=${dial}]", …]   each with "${dial}" for one parameter
//   values = [0, 1, 2, …]          numbers or texts, from the smallest model to the largest; the
//                                  cullers' defaults must be among them
//   cost = "frame_ms"              what speed is measured by, see SizeCost
//   because = "…"                  why by that, in one sentence
//   resolution, rounds, seed, threads, draw, timeout_s: as in a matrix
//   frames = 8                     of each path; not 0
//   [[scenes]]                     at least two
//   scene = "city"
//   path = "city_fast"             left out: the scene's own
//   frames = 4                     optional: instead of the above
//   [[notes]]
//   culler = "frustum.octree"      name of one of the cullers
//   text = "…"                     what is to be known of its default
//   [[off_knee]]                   only for a default that cannot be the knee
//   culler = "frustum.octree"
//   because = "…"                  why it is the default nevertheless
//
// Each scene is a block as in a matrix, with its anchors, and its cells are cells like any other.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "experiments/matrix/matrix.h"

namespace vislab {

/// What speed is measured by. Efficiency is another's cost / this one's:
enum class SizeCost {
  frame_ms,           // the oracle's of the same level, paired: what a frame takes
  modelled_frame_ms,  // the oracle's: deciding, and drawing at calibrated costs
  decision_us,        // the least of all values: update and cull; where nothing is drawn
};
std::string to_string(SizeCost cost);

/// One culler of a sweep.
struct SizeMethod {
  std::string culler;               // name, without parameters
  std::string parameter;            // the one that the dial turns
  std::vector<std::string> chains;  // canonical, one for each value
  std::size_t default_value = 0;    // by index: what the culler declares
  std::string note, off_knee;       // off_knee: why the default is not the knee; else ""
};

struct SizeSweep {
  std::string name, description, dial, unit, because;
  SizeCost cost = SizeCost::frame_ms;
  std::vector<std::string> values;  // as parameters are written
  std::vector<SizeMethod> methods;
  std::vector<Block> blocks;  // one a scene, every value of every method in each

  /// "6 levels"
  std::string setting(std::size_t value) const;
};

/// `name_or_file` is NAME of `folder`/NAME.toml, or a file. Throws InputError that names file, line
/// or key, and what would be right. Scenes are not loaded.
SizeSweep load_size_sweep(const std::string& name_or_file, const std::filesystem::path& folder,
                          const Registry& registry);

/// All of the folder, by name; none if there is no such folder.
std::vector<SizeSweep> load_size_sweeps(const std::filesystem::path& folder,
                                        const Registry& registry);

}  // namespace vislab
