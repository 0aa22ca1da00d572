// A frame's depth buffer with a Z-pyramid over its tiles: what can be drawn into, and asked about
// boxes of any size.
//
// Idea: the rasteriser knows the farthest value of each tile, and these are the pyramid's finest
//   level. A box's rectangle is compared with few texels from the top down; only in tiles that
//   these do not decide, pixels are looked at. What is visible by its rectangle is asked again by
//   its silhouette and its own depths (box_silhouette.h).
// Guarantee: a box that is hidden would change no pixel of the frame's image: every pixel that it
//   may cover is surely nearer (box_window.h).
// Cost: drawing as DepthRaster; keeping the pyramid O(tiles of the rectangles drawn into); a
//   question 100 operations and O(undecided tiles).
// Source: Greene, Kass, Miller 1993.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "algorithms/depth/frame_buffer.h"
#include "common/geometry/frustum.h"
#include "common/raster/depth_pyramid.h"

namespace vislab::depth_culling {

/// What is known of a box.
enum class BoxVerdict {
  outside,  // of the view
  hidden,
  visible,   // perhaps
  undecided  // perhaps visible, and where in the image is not known: it crosses the near plane
};

class PyramidBuffer {
 public:
  /// The buffer has one pixel for `scale` x `scale` of the frame.
  PyramidBuffer(int scale, int threads)
      : scale_(scale),
        setup_(conservative_setup(scale)),
        buffer_(scale, {setup_, false, threads}) {}

  void forget() { buffer_.forget(); }

  /// Makes the frame's buffer ready. True if it begins here: nothing is drawn yet. Takes memory
  /// only when the viewport's size changes.
  bool start(const Frame& frame);

  /// Draws without telling the pyramid, which stays right, but knows less. Returns how many
  /// triangles were drawn.
  std::size_t draw(std::span<const RasterDraw> draws) { return buffer_.raster().draw(draws); }
  /// The pyramid anew from all of the buffer.
  void build_pyramid();
  /// The pyramid follows what was drawn in a rectangle of the buffer.
  void update_pyramid(const BoxWindow& drawn);
  /// All of the buffer, where the place of something drawn is not known.
  BoxWindow everywhere() const;

  /// Where a box lies, and whether its rectangle is hidden. `place` is set if it is visible or
  /// hidden.
  BoxVerdict look_at(const Aabb& box, BoxWindow& place) const;
  /// Is a rectangle hidden?
  bool hides(const BoxWindow& place) const;
  /// Is a box hidden whose rectangle is not?
  bool hides_silhouette_of(const Aabb& box, const BoxWindow& place) const;

  /// How many pixels of the frame a rectangle of the buffer stands for.
  double frame_pixels(const BoxWindow& place) const {
    return static_cast<double>(place.x1 - place.x0) * (place.y1 - place.y0) * scale_ * scale_;
  }
  /// Of the buffer.
  std::uint64_t pixel_count() const {
    return static_cast<std::uint64_t>(size_.width) * static_cast<std::uint64_t>(size_.height);
  }
  /// Of the pyramid, read and written so far.
  std::uint64_t texels_touched() const {
    return texels_before_ + (pyramid_ ? pyramid_->texels_touched() : 0);
  }
  std::size_t bytes() const { return buffer_.bytes() + (pyramid_ ? pyramid_->bytes() : 0); }

 private:
  int scale_;
  SetupOptions setup_;
  FrameBuffer<DepthRaster> buffer_;
  Viewport size_{0, 0};  // of the buffer
  std::optional<DepthPyramid> pyramid_;
  std::uint64_t texels_before_ = 0;  // touched in pyramids of other sizes
  Frustum frustum_;
  std::optional<PixelRays> rays_;
};

}  // namespace vislab::depth_culling
