#include "common/raster/tile_store.h"

#include <algorithm>
#include <new>
#include <string>

#include "common/scene/error.h"
#include "common/scene/scene.h"

namespace vislab {
namespace {

constexpr std::align_val_t alignment{64};

}  // namespace

void check_buffer_size(const Viewport& size) {
  if (size.width < 1 || size.height < 1 || size.width > greatest_buffer_px ||
      size.height > greatest_buffer_px) {
    throw InputError("a depth buffer of " + std::to_string(size.width) + " x " +
                     std::to_string(size.height) +
                     " pixels cannot be made: both sizes must lie in 1 .. " +
                     std::to_string(greatest_buffer_px));
  }
}

void TileStore::Free::operator()(void* memory) const { ::operator delete(memory, alignment); }

template <typename T>
TileStore::Memory<T> TileStore::allocate(std::size_t count) {
  return Memory<T>(static_cast<T*>(::operator new(count * sizeof(T), alignment)));
}

TileStore::TileStore(const Viewport& size, bool ids)
    : width_(size.width), height_(size.height), has_ids_(ids) {
  check_buffer_size(size);
  tiles_x_ = (width_ + tile_size - 1) / tile_size;
  tiles_y_ = (height_ + tile_size - 1) / tile_size;
  stride_ = tiles_x_ + padding;
  const std::size_t headers = index(0, tiles_y_);
  for (auto* header : {&farthest_, &nearest_, &plane_value_, &plane_step_x_, &plane_step_y_}) {
    header->resize(headers);
  }
  stored_.resize(headers);
  pixels_ = allocate<float>(headers * tile_pixels);
  if (ids) {
    plane_id_.resize(headers);
    ids_ = allocate<std::uint32_t>(headers * tile_pixels);
  }
}

void TileStore::clear(float nearness) {
  std::ranges::fill(farthest_, nearness);
  std::ranges::fill(nearest_, nearness);
  std::ranges::fill(plane_value_, nearness);
  std::ranges::fill(plane_step_x_, 0.0F);
  std::ranges::fill(plane_step_y_, 0.0F);
  std::ranges::fill(stored_, 0U);
  std::ranges::fill(plane_id_, none_id);
}

void TileStore::store_plane(int x, int y) {
  const std::size_t tile = index(x, y);
  const int inside_x = std::min(tile_size, width_ - x * tile_size);
  const int inside_y = std::min(tile_size, height_ - y * tile_size);
  float* to = pixels(tile);
  for (int dy = 0; dy < tile_size; ++dy) {
    for (int dx = 0; dx < tile_size; ++dx) {
      const bool inside = dx < inside_x && dy < inside_y;
      *to++ = inside ? nearness(tile, dx, dy) : std::numeric_limits<float>::infinity();
    }
  }
  if (has_ids_) std::fill_n(ids(tile), tile_pixels, plane_id_[tile]);
  stored_[tile] = 1;
}

std::size_t TileStore::bytes() const {
  const std::size_t headers = stored_.size();
  return headers * (6 * sizeof(float) + tile_pixels * sizeof(float)) +
         (has_ids_ ? headers * (1 + tile_pixels) * sizeof(std::uint32_t) : 0);
}

}  // namespace vislab
