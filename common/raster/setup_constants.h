// The numbers of triangle set-up that its scalar and its SIMD form share.
#pragma once

#include <cstdint>

namespace vislab::setup {

inline constexpr int subpixels = 256;
// Steps of the grid by which edges are moved inward. For whole pixels half a pixel and the step
// that snapping takes. At the image's border a device may clip a triangle before it snaps, so that
// an edge runs up to a step beside ours: where depths have to be safe, edges of what leaves the
// image stay within.
inline constexpr int whole_pixel_inset = subpixels / 2 + 1;
inline constexpr int border_inset = 1;
inline constexpr double greatest_position = 32'768.0;  // pixels
// A determinant below this part of its terms is rounding: the triangle is seen edge-on.
inline constexpr double least_determinant = 1e-9;
inline constexpr double greatest_terms = 1e300;
// Of the terms of a plane's equation: what rounding to float, sums of three and a determinant
// that is just not edge-on can do, and some more.
inline constexpr double plane_error = 1.0 / 524'288.0;
// Planes beyond have no finite values as float.
inline constexpr double greatest_plane = 1e30;

/// Of the pixels whose centres lie in [low, high] (grid units): the first, and one after the last.
constexpr std::int32_t first_centre(std::int32_t low) {
  return (low - subpixels / 2 + subpixels - 1) >> 8;
}
constexpr std::int32_t after_last_centre(std::int32_t high) {
  return ((high - subpixels / 2) >> 8) + 1;
}

}  // namespace vislab::setup
