// Which pixels of a tile a triangle covers, as 64 bits, and how far it is there: for buffers that
// keep masks instead of depths.
//
// Guarantee: the pixels of SetupTriangle::covers, and the least of nearness_at over them, bit for
//   bit, on every instruction set.
// Cost: about 10 operations on vectors for every 16 pixels.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/raster/triangle_block.h"

namespace vislab {

/// A tile that a triangle covers in part.
struct PartialTile {
  static constexpr std::size_t edge_count = std::tuple_size_v<decltype(TriangleBlock::c)>;
  /// Edge functions at the tile's lower left pixel are clamped to this: within a tile they change
  /// by less than half of it.
  static constexpr double greatest_edge = 1 << 30;

  std::array<std::int32_t, edge_count> edge;  // at the tile's lower left pixel, clamped
  float nearness = 0.0F;                      // there
  std::uint32_t tile = 0;                     // whatever the caller wants
};

/// What all tiles of a triangle have in common.
struct TileSteps {
  std::array<std::int32_t, PartialTile::edge_count> a, b;
  float x = 0.0F, y = 0.0F;  // of nearness
};

struct TileCoverage {
  /// Bit 8 y + x: is pixel (x, y) of the tile covered?
  std::uint64_t mask = 0;
  /// Nearness of the farthest covered pixel; +infinity if there is none.
  float farthest = 0.0F;

  friend bool operator==(const TileCoverage&, const TileCoverage&) = default;
};

/// `out` is as long as `tiles`.
void cover_tiles(const TileSteps& steps, std::span<const PartialTile> tiles,
                 std::span<TileCoverage> out);
/// The same bits without SIMD.
void cover_tiles_scalar(const TileSteps& steps, std::span<const PartialTile> tiles,
                        std::span<TileCoverage> out);

}  // namespace vislab
