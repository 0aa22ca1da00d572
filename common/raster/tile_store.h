// The memory of a depth buffer in tiles, for what draws into it and what asks it.
//
// Idea: a header for each tile says how far and how near its pixels are, and (plane tiles) what
//   they all are: one plane of nearness. Only tiles that need it have their pixels in memory
//   (stored tiles). To clear is to write headers.
// Layout: headers are arrays by kind, row by row of tiles, so that neighbours in a row are
//   neighbours in memory. Rows of headers have `padding` tiles after the image's last, which may be
//   read and written by vectors that stick out, and mean nothing.
// Pixels of a border tile that lie outside of the image are +infinity where they are stored, so
//   that they are never the farthest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "common/geometry/camera.h"
#include "common/raster/triangle_setup.h"

namespace vislab {

/// Throws InputError for sizes below 1 x 1 and beyond greatest_buffer_px x greatest_buffer_px.
void check_buffer_size(const Viewport& size);
inline constexpr int greatest_buffer_px = 16'384;

class TileStore {
 public:
  static constexpr int padding = 16;

  /// Throws InputError as check_buffer_size().
  TileStore(const Viewport& size, bool ids);

  /// Makes every tile a plane tile of this nearness. O(tiles).
  void clear(float nearness);

  int width() const { return width_; }
  int height() const { return height_; }
  int tiles_x() const { return tiles_x_; }
  int tiles_y() const { return tiles_y_; }
  bool has_ids() const { return has_ids_; }
  /// Of a tile's header, and of its pixels. 0 <= x < tiles_x, 0 <= y < tiles_y.
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride_) +
           static_cast<std::size_t>(x);
  }

  /// Headers, by index(). No pixel of the tile (in the image) is farther than `farthest`, and none
  /// is nearer than `nearest`.
  const float* farthest() const { return farthest_.data(); }
  const float* nearest() const { return nearest_.data(); }
  /// 1 if the tile's pixels are in memory, else 0, and the next three tell what they are: pixel
  /// (dx, dy) of the tile has plane_value + (plane_step_x dx + plane_step_y dy).
  const std::uint32_t* stored() const { return stored_.data(); }
  const float* plane_value() const { return plane_value_.data(); }
  const float* plane_step_x() const { return plane_step_x_.data(); }
  const float* plane_step_y() const { return plane_step_y_.data(); }
  /// Who drew a plane tile; only with ids.
  const std::uint32_t* plane_id() const { return plane_id_.data(); }
  float* farthest() { return farthest_.data(); }
  float* nearest() { return nearest_.data(); }
  std::uint32_t* stored() { return stored_.data(); }
  float* plane_value() { return plane_value_.data(); }
  float* plane_step_x() { return plane_step_x_.data(); }
  float* plane_step_y() { return plane_step_y_.data(); }
  std::uint32_t* plane_id() { return plane_id_.data(); }

  /// The tile_pixels pixels of a stored tile, row by row from below; aligned to 64 bytes.
  const float* pixels(std::size_t tile) const { return pixels_.get() + tile * tile_pixels; }
  float* pixels(std::size_t tile) { return pixels_.get() + tile * tile_pixels; }
  const std::uint32_t* ids(std::size_t tile) const { return ids_.get() + tile * tile_pixels; }
  std::uint32_t* ids(std::size_t tile) { return ids_.get() + tile * tile_pixels; }

  /// Puts a plane tile's pixels into memory; a stored one stays as it is.
  void store(int x, int y) {
    if (stored_[index(x, y)] == 0) store_plane(x, y);
  }

  /// Of pixel (dx, dy) of tile `tile`, whatever it is kept as.
  float nearness(std::size_t tile, int dx, int dy) const {
    if (stored_[tile] != 0) return pixels(tile)[dy * tile_size + dx];
    return plane_value_[tile] + (plane_step_x_[tile] * static_cast<float>(dx) +
                                 plane_step_y_[tile] * static_cast<float>(dy));
  }
  std::uint32_t id(std::size_t tile, int dx, int dy) const {
    return stored_[tile] != 0 ? ids(tile)[dy * tile_size + dx] : plane_id_[tile];
  }

  std::size_t bytes() const;

 private:
  struct Free {
    void operator()(void* memory) const;
  };
  template <typename T>
  using Memory = std::unique_ptr<T[], Free>;
  template <typename T>
  static Memory<T> allocate(std::size_t count);

  void store_plane(int x, int y);

  int width_ = 0, height_ = 0;
  int tiles_x_ = 0, tiles_y_ = 0, stride_ = 0;
  bool has_ids_ = false;
  std::vector<float> farthest_, nearest_;
  std::vector<float> plane_value_, plane_step_x_, plane_step_y_;
  std::vector<std::uint32_t> plane_id_;
  std::vector<std::uint32_t> stored_;
  // Not touched before a tile is stored: large images cost what is drawn.
  Memory<float> pixels_;
  Memory<std::uint32_t> ids_;
};

}  // namespace vislab
