// Cells and portals of a Quake III world, found from its BSP tree.
//
// Idea: every leaf that is not solid is a convex cell, and where two of them touch is a portal.
//   For rooms, cells whose union is convex are joined, and so are small ones with the neighbour
//   they touch most: fewer cells and portals, and a little less is hidden. Portals between the same
//   two cells are joined where their union is convex.
// Limits: nothing here relies on cells being convex or portals being few; a world that leaks has a
//   portal for its crack, and its report says so. A tree whose leaves are not where the file says
//   that they are is refused.
// Cost: O(leaves log leaves) and a hull for each pair of joined portals.
// Source: Teller and Séquin 1991 for cells of a BSP tree; the portals of BSP compilers.
#pragma once

#include <vector>

#include "common/scene/quake_world.h"
#include "common/scene/scene.h"

namespace vislab {

struct QuakeCells {
  std::vector<Cell> cells;           // without objects
  std::vector<Portal> portals;       // two for each opening, one for each direction
  std::vector<CellId> cell_of_leaf;  // none_id: solid, or outside
  QuakeReport report;
};

/// Throws InputError, to go on from the file's name, for a leaf that is not solid and whose shape
/// is not that of its box.
QuakeCells find_quake_cells(const QuakeWorld& world, const Aabb& bounds,
                            const QuakeCellLimits& limits);

/// Gives a scene of the world's objects, which is not finished yet, its cells and portals, and the
/// cells their objects: those that reach into any of their leaves. Objects that reach into no open
/// leaf, and brush models, are in no cell. Writes down the cell of each leaf, and the report.
void add_quake_cells(Scene& scene, QuakeWorld& world, const QuakeCellLimits& limits);

}  // namespace vislab
