// How many samples of a box pass the depth test: what a graphics device's occlusion query counts.
//
// Idea: the box's faces that are seen from the front cover its outline once. Each is set up like
//   any plane quadrilateral, and compared with the depth buffer by tiles: headers decide tiles that
//   are wholly hidden or wholly seen, the others are compared pixel by pixel.
// Guarantee: the pixels of SetupTriangle::covers whose nearness_at is the buffer's or greater:
// equal
//   depths pass. The same count on every instruction set and in every build.
// Limits: for buffers with Coverage::centres. What a box has before the near plane is clipped, so
//   that boxes that hold the eye count nothing, as on a device.
// Cost: about a microsecond; then some ten operations a tile of its faces, and some hundred for a
//   tile that headers leave undecided.
// Source: own.
#pragma once

#include <cstdint>

#include "common/geometry/bounds.h"
#include "common/raster/tile_store.h"
#include "common/raster/window_transform.h"

namespace vislab {

struct BoxSamples {
  std::uint64_t covered = 0;  // of the image, by area (covered_area.h)
  std::uint64_t passed = 0;
  std::uint64_t outline_px = 0;  // widths and heights of its faces in sum (covered_area.h)

  friend bool operator==(const BoxSamples&, const BoxSamples&) = default;
};

/// `box` is of the world; a box that is not valid covers nothing. `window` is that of the buffer.
BoxSamples count_box_samples(const WindowTransform& window, const TileStore& tiles,
                             const Aabb& box);

}  // namespace vislab
