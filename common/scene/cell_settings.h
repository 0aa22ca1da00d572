// Cells and portals written by hand in a scene's description.
//
// A table `[[cells]]` is either `boxes` = [[x, y, z], [x, y, z], …], the lower and the upper corner
// of each axis-aligned box in turn, or one convex region by its planes: `through` = a point on each
// and `inward` = a vector for each that points into the region. A cell's number is its place in the
// list, from 0.
//
// A table `[[portals]]` has `from`, `to` and `corners` = [[x, y, z], …], convex, in one plane (to
// cell_tolerance_m) and counter-clockwise seen from cell `from`. Corners on a straight edge are
// allowed, and of corners that repeat the one before one stays. It is both ways: a second portal
// leads back.
#pragma once

#include <vector>

#include "common/scene/scene.h"
#include "common/scene/settings.h"

namespace vislab {

struct DescribedCells {
  std::vector<Cell> cells;  // without objects
  std::vector<Portal> portals;
};

/// Reads the lists `cells` and `portals` of a description if it has them. Throws InputError.
DescribedCells read_cells(const Settings& scene);

}  // namespace vislab
