// A large rectangle of pixels inside of the convex hull of points in a window.
//
// Idea: in a convex region the lowest and the highest row that are free over a range of columns
//   are those at its first or its last column. So the rectangle over any two columns is known from
//   these two, and the largest is sought over pairs of a few columns.
// Guarantee: every pixel centre of the rectangle lies inside of the hull by snapping_margin_px,
// which
//   is more than a device can move an edge by.
// Limits: not the largest of all, but of those that begin and end at the hull's corners or at
//   eighths of its width. In a city, it is within some percent of it.
// Cost: O(n log n) for the hull, and 200 to 400 comparisons.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "common/raster/box_window.h"

namespace vislab::depth_culling {

/// `points` are window positions in pixels and are put into another order. False if no pixel is
/// covered. The nearness of `out` is left as it is.
bool largest_covered(std::span<glm::dvec2> points, const Viewport& viewport, BoxWindow& out);

}  // namespace vislab::depth_culling
