// A depth buffer that keeps two depths and a mask for each tile instead of one depth for each
// pixel.
//
// Idea: of a tile of 8 x 8 pixels one depth bounds all pixels (the reference layer), and another
//   those of a mask (the working layer). A triangle that is behind the reference layer changes
//   nothing. Another joins the working layer, or replaces it if it is nearer by more than that
//   layer is to the reference. When the mask is full, the working layer becomes the reference.
// Guarantee: no pixel's value is nearer than what was drawn there, so that what is hidden by this
//   buffer is hidden by a DepthRaster that was drawn into alike; the same bits on every instruction
//   set. What it knows depends on the order of drawing, and is most from near to far.
// Cost: 16 bytes a tile; O(tiles) to begin, O(tiles that triangles touch) to draw, O(tiles) a
//   question.
// Limits: three surfaces in a tile are more than it can keep (F37 of the failure atlas): one is
//   forgotten, and what it hid may show again.
// Source: Hasselgren, Andersson, Akenine-Moeller 2016, Masked Software Occlusion Culling, 3.2.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/raster/box_window.h"
#include "common/raster/depth_raster.h"
#include "common/raster/tile_coverage.h"

namespace vislab {

/// What becomes of the working layer when a triangle comes that is not behind the reference.
enum class LayerMerge {
  distance,  // replaced if the triangle is farther before it than it is before the reference
  volume     // of joining, replacing and leaving the one that hides the most pixels times nearness
};

class MaskedDepth {
 public:
  /// Throws InputError as check_buffer_size() (tile_store.h). Of the options ids and
  /// threads do not count.
  MaskedDepth(const Viewport& size, const RasterOptions& options,
              LayerMerge merge = LayerMerge::distance);
  ~MaskedDepth();
  MaskedDepth(MaskedDepth&&) noexcept;
  MaskedDepth& operator=(MaskedDepth&&) noexcept;

  /// As DepthRaster's.
  void begin(const Camera& camera);
  const WindowTransform& window() const { return window_; }
  const Viewport& viewport() const { return window_.viewport(); }
  std::size_t draw(std::span<const RasterDraw> draws);
  bool hides(const BoxWindow& box) const;
  bool hides(const Aabb& box) const;

  /// What is known of a pixel: no more than its nearness.
  float nearness(int x, int y) const;
  std::size_t bytes() const;

  /// Draws without SIMD, for tests.
  void use_scalar() { scalar_ = true; }

 private:
  struct Work;

  void draw(const TriangleBlock& block, std::size_t lane);
  void add(std::size_t tile, std::uint64_t mask, float nearness);
  void add_whole(std::size_t tile, float nearness);

  RasterOptions options_;
  LayerMerge merge_;
  bool scalar_ = false;
  WindowTransform window_;
  int tiles_x_ = 0, tiles_y_ = 0;
  // By tile, row by row from below.
  std::vector<float> reference_;  // no pixel is farther
  std::vector<float> working_;    // no pixel of the mask is; above the reference where there is one
  std::vector<std::uint64_t> mask_;
  std::vector<std::uint64_t> outside_;  // pixels that are not in the image
  std::unique_ptr<Work> work_;
};

}  // namespace vislab
