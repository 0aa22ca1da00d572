// A depth buffer that is drawn into by software: what hides what, without graphics hardware.
//
// Idea: tiles of 8 x 8 pixels. A tile that one triangle covers alone keeps that triangle's plane
//   instead of 64 depths; every tile knows its farthest and nearest value, so that triangles behind
//   it are dropped by one comparison, and boxes are compared with whole tiles first.
// Guarantee: a pixel's nearness is the greatest of the triangles that cover it, bit for bit that of
//   SetupTriangle::nearness_at, whatever the order of drawing, the instruction set and the number
//   of threads; or the far plane's, if none does. With ids the first drawn keeps a tie.
// Cost: O(tiles) to begin; a draw is O(vertices) + O(tiles that triangles touch).
// Sources: Greene, Kass, Miller 1993 (hierarchical z-buffer); Pineda 1988 (edge functions);
//   Hasselgren, Andersson, Akenine-Moeller 2016 (tiles and masks on the processor).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/raster/box_window.h"
#include "common/raster/tile_store.h"
#include "common/raster/triangle_setup.h"
#include "common/scene/scene.h"

namespace vislab {

/// A mesh as the rasteriser wants it. Owns what it needs; the mesh may go.
class RasterMesh {
 public:
  RasterMesh() = default;
  explicit RasterMesh(const Mesh& mesh);

  std::span<const glm::vec3> positions() const { return positions_; }
  std::span<const glm::uvec3> triangles() const { return triangles_; }
  /// Of the vertices that triangles use.
  const Aabb& bounds() const { return bounds_; }
  std::size_t bytes() const;

 private:
  std::vector<glm::vec3> positions_;
  std::vector<glm::uvec3> triangles_;
  Aabb bounds_;
};

/// Triangles [first, first + count) of a mesh, placed in the world; they get the ids first_id,
/// first_id + 1, …
struct RasterDraw {
  const RasterMesh* mesh = nullptr;
  const glm::dmat4x3* transform = nullptr;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::uint32_t first_id = 0;
  /// Leaves out triangles that are seen from behind: nothing is lost of a solid mesh.
  bool front_only = false;
};

struct RasterOptions {
  SetupOptions setup;
  bool ids = false;  // keep the id of each pixel's triangle
  int threads = 1;
};

class DepthRaster {
 public:
  /// Throws InputError for sizes below 1 x 1 and beyond 16,384 x 16,384.
  DepthRaster(const Viewport& size, const RasterOptions& options);

  /// Starts a frame: clears everything to the far plane. The camera's aspect may differ from the
  /// size's: the image is stretched.
  void begin(const Camera& camera);
  const WindowTransform& window() const { return window_; }
  const Viewport& viewport() const { return window_.viewport(); }

  /// Draws in this order. Returns how many triangles were set up and not dropped before scan
  /// conversion. The spans need not outlive the call.
  std::size_t draw(std::span<const RasterDraw> draws);

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
  void draw(const SetupTriangle& triangle);

  RasterOptions options_;
  WindowTransform window_;
  TileStore tiles_;
};

}  // namespace vislab
