// What the questions that are asked of a TileStore share, with and without SIMD.
#pragma once

#include "common/raster/box_silhouette.h"
#include "common/raster/margins.h"

namespace vislab {

/// Of a nearness: more than what float operations on it can be off by.
inline constexpr auto nearness_rounding = static_cast<float>(rounding_margin);

/// The planes of a box about a tile's lower left pixel.
struct TilePlanes {
  struct Plane {
    float c, a, b;
  };
  std::array<Plane, 6> planes;

  TilePlanes(const BoxPlanes& of_image, int tile_x, int tile_y) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(of_image.count); ++i) {
      const auto& p = of_image.planes[i];
      planes[i] = {
          static_cast<float>((p.c + p.a * (tile_x * tile_size)) + p.b * (tile_y * tile_size)),
          static_cast<float>(p.a), static_cast<float>(p.b)};
    }
  }
};

}  // namespace vislab
