// Which rows of the failure atlas (F1, F2, …) and which cullers have a stress sweep, and why the
// others have none.
//
//   entries = 79                   rows of the atlas
//   [[without]]
//   failure = "F13"
//   because = "…"                  why there is no sweep
//   [[culler]]
//   name = "portal.map_pvs"        a culler that stands in no sweep
//   because = "…"                  why
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "experiments/matrix/sweep.h"

namespace vislab {

struct AtlasCoverage {
  std::size_t entries = 0, with_sweep = 0;
  /// Rows without a sweep and the reason, in the atlas' order.
  std::vector<std::pair<std::string, std::string>> without;

  std::vector<std::pair<std::string, std::string>>
      cullers_without;  // likewise, in the file's order

  /// "76 of 79 entries of the failure atlas have a sweep; without: F13 (…), …; cullers
  /// without: …"
  std::string text() const;
};

/// Throws InputError if the file is wrong, if a sweep names a row that the atlas does not have, if
/// a row has both a sweep and a reason, or neither, or a culler both.
AtlasCoverage atlas_coverage(const std::vector<Sweep>& sweeps, const std::filesystem::path& file);

}  // namespace vislab
