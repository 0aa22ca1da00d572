// A depth buffer that is drawn into by software: what hides what, without graphics hardware.
//
// Idea: tiles of 8 x 8 pixels. A tile that one triangle covers alone keeps that triangle's plane
//   instead of 64 depths; every tile knows its farthest and nearest value, so that triangles behind
//   it are dropped by one comparison, and boxes are compared with whole tiles first.
// Guarantee: a pixel's nearness is the greatest of the triangles that cover it, bit for bit that of
//   SetupTriangle::nearness_at, whatever the order of drawing, the instruction set and the number
//   of threads; or the far plane's, if none does. With ids the first drawn keeps a tie.
// Limits: bit for bit within a scene's coordinates (common/scene/scene.h: max_scene_coordinate_m).
//   Triangles with coordinates of about 1e25 beside small ones may be drawn or not.
// Cost: O(tiles) to begin; a draw is O(clusters) + O(vertices of those in the window) + O(tiles
//   that triangles touch).
// Sources: Greene, Kass, Miller 1993 (hierarchical z-buffer); Pineda 1988 (edge functions);
//   Hasselgren, Andersson, Akenine-Moeller 2016 (tiles and masks on the processor).
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "common/raster/box_blocks.h"
#include "common/raster/box_silhouette.h"
#include "common/raster/box_window.h"
#include "common/raster/raster_mesh.h"
#include "common/raster/tile_store.h"
#include "common/raster/triangle_setup.h"

namespace vislab {

struct ClusterDraw;

struct RasterOptions {
  SetupOptions setup;
  bool ids = false;  // keep the id of each pixel's triangle
  int threads = 1;
};

class DepthRaster {
 public:
  /// Throws InputError for sizes below 1 x 1 and beyond 16,384 x 16,384.
  DepthRaster(const Viewport& size, const RasterOptions& options);
  ~DepthRaster();
  DepthRaster(DepthRaster&&) noexcept;
  DepthRaster& operator=(DepthRaster&&) noexcept;

  /// Starts a frame: clears everything to the far plane. The camera's aspect may differ from the
  /// size's: the image is stretched.
  void begin(const Camera& camera);
  const WindowTransform& window() const { return window_; }
  const Viewport& viewport() const { return window_.viewport(); }
  Coverage coverage() const { return options_.setup.coverage; }

  /// Draws in this order. Returns how many triangles were set up and not dropped before scan
  /// conversion. The spans need not outlive the call.
  std::size_t draw(std::span<const RasterDraw> draws);
  /// The same with one thread; samples[i] becomes the number of samples of the image that draw i
  /// covers, near enough or not (covered_area.h: by area), and outlines_px[i] the widths and
  /// heights of its triangles in sum. `samples` is as long as `draws`, and so is `outlines_px`
  /// unless empty.
  void draw_counted(std::span<const RasterDraw> draws, std::span<std::uint64_t> samples,
                    std::span<std::uint64_t> outlines_px = {});

  /// Draws in this order what is not hidden by what was drawn before it, so nearest first is best.
  /// hidden[i] becomes 1 if the vertices of draw i surely cover nothing of the image that would be
  /// seen, by the rules of hides(): they lie outside of the window, or behind what was drawn; else
  /// 0. One thread. `hidden` is as long as `draws`.
  std::size_t draw_visible(std::span<const RasterDraw> draws, std::span<std::uint8_t> hidden);

  /// The same by boxes in the world, which are cheaper to place than vertices: many at once, and
  /// before anything is drawn. Draw order[0], order[1], … of `draws` in this order, each unless its
  /// box is hidden by what was drawn before; the box of draw i is column i % 16 of block i / 16.
  /// hidden[i] is written for all draws in `order`.
  std::size_t draw_visible(std::span<const RasterDraw> draws, std::span<const BoxColumns> boxes,
                           std::span<const std::uint32_t> order, std::span<std::uint8_t> hidden);

  /// True if every pixel of the rectangle is surely nearer than the box.
  bool hides(const BoxWindow& box) const;
  /// outside and hidden boxes are not visible; undecided ones are.
  bool hides(const Aabb& box) const;

  /// Of a pixel; the far plane's where nothing is drawn.
  float nearness(int x, int y) const;
  /// none_id where nothing is drawn. Only with RasterOptions::ids.
  std::uint32_t id(int x, int y) const;
  /// What queries read.
  const TileStore& tiles() const { return tiles_; }

  std::size_t bytes() const;

 private:
  struct Work;

  void draw_cluster(const ClusterDraw& cluster, const WindowRows& rows);
  /// Into work_->clusters, sorted.
  void collect_clusters(std::span<const RasterDraw> draws);
  /// Draws the blocks that are set up in the first scratch.
  void draw_set_up();
  std::size_t draw_parallel(std::span<const RasterDraw> draws);

  RasterOptions options_;
  WindowTransform window_;
  PixelRays rays_;
  TileStore tiles_;
  std::unique_ptr<Work> work_;
};

}  // namespace vislab
