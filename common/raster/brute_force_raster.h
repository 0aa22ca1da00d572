// The depth buffer in its plainest form: arrays of pixels, and every pixel of a triangle's
// rectangle tested. For tests, and for what benchmarks are compared with.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/raster/raster_mesh.h"
#include "common/raster/triangle_setup.h"

namespace vislab {

/// As DepthRaster, without tiles, SIMD and threads: the same bits, and ids always.
class BruteForceRaster {
 public:
  BruteForceRaster(const Viewport& size, const SetupOptions& options);

  void begin(const Camera& camera);
  const WindowTransform& window() const { return window_; }
  /// Returns how many triangles were set up and not dropped before scan conversion.
  std::size_t draw(std::span<const RasterDraw> draws);

  float nearness(int x, int y) const { return nearness_[pixel(x, y)]; }
  std::uint32_t id(int x, int y) const { return ids_[pixel(x, y)]; }

 private:
  std::size_t draw_pieces(const RasterDraw& draw_call, const SetupResult& result,
                          std::span<const SetupTriangle> pieces);
  std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(window_.viewport().width) +
           static_cast<std::size_t>(x);
  }

  SetupOptions options_;
  WindowTransform window_;
  std::vector<float> nearness_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace vislab
