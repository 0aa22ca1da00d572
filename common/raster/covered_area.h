// How many samples of an image a triangle covers, for what counts the work of filling them.
//
// Idea: the area of the snapped triangle within the image, which is the number of samples on
//   average. Twice the area is a whole number of squares of the grid for what lies wholly within
//   the image; what may leave it is cut to the image in double, and rounded.
// Guarantee: the same number on every instruction set and in every build, and, since numbers are
//   whole, sums do not depend on the order.
// Limits: for Coverage::centres with depths that are not lowered. Triangles that hold no sample's
// centre were dropped before and do not count, so that
//   small ones count a little too little in sum.
// Cost: a few operations; some 200 for triangles in the image's outermost tiles.
#pragma once

#include <cstdint>

#include "common/geometry/camera.h"
#include "common/raster/triangle_block.h"

namespace vislab {

/// Of what covered_area gives, in a sample.
inline constexpr std::int64_t covered_units = 2 * 256 * 256;

/// Of a triangle or convex quadrilateral, in units of covered_units.
std::int64_t covered_area(const SetupTriangle& triangle, const Viewport& image);
/// Of a lane of a block; 0 for lanes without a triangle.
std::int64_t covered_area(const TriangleBlock& block, std::size_t lane, const Viewport& image);

/// Width and height of a triangle, at most the image's, in sum; of a convex quadrilateral those of
/// the two triangles that it is made of. How many blocks of samples are covered in part goes with
/// it. In units of outline_units a pixel; 0 for lanes without a triangle.
inline constexpr std::int64_t outline_units = 256;
std::int64_t outline(const SetupTriangle& triangle, const Viewport& image);
std::int64_t outline(const TriangleBlock& block, std::size_t lane, const Viewport& image);

/// Rounded to the next whole number of samples.
inline std::uint64_t samples_of_area(std::int64_t area) {
  return static_cast<std::uint64_t>((area + covered_units / 2) / covered_units);
}

}  // namespace vislab
