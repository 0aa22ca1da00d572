// Stress sweeps: TOML files of one failure mode each, with one dial that goes from benign to
// adversarial.
//
//   description = "…"
//   failure = "F1"                 row of the failure atlas
//   extends = "box_edge"           optional: a sweep of the lab whose keys stand where this file
//                                  has none, but for limit and expect: the same held to another
//                                  limit, which measures nothing anew
//   cullers = ["frustum.flat", "frustum.octree[depth=${dial}]"]
//   optional_cullers = ["peer.bullet"]   left out, and said so, where this build does not have them
//   resolution = "128x128"         "${dial}x128" as well
//   frames = 8                     0 = as many as the path has
//   rounds, seed, threads, draw, timeout_s: as in a matrix
//   [dial]
//   name = "edge"
//   unit = "m"                     "" if it has none
//   values = [0.5, 1, …]           at least 8, ascending or descending: from benign to adversarial
//   [scene]                        what a file in data/scenes would say
//   [path]                         what a file in data/paths would say; left out: the scene's own
//   [limit]                        optional; the break point is the first value beyond it
//   metric = "over"                of `vislab list metrics` (default: false_px)
//   counter = "plane_tests"        instead of a metric: a counter of the methods, or of what they
//   ask
//                                  of the device (DeviceCounts), a frame
//   at_most = 0.5                  or
//   at_most_ratio = 2.0            times the figure at the dial's first value, or
//   at_least = 0.5                 for metrics that are better when higher, and only for them
//   against = "frustum.flat"       an entry of `cullers`: figures are shares of its figure at the
//                                  same value (1 = as much); needs at_most
//   [[expect]]
//   culler = "frustum.*"           pattern for entries of `cullers`, as they are written there
//   breaks = "never"               or [4, 16]: the break point is one of the values in this range
//   source = "…"                   who reports the failure; the range is this lab's prediction
//   because = "…"                  what the range follows from, in one sentence
//   hindsight = "…"                optional: why it may come out otherwise all the same, without
//                                  figures; told only where it does
//
// In the scene, the path, the cullers, the resolution, the seed and draw "${dial}" stands for the
// dial's value: alone in its quotes for the number, within a longer text for its digits.
//
// Without at_most and at_most_ratio the limit is: for false_px none at all, for approximate methods
// 1 % of the pixels compared; for over, over_objects and times twice the first value; for all
// others 0.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/culler/registry.h"
#include "experiments/matrix/matrix.h"

namespace vislab {

struct SweepDial {
  std::string name, unit;
  std::vector<double> values;
  std::vector<std::string> texts;  // the values in digits

  /// "edge = 4 m"
  std::string setting(std::size_t value) const;
};

struct SweepLimit {
  std::string metric = "false_px";  // or the name of a counter
  bool is_counter = false;
  std::optional<double> at_most, at_most_ratio;  // at most one of them; none: by the metric
  std::optional<std::size_t> against;  // figures are shares of this method's at the same value
  std::optional<double> at_least = std::nullopt;  // the metric is better when higher
};

struct SweepExpectation {
  std::string culler;  // pattern
  bool never = true;   // it does not break; else it breaks at a value within [low, high]
  double low = 0.0, high = 0.0;
  std::string source, because;
  std::string hindsight = {};  // "": nothing is known
};

/// One of the sweep's cullers.
struct SweepMethod {
  std::string culler;               // as written; "${dial}" by the dial's name in angle brackets
  std::vector<std::string> chains;  // canonical, one for each value of the dial
  std::optional<SweepExpectation> expectation;
};

struct SweepFile {
  std::filesystem::path file;
  std::string text;
};

struct Sweep {
  std::string name, description, failure;
  SweepDial dial;
  SweepLimit limit;
  std::vector<SweepMethod> methods;
  std::vector<std::string> absent;  // optional cullers that this build does not have, as written
  /// Values of the dial that leave scene, path, resolution, seed and device alike share a block.
  std::vector<Block> blocks;
  std::vector<std::size_t> block_of_value;
  /// The scenes and paths that the blocks name, and of a sweep that is not the lab's own its text.
  /// Nothing is written until write_sweep_files().
  std::vector<SweepFile> files;
  /// For each value what its answers depend on, but for the methods: hash of the texts of scene and
  /// path, resolution, frames, seed, device.
  std::vector<std::string> conditions;

  /// "false_px", "plane_tests a frame", "frame_ms ÷ that of frustum.flat"
  std::string figure_name() const;
};

/// `name_or_file` is NAME of `folder`/NAME.toml, or a file. The blocks' scenes and paths are files
/// below `results`/stress/NAME. Throws InputError that names file, line or key, and what would be
/// right. Cullers are checked at every value of the dial; scenes are not loaded. A file elsewhere
/// that is named like a sweep of `folder` is refused.
Sweep load_sweep(const std::string& name_or_file, const std::filesystem::path& folder,
                 const std::filesystem::path& results, const Registry& registry);

/// All sweeps of the folder, by failure and name.
std::vector<Sweep> load_sweeps(const std::filesystem::path& folder,
                               const std::filesystem::path& results, const Registry& registry);

/// The sweeps that are not in `folder` but were run into `results` from files elsewhere, as they
/// were then, by name. Throws InputError like load_sweep().
std::vector<Sweep> load_kept_sweeps(const std::filesystem::path& folder,
                                    const std::filesystem::path& results, const Registry& registry);

/// Names and descriptions of the sweeps in `folder`, sorted by name.
std::vector<std::pair<std::string, std::string>> list_sweeps(const std::filesystem::path& folder);

/// Does the file describe a sweep, not a matrix? False if it cannot be read.
bool is_sweep_file(const std::filesystem::path& file);

/// Each under a temporary name that is then renamed; files that are as they should be are left
/// alone. Throws InputError if that fails.
void write_sweep_files(const Sweep& sweep);

}  // namespace vislab
