// Buildings of rooms with their cells and portals: a line, a grid, a house of several storeys. Like
// all generators': the same everywhere for the same parameters, y up, metres, not finished yet
// (Scene::finish).
//
// Walls and floors are closed boards with thickness, one between two rooms each, that reach into
// each other: no ray finds a gap. A room is a cell, whose regions are its inner box and its half of
// every opening in its walls and floors; where two halves meet, in the board's middle, is the
// portal.
#pragma once

#include <cstdint>

#include "common/scene/scene.h"

namespace vislab {

enum class Windows {
  none,     // the outer walls are whole
  nothing,  // open, and no portal: nothing stands outside
  outside   // open, and each a portal to a cell around the house, with ground and boxes in it
};

/// The keys of a description's table `generator` are the members' names, but for `rows` of a line,
/// which is `rooms` there.
struct RoomsParameters {
  std::uint32_t columns = 1, rows = 6, storeys = 1;
  double width_m = 5.0, depth_m = 5.0, height_m = 3.0;  // of a room inside: along x, z and y
  double variation = 0.0;     // columns and rows are so much wider or narrower at random, a share
  double wall_m = 0.25;       // thickness of walls and floors
  std::uint32_t portals = 1;  // doors side by side between two rooms that have any: 0 to 8
  double door_width_m = 1.0, door_height_m = 2.0;  // narrower where many do not fit
  double door_roll_deg = 0.0;                      // of the doors in their walls, 0 to 45
  double door_shift_m = 0.0;  // of the doors along their walls, at most, at random
  double doors = 1.0;         // share of the neighbours with doors beside those that join all
  double open = 1.0;          // share of the doors that are; a closed one is filled and no portal
  double crack_m = 0.0;       // width of an upright crack in every inner wall; 0: none
  bool crack_portal = true;   // the crack is a portal; else the cells do not know of it
  double overlap_m = 0.0;     // by which two cells share every opening between them
  Windows windows = Windows::none;
  std::uint32_t boxes_per_room = 4;         // at most 20, in the rooms' corners
  std::uint32_t box_triangles = 12;         // of each, or more
  std::uint32_t small_things_per_room = 0;  // boxes of 2 to 6 cm, on the floor by two of the walls
  std::uint64_t seed = 1;
};

/// Column c and row r of storey s is cell (s * rows + r) * columns + c; a cell outside comes last.
/// Rows run along -z, and the middle of the wall between the first two is the plane z = 0; columns
/// run along x and are symmetric about x = 0 unless they vary; the lowest floor is y = 0. Doors are
/// 0.02 m above the floor, in the middle of their walls or, if there are several, in equal parts of
/// it, of which a crack is the last. Storeys are joined by an opening of 1.4 m by 1.4 m in the
/// floor, in the middle of a room that differs from storey to storey. A smaller share of doors, or
/// of open ones, has a part of the same. Throws InputError where doors do not fit into the walls.
Scene make_rooms(const RoomsParameters& parameters);

}  // namespace vislab
