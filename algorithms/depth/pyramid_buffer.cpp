#include "algorithms/depth/pyramid_buffer.h"

namespace vislab::depth_culling {
namespace {

// Fewer are asked one by one.
constexpr int few_tiles = 16;

}  // namespace

bool PyramidBuffer::start(const Frame& frame) {
  if (!buffer_.start(frame)) return false;
  frustum_ = frustum_of(frame.camera);
  rays_.emplace(buffer_.raster().window(), setup_.coverage);
  const Viewport& size = buffer_.raster().viewport();
  if (size != size_) {
    size_ = size;
    const TileStore& tiles = buffer_.raster().tiles();
    texels_before_ = texels_touched();
    pyramid_.emplace(tiles.tiles_x(), tiles.tiles_y());
  }
  pyramid_->clear(static_cast<float>(buffer_.raster().window().nearness(frame.camera.lens.far_m)));
  return true;
}

void PyramidBuffer::build_pyramid() {
  const TileStore& tiles = buffer_.raster().tiles();
  pyramid_->build([&](int x, int y) { return tiles.farthest()[tiles.index(x, y)]; });
}

void PyramidBuffer::update_pyramid(const BoxWindow& drawn) {
  const TileStore& tiles = buffer_.raster().tiles();
  const int x1 = (drawn.x1 - 1) / tile_size, y1 = (drawn.y1 - 1) / tile_size;
  for (int y = drawn.y0 / tile_size; y <= y1; ++y) {
    for (int x = drawn.x0 / tile_size; x <= x1; ++x) {
      pyramid_->raise(x, y, tiles.farthest()[tiles.index(x, y)]);
    }
  }
}

BoxWindow PyramidBuffer::everywhere() const {
  return {0, 0, size_.width, size_.height, std::numeric_limits<float>::infinity()};
}

BoxVerdict PyramidBuffer::look_at(const Aabb& box, BoxWindow& place) const {
  switch (project_box(buffer_.raster().window(), box, setup_.coverage, place)) {
    case BoxPlace::outside:
      return BoxVerdict::outside;
    case BoxPlace::inside:
      return hides(place) ? BoxVerdict::hidden : BoxVerdict::visible;
    case BoxPlace::undecided:
      break;
  }
  for (const Plane& plane : frustum_.span()) {
    if (surely_outside(plane, box)) return BoxVerdict::outside;
  }
  return BoxVerdict::undecided;
}

bool PyramidBuffer::hides(const BoxWindow& place) const {
  const TileStore& store = buffer_.raster().tiles();
  const TexelRect tiles{place.x0 / tile_size, place.y0 / tile_size, (place.x1 - 1) / tile_size + 1,
                        (place.y1 - 1) / tile_size + 1};
  if ((tiles.x1 - tiles.x0) * (tiles.y1 - tiles.y0) <= few_tiles) {
    return hides_rectangle(store, place);
  }
  return pyramid_->nearer_everywhere(tiles, place.nearness, [&](int x, int y) {
    const BoxWindow part{std::max(place.x0, x * tile_size), std::max(place.y0, y * tile_size),
                         std::min(place.x1, (x + 1) * tile_size),
                         std::min(place.y1, (y + 1) * tile_size), place.nearness};
    return hides_rectangle(store, part);
  });
}

bool PyramidBuffer::hides_silhouette_of(const Aabb& box, const BoxWindow& place) const {
  return hides_silhouette(buffer_.raster().tiles(), place, rays_->planes_of(box));
}

}  // namespace vislab::depth_culling
