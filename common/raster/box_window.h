// What a box may cover of a window, and how near it may come: to be asked of depth buffers.
//
// Idea: the rectangle around the eight corners' window positions, and the nearness of the nearest
//   corner, both enlarged by what a graphics device may do to vertices (snapping) and depths
//   (rounding), so that the answer also holds for the image that the device draws.
// Guarantee: what lies in the box covers no pixel centre outside of the rectangle and nothing
//   nearer, in exact arithmetic and on a device that snaps to 1/256 pixel with 24 bits of depth or
//   a float.
// Limits: boxes that touch the near plane from beyond it, or that are not valid, are undecided.
// Cost: about 100 operations.
#pragma once

#include "common/geometry/bounds.h"
#include "common/raster/triangle_setup.h"

namespace vislab {

/// Pixels [x0, x1) x [y0, y1) in the image, not empty, and the greatest nearness.
struct BoxWindow {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  float nearness = 0.0F;

  friend bool operator==(const BoxWindow&, const BoxWindow&) = default;
};

enum class BoxPlace {
  outside,    // surely not in the image: covers no pixel, or lies before the near or behind the far
              // plane
  undecided,  // may cross the near plane: to be kept
  inside      // the window says where
};

/// `coverage`: centres takes the pixels whose centres may be covered; whole_pixels takes every
/// pixel that the box may touch, for a buffer whose pixels are not those of the final image.
BoxPlace project_box(const WindowTransform& window, const Aabb& box, Coverage coverage,
                     BoxWindow& out);

}  // namespace vislab
