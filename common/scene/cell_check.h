// Do a scene's cells and portals fit together? What walks through portals rely on.
//
// Idea: two cells overlap where regions of theirs share a convex body, which is found by cutting
//   their planes' polygons; a portal is tried at points of its polygon, which must lie in both of
//   its cells and have each on the right side.
// Limits: whether surfaces close the cells is a question to rays (judge/cell_leaks.h).
// Cost: O(n log n) for n regions, and O(planes^2) for each pair whose boxes overlap.
#pragma once

#include <cstddef>

#include "common/scene/scene.h"

namespace vislab {

/// Shallower overlaps and gaps, and corners nearer to their portal's plane, are rounding, metres.
/// Descriptions are read and checked with it. Walks through portals rely on it: what lies in a cell
/// reaches no farther beyond its planes for them (region_slack_m in algorithms/portal).
inline constexpr double cell_tolerance_m = 1e-4;

/// One kind of fault: how often, and the first.
struct CellFault {
  std::size_t count = 0;
  CellId cell = none_id, other = none_id;
  glm::dvec3 place{0.0};
};

struct CellCheck {
  CellFault overlaps;  // pairs of cells that share a body
  CellFault gaps;      // portals behind which, or before which, there is no cell
  CellFault off;       // portals that are not on their cells' common boundary, or face backward
};

/// A scene without cells has no fault.
CellCheck check_cells(const Scene& scene);

}  // namespace vislab
