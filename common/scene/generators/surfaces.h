// Small scenes on which algorithms for hidden surfaces disagree: polygons that go through each
// other, overlap in a ring, or nearly share a plane. Generators like the others (generators.h); the
// keys of a description's table `generator` are the members' names. All are flat polygons that face
// +z about the origin, to be seen from z > 0; each is an object of its own.
#pragma once

#include <cstdint>

#include "common/scene/scene.h"

namespace vislab {

struct CrossingQuadsParameters {
  double penetration = 0.5;  // 0: touch along an edge; 1: cross in the middle
  std::uint32_t pairs = 1;   // side by side along x
};

/// Pairs of quads of 2 m by 2 m. The first lies in the plane z = 0; the second, 0.25 m higher, runs
/// from z = 0.5 at its left edge to z = -0.5 penetration at its right edge.
Scene make_crossing_quads(const CrossingQuadsParameters& parameters);

struct CyclicBarsParameters {
  double tilt_deg = 10.0;
  double layer_m = 0.02;  // between the bars' middles along z, so that at no tilt they are a pile
};

/// Three bars of 2.4 m by 0.4 m in a triangle, each over the next at one end and under the third at
/// the other as soon as the tilt lifts the ends by more than the layers' distances.
Scene make_cyclic_bars(const CyclicBarsParameters& parameters);

struct TiltedPolygonsParameters {
  std::uint32_t count = 100;
  std::uint32_t corners = 4;  // of each
  double size_m = 0.5;        // radius of each
  double extent_m = 1.0;      // middles lie in the cube from -extent to extent
  std::uint64_t seed = 1;
};

/// Regular polygons in random places and orientations, through each other where they meet.
Scene make_tilted_polygons(const TiltedPolygonsParameters& parameters);

struct CoplanarPairParameters {
  double tilt_rad = 1e-4;
  std::uint32_t pairs = 8;  // in a row along x
  std::uint64_t seed = 1;
};

/// Pairs of squares of 1 m in planes that differ by the tilt only: the second is shifted by half
/// its width and turned about a random line of the first's plane through its own middle, so that
/// half of it lies before the first's plane and half behind it. Pairs are turned a little at
/// random, and every other one has its two squares in the other order.
Scene make_coplanar_pair(const CoplanarPairParameters& parameters);

struct ScanlineFenceParameters {
  std::uint32_t polygons = 100;  // that a scanline meets
  double overlap = 3.0;          // width of a slat, in distances between neighbours
  double width_m = 4.0, height_m = 2.0, depth_m = 1.0;
  std::uint64_t seed = 1;
};

/// Upright slats at random depths within depth_m, each a quad, that overlap in the image.
Scene make_scanline_fence(const ScanlineFenceParameters& parameters);

struct TouchingSpansParameters {
  double depth_difference_m = 0.01;  // between the left ends; 0: equal
  std::uint32_t pairs = 8;           // one above the other
};

/// Pairs of quads 1 m wide whose left edges, in the plane x = 0, cover each other for any eye in
/// that plane: the farther quad starts at z = 0 and recedes, the nearer starts at
/// z = depth_difference_m and comes forward. The nearer one hides the other wherever both are. In
/// every other pair it comes second.
Scene make_touching_spans(const TouchingSpansParameters& parameters);

}  // namespace vislab
