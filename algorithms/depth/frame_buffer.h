// A software depth buffer that begins anew with every frame, and lives through all calls of cull()
// of one.
#pragma once

#include <cstdint>
#include <optional>

#include "common/culler/parameters.h"
#include "common/raster/depth_raster.h"
#include "common/scene/frame.h"

namespace vislab::depth_culling {

/// The parameter `scale`: full, half, quarter.
ParameterSpec scale_parameter();
/// 1, 2 or 4 pixels of the frame along a side of one of the buffer's.
int read_scale(const ParameterValues& values);
/// How a buffer is to be drawn so that what it hides is hidden in the frame's own image: at full
/// size by centres; smaller by pixels that are covered wholly. Depths never nearer than the
/// triangles.
inline SetupOptions conservative_setup(int scale) {
  return {scale == 1 ? Coverage::centres : Coverage::whole_pixels, DepthRounding::lowered};
}
/// Rounded up.
inline Viewport scaled(const Viewport& viewport, int scale) {
  return {(viewport.width + scale - 1) / scale, (viewport.height + scale - 1) / scale};
}

/// Raster: DepthRaster, or what has its constructor and begin().
template <typename Raster>
class FrameBuffer {
 public:
  FrameBuffer(int scale, const RasterOptions& options) : scale_(scale), options_(options) {}

  /// Before every path: what was drawn is of no frame to come.
  void forget() { frame_ = no_frame; }
  /// Makes the frame's buffer ready. True if it begins here: nothing is drawn yet. Takes memory
  /// only when the viewport's size changes.
  bool start(const Frame& frame) {
    if (frame.index == frame_) return false;
    frame_ = frame.index;
    const Viewport size = scaled(frame.viewport, scale_);
    if (!raster_ || raster_->viewport() != size) raster_.emplace(size, options_);
    raster_->begin(frame.camera);
    return true;
  }
  /// Only after start().
  Raster& raster() { return *raster_; }
  const Raster& raster() const { return *raster_; }
  std::size_t bytes() const { return raster_ ? raster_->bytes() : 0; }

 private:
  static constexpr std::uint64_t no_frame = ~std::uint64_t{0};

  int scale_;
  RasterOptions options_;
  std::uint64_t frame_ = no_frame;
  std::optional<Raster> raster_;
};

}  // namespace vislab::depth_culling
