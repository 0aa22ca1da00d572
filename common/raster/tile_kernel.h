// Scan conversion of triangles into tiles, with SIMD.
//
// Idea: a row of tiles is classified at once by the edge functions at the tiles' corners: outside,
//   covered wholly, or partly covered; tiles whose farthest pixel is nearer than the triangle is
//   anywhere in them are left out. A wholly covered tile whose nearest pixel is farther than the
//   triangle becomes a plane tile: O(1). The others are compared pixel by pixel, with exact 32-bit
//   edge functions relative to the tile.
// Guarantee: the pixels and bits of SetupTriangle::covers and nearness_at.
#pragma once

#include <span>

#include "common/raster/tile_store.h"
#include "common/raster/triangle_block.h"

namespace vislab {

/// Which rows of tiles are drawn: those y with (y / 2) % count == index.
struct TileRows {
  std::int32_t index = 0, count = 1;
};

/// Draws all triangles of the blocks, in order.
void draw_blocks(std::span<const TriangleBlock> blocks, TileStore& tiles, const TileRows& rows);

}  // namespace vislab
