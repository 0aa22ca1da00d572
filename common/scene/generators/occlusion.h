// Scenes whose dials say how much hides what. Like all generators': the same everywhere for the
// same parameters, y up, metres, not finished yet (Scene::finish). The keys of a description's
// table `generator` are the members' names.
#pragma once

#include <cstdint>

#include "common/scene/scene.h"

namespace vislab {

struct SlitWallParameters {
  double gap_m = 0.5;       // of the widest slit; 0: no slit, the panels abut
  double ratio = 0.3;       // of a slit's width to that of the one on its left
  std::uint32_t slits = 5;  // equally spaced
  double width_m = 40.0;    // of the wall, along x
  double height_m = 10.0;   // from the ground up
  double thickness_m = 0.2;
  double target_distance_m = 10.0;        // from the wall back to the targets
  std::uint32_t columns = 60, rows = 10;  // of targets, cubes of 0.25 m half size
};

/// A wall in the plane z = 0, of one box between two slits each, and a lattice of small cubes
/// behind it (at negative z), as wide and as high as the wall. Panels come first.
Scene make_slit_wall(const SlitWallParameters& parameters);

struct LatticeWallParameters {
  double coverage = 0.5;                     // share of the wall that is not holes, above 0
  std::uint32_t cells_x = 40, cells_y = 20;  // a hole each, in its middle
  double width_m = 40.0, height_m = 20.0;
  double target_distance_m = 10.0;
  std::uint32_t columns = 60, rows = 20;  // of targets, as behind a slit wall
};

/// A sheet without thickness in the plane z = 0, one object, that faces +z, with square holes like
/// the mask of a texture; targets as of the slit wall. The sheet's box is as large with holes as
/// without.
Scene make_lattice_wall(const LatticeWallParameters& parameters);

enum class DrawOrder { near_first, far_first, shuffled };

struct LayeredTilesParameters {
  std::uint32_t layers = 3;
  DrawOrder order = DrawOrder::near_first;  // of the slats' numbers, and so of their submission
  std::uint32_t slats = 40;                 // of each layer
  double overlap = 0.1;                     // of a slat with its neighbours, in its own width
  std::uint32_t columns = 60, rows = 20;    // of targets
  std::uint64_t seed = 1;                   // of the shuffled order
};

/// Upright boxes in layers one behind the other, 10 m to 30 m before the origin along -z, whose
/// gaps are as wide as the slats of all the other layers: seen from the origin, only all layers
/// together close the view. Where a tile of the image is wider than a slat it holds `layers`
/// depths. Targets stand behind. Slats come first.
Scene make_layered_tiles(const LayeredTilesParameters& parameters);

struct MovingWallParameters {
  double width_m = 20.0, height_m = 12.0, thickness_m = 0.3;
  std::uint32_t targets = 2000;  // cubes of 0.25 m to 0.5 m half size
  std::uint64_t seed = 1;
};

/// A wall about the origin, object 0, and targets strewn over 60 m by 40 m and up to 10 m high
/// behind it (z from -45 to -5). It is the path that moves or hides the wall (motion.h).
Scene make_moving_wall(const MovingWallParameters& parameters);

struct OpenFieldParameters {
  std::uint32_t count = 10'000;
  double spacing_m = 3.0;            // at least 8 half sizes, of which 4 are then always free
  double half_size_m = 0.3;          // of the largest; the smallest have 0.7 of it
  std::uint32_t min_triangles = 12;  // of a box
  std::uint64_t seed = 1;
};

/// Boxes that lie on the plane y = 0 in a square of about sqrt(count) rows, each shifted a little
/// at random by up to half_size_m. Seen from 27 degrees above the ground on, none hides a part of
/// another: a box's shadow is less than 4 half sizes long.
Scene make_open_field(const OpenFieldParameters& parameters);

struct ScreenedRingParameters {
  double hidden = 0.5;               // share of the sectors that are hidden
  std::uint32_t sectors = 40;        // at least 8
  std::uint32_t objects = 60;        // of a sector, beside its screen
  std::uint32_t min_triangles = 12;  // of an object; a screen has 12
  std::uint32_t all_triangles = 0;   // of all objects together, or more
  std::uint64_t seed = 1;
};

/// Sectors of a circle about the origin, each with one screen and with cubes 10 m to 60 m off. The
/// screens of the share `hidden`, spread evenly, stand before the cubes, 8 m from the origin, and
/// those of the others behind, at 80 m and as much larger: seen from the origin, and up to about
/// 0.2 m beside it, the cubes of a sector are all hidden or all seen, and no cube hides another.
/// A cube has its share of `all_triangles`, but not fewer than min_triangles.
/// The cubes do not depend on `hidden`, nor does how many pixels a screen covers. Screens come
/// first.
Scene make_screened_ring(const ScreenedRingParameters& parameters);

/// Where covers hide bars from, metres along +z from the bars' plane.
inline constexpr double covered_bars_eye_m = 70.0;

struct CoveredBarsParameters {
  double angle_deg = 0.0;  // of the bars to the x axis
  std::uint32_t columns = 8, rows = 8;
  std::uint32_t min_triangles = 1200;  // of a bar
};

/// Bars of 8 m by 0.4 m by 0.4 m in the plane z = 0, 9 m apart and all turned by an angle about z,
/// each behind a cover of the same shape, 0.15 m larger all round. From (0, 0, covered_bars_eye_m)
/// and up to 5 m beside it no bar is seen, whatever the angle; the larger it is, the farther a
/// bar's axis-aligned box reaches beyond its cover. Covers come first.
Scene make_covered_bars(const CoveredBarsParameters& parameters);

struct PlantParameters {
  double occlusion = 0.7;  // 0: bare frames and pipes; 1: all machines boxed, all bays walled
  std::uint32_t bays_x = 24, bays_z = 12;
  std::uint32_t segments = 8;  // round a pipe; a coil has about 24 segments^2 triangles
  std::uint32_t min_triangles =
      12;                   // of every mesh: boxes and pipes are cut into more, coils rounder
  bool small_parts = true;  // frames, parts and barrels; without them stands the same, only less
  std::uint64_t seed = 1;
};

/// A hall of bays of 8 m by 8 m; between rows lie aisles of 3 m, one of them in the plane z = 0 if
/// there is an even number of rows. In each bay stands a machine (frame, coil and small parts)
/// with pipes; a share `occlusion` of the machines is in a casing, and of the bays' sides to the
/// aisles and to each other in walls. With a larger `occlusion` the same stands where it stood,
/// and more is in front of it. Aisles are free from the ground up, and so are 4 m round the hall.
Scene make_plant(const PlantParameters& parameters);

/// A prism along y from -1 to 1 of radius 1, cut across into `pieces`; closed. 2 segments pieces +
/// 2 (segments - 2) triangles.
Mesh pipe_mesh(std::uint32_t segments, std::uint32_t pieces = 1);

/// A pipe of radius `pipe_radius_m` wound `turns` times round the y axis at radius 1, rising from y
/// = -1 to 1, with `segments` edges round the pipe and 4 segments steps in each turn, closed by
/// caps. 8 turns segments^2 + 2 (segments - 2) triangles.
Mesh coil_mesh(std::uint32_t segments, double turns, double pipe_radius_m);

}  // namespace vislab
