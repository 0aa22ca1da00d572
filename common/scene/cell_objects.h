// Which objects reach into which cells, for scenes whose source does not say.
#pragma once

#include "common/scene/scene.h"

namespace vislab {

/// How far (metres) a surface may stay outside of a cell and still count as reaching into it: walls
/// lie in the planes of their cells, and coordinates are rounded.
inline constexpr double reach_slack_m = 1e-4;

/// Fills Cell::objects: an object is listed wherever one of its triangles, as built, comes into one
/// of the cell's regions. Objects that reach into no cell are in no list. O(n log n) for n regions
/// and objects, and a clipping for each triangle near a region.
void list_objects_of_cells(Scene& scene);

}  // namespace vislab
