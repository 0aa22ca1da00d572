// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/raster/tile_coverage.cpp"
#include "common/raster/tile_coverage.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cmath>

#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// No more lanes than a row of a tile has pixels.
using Floats = hn::CappedTag<float, tile_size>;
using Ints = hn::Rebind<std::int32_t, Floats>;
constexpr int lanes = HWY_MIN(HWY_LANES(float), tile_size);

HWY_ATTR void cover(const TileSteps& steps, std::span<const PartialTile> tiles,
                    std::span<TileCoverage> out) {
  const Floats df;
  const Ints di;
  const auto column = hn::Iota(di, 0);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const PartialTile& tile = tiles[i];
    std::uint64_t mask = 0;
    auto farthest = hn::Set(df, INFINITY);
    for (int part = 0; part < tile_size; part += lanes) {
      const auto x = hn::Add(column, hn::Set(di, part));
      hn::Vec<Ints> edge[PartialTile::edge_count];
      for (std::size_t e = 0; e < PartialTile::edge_count; ++e) {
        edge[e] = hn::Add(hn::Set(di, tile.edge[e]), hn::Mul(x, hn::Set(di, steps.a[e])));
      }
      const auto along = hn::Mul(hn::Set(df, steps.x), hn::ConvertTo(df, x));
      for (int y = 0; y < tile_size; ++y) {
        auto sign = edge[0];
        for (std::size_t e = 1; e < PartialTile::edge_count; ++e) sign = hn::Or(sign, edge[e]);
        const auto covered = hn::RebindMask(df, hn::Gt(sign, hn::Set(di, -1)));
        mask |= std::uint64_t{simd::HWY_NAMESPACE::mask_bits(df, covered)}
                << static_cast<unsigned>(tile_size * y + part);
        const auto up = hn::Set(df, steps.y * static_cast<float>(y));
        const auto nearness = hn::Add(hn::Set(df, tile.nearness), hn::Add(along, up));
        farthest = hn::Min(farthest, hn::IfThenElse(covered, nearness, hn::Set(df, INFINITY)));
        for (std::size_t e = 0; e < PartialTile::edge_count; ++e) {
          edge[e] = hn::Add(edge[e], hn::Set(di, steps.b[e]));
        }
      }
    }
    out[i] = {mask, hn::GetLane(hn::MinOfLanes(df, farthest))};
  }
}

}  // namespace
}  // namespace vislab::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab {

HWY_EXPORT(cover);

void cover_tiles(const TileSteps& steps, std::span<const PartialTile> tiles,
                 std::span<TileCoverage> out) {
  HWY_DYNAMIC_DISPATCH(cover)(steps, tiles, out);
}

void cover_tiles_scalar(const TileSteps& steps, std::span<const PartialTile> tiles,
                        std::span<TileCoverage> out) {
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    TileCoverage& coverage = out[i];
    coverage = {0, INFINITY};
    for (int y = 0; y < tile_size; ++y) {
      for (int x = 0; x < tile_size; ++x) {
        std::int32_t sign = 0;
        for (std::size_t e = 0; e < PartialTile::edge_count; ++e) {
          sign |= tiles[i].edge[e] + steps.a[e] * x + steps.b[e] * y;
        }
        if (sign < 0) continue;
        coverage.mask |= std::uint64_t{1} << static_cast<unsigned>(tile_size * y + x);
        const float nearness =
            tiles[i].nearness + (steps.x * static_cast<float>(x) + steps.y * static_cast<float>(y));
        coverage.farthest = std::fmin(coverage.farthest, nearness);
      }
    }
  }
}

}  // namespace vislab
#endif
