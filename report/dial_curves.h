// Curves over dials: cells of one chain that differ in the value of one numeric parameter only.
#pragma once

#include <string>
#include <vector>

#include "experiments/analysis/summary.h"

namespace vislab {

struct DialCurve {
  std::string name;                 // the short name without the dial: "occlusion.chcpp"
  std::string parameter;            // "batch"
  std::vector<std::size_t> cells;   // places in what was given, by ascending value of the dial
  std::vector<std::string> values;  // of the dial, one a cell
};

/// All curves of at least two cells, those with the most cells first, then by name and parameter. A
/// cell may lie on several. Anchors and repeated measurements lie on none. O(cells × parameters).
std::vector<DialCurve> dial_curves(const std::vector<const CellSummary*>& cells);

}  // namespace vislab
