// Whether a box is hidden where it is really seen: its silhouette and its own depths, pixel by
// pixel, for boxes whose rectangle a depth buffer leaves visible.
//
// Idea: a ray enters a box through the last of the three slabs that it enters, and leaves it with
//   the first that it leaves. Along a ray nearness grows the other way, and the nearness at which a
//   pixel's ray meets one of the box's six planes is linear in the window. So a pixel can show the
//   box only if the least of the planes of entry is nearer than the greatest of the planes of exit,
//   and not nearer than that least value.
// Guarantee: as project_box, for each pixel: the box is enlarged by snapping_margin_px at its
// farthest depth
//   before its planes are made, and nearness by the device's margin. Hidden means that nothing in
//   the box can be seen.
// Limits: as project_box: for boxes that lie wholly behind the near plane. Slabs that are seen
//   edge-on by orthographic cameras do not count.
// Cost: about 100 operations, and 12 a pixel of the tiles that their headers leave undecided.
// Source: own; slabs are Kay and Kajiya's, Ray Tracing Complex Scenes, 1986.
#pragma once

#include "common/raster/box_window.h"
#include "common/raster/tile_store.h"

namespace vislab {

/// Nearness where the rays of pixel centres meet the planes of a box: c + a x + b y at pixel
/// (x, y). The first `enter_count` are planes of entry, the rest planes of exit.
struct BoxPlanes {
  struct NearnessPlane {
    double c = 0.0, a = 0.0, b = 0.0;
  };
  std::array<NearnessPlane, 6> planes;
  int enter_count = 0, count = 0;
  float device_margin = 0.0F;
};

/// What rays have in common, to be made once for a view. Metres relative to the eye, world axes.
class PixelRays {
 public:
  /// Coverage as in project_box.
  PixelRays(const WindowTransform& window, Coverage coverage);

  /// `box` is one that project_box places inside.
  BoxPlanes planes_of(const Aabb& box) const;

 private:
  bool perspective_;
  glm::dvec3 eye_;
  glm::dvec3 back_;
  // A ray's point at depth 1 (perspective), or its origin: start + x step_x + y step_y.
  glm::dvec3 start_, step_x_, step_y_;
  double pixel_m_;  // at depth 1, or anywhere
  double least_depth_, greatest_depth_;
  double reach_;  // of a pixel about its centre, pixels
  float device_margin_;
};

/// Is every pixel of the rectangle nearer than the box there, or beside it?
bool hides_silhouette(const TileStore& tiles, const BoxWindow& rectangle, const BoxPlanes& planes);
/// The same bits without SIMD.
bool hides_silhouette_scalar(const TileStore& tiles, const BoxWindow& rectangle,
                             const BoxPlanes& planes);

/// Is every pixel of the rectangle nearer than it? By headers of tiles first.
bool hides_rectangle(const TileStore& tiles, const BoxWindow& rectangle);

}  // namespace vislab
