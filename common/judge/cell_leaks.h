// Do surfaces and portals close a scene's cells? A cell leaks where one sees out of it, and not
// through a portal: what is seen there no walk through portals finds.
//
// Idea: rays from random points of each cell in random directions. A ray that leaves its cell
//   without having met a surface must pass one of the cell's portals.
//   Points inside of closed objects are no places to look from; a cell that lies in one, as in a
//   closed hull, is not checked, and is counted as such.
// Guarantee: every leak that is counted is one, but for surfaces and portals that miss the cell's
//   boundary by less than a millimetre. Small leaks are found by chance.
// Cost: one traced ray each, the cell's planes and portals, and what else the ray would hit if the
//   scene has closed meshes.
#pragma once

#include <cstdint>

#include "common/scene/cell_check.h"
#include "common/scene/scene.h"

namespace vislab {

struct CellLeaks {
  std::size_t rays = 0;
  std::size_t rays_inside_objects = 0;  // not looked along, and not among `rays`
  CellFault leaks;                      // rays; the place is where the first one leaves `cell`
  std::size_t leaking_cells = 0;
  // Most of whose rays begin inside of objects, and those from which there is none.
  std::size_t unchecked_cells = 0;
  CellId first_unchecked = none_id;
};

/// `rays_per_cell` rays from every cell that has a region; the scene as built. A ray that leaves a
/// cell and meets nothing afterwards is no leak: nothing is seen along it. The same answers for the
/// same seed, on any number of threads.
CellLeaks find_cell_leaks(const Scene& scene, std::size_t rays_per_cell, std::uint64_t seed);

}  // namespace vislab
