// Cells and portals of a Quake III world, found from its BSP tree.
//
// Idea: every leaf that is not solid is a convex cell, and where two of them touch is a portal.
//   Cells whose union is convex are joined, and so are small ones with the neighbour they touch
//   most: fewer cells and portals, and as good as nothing that was hidden behind a portal is lost.
//   Portals between the same two cells are joined where their union is convex.
// Limits: nothing here relies on cells being convex or portals being few; a world that leaks has a
//   portal for its crack.
// Cost: O(leaves log leaves) and a hull for each pair of joined portals.
// Source: Teller and Séquin 1991 for cells of a BSP tree; the portals of BSP compilers.
#pragma once

#include <vector>

#include "common/scene/quake_world.h"
#include "common/scene/scene.h"

namespace vislab {

struct QuakeCellLimits {
  bool join_convex = true;
  double smallest_m3 = 0.0;  // smaller cells are joined with a neighbour
};

struct QuakeCells {
  std::vector<Cell> cells;  // without objects
  std::vector<Portal> portals;  // two for each opening, one for each direction
  std::vector<CellId> cell_of_leaf;  // none_id: solid, or outside
};

QuakeCells find_quake_cells(const QuakeWorld& world, const Aabb& bounds,
                            const QuakeCellLimits& limits);

}  // namespace vislab
