// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/raster/tile_kernel.cpp"
#include "common/raster/tile_kernel.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>

#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Tiles of a row: edge functions in double, headers in as many lanes of float.
using Doubles = hn::CappedTag<double, 8>;
using Headers = hn::Rebind<float, Doubles>;
using HeaderBits = hn::Rebind<std::uint32_t, Doubles>;
constexpr int row_lanes = HWY_MIN(HWY_LANES(double), 8);
// Pixels of a tile.
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::Rebind<std::int32_t, Floats>;
using Ids = hn::Rebind<std::uint32_t, Floats>;
constexpr int lanes = HWY_MIN(HWY_LANES(float), 16);
constexpr int vectors = tile_pixels / lanes;

/// Edge functions are clamped to this before they become 32-bit: within a tile they change by less
/// than 2^28.
constexpr double greatest_edge = 1 << 30;

alignas(64) constexpr auto pixel_columns = [] {
  std::array<std::int32_t, tile_pixels> x{};
  for (int i = 0; i < tile_pixels; ++i) x[static_cast<std::size_t>(i)] = i % tile_size;
  return x;
}();
alignas(64) constexpr auto pixel_rows = [] {
  std::array<std::int32_t, tile_pixels> y{};
  for (int i = 0; i < tile_pixels; ++i) y[static_cast<std::size_t>(i)] = i / tile_size;
  return y;
}();

/// Draws into the tiles of one store; `with_ids` is the store's.
template <bool with_ids>
class TilePainter {
 public:
  explicit TilePainter(TileStore& tiles)
      : tiles_(tiles),
        farthest_(tiles.farthest()),
        nearest_(tiles.nearest()),
        stored_(tiles.stored()),
        value_(tiles.plane_value()),
        step_x_(tiles.plane_step_x()),
        step_y_(tiles.plane_step_y()),
        // Columns and rows of tiles that stick out of the image.
        odd_x_(tiles.width() % tile_size == 0 ? tiles.tiles_x() : tiles.tiles_x() - 1),
        odd_y_(tiles.height() % tile_size == 0 ? tiles.tiles_y() : tiles.tiles_y() - 1) {}

  HWY_ATTR void draw(const TriangleBlock& block, std::size_t lane, const TileRows& rows) {
    const Doubles d;
    const Headers df;
    const int x0 = block.x0[lane], x1 = block.x1[lane];
    const int y0 = block.y0[lane], y1 = block.y1[lane];
    if (y0 >= y1) return;
    Triangle t;
    hn::Vec<Doubles> across[3], along_low[3];  // from tile to tile
    double up[3], greatest_c[3];
    const auto columns = hn::Iota(d, 0.0);
    hn::Vec<Doubles> to_greatest[3];
    for (std::size_t e = 0; e < 3; ++e) {
      const double a = block.a[e][lane], b = block.b[e][lane], c = block.c[e][lane];
      t.edge_a[e] = static_cast<std::int32_t>(a);
      t.edge_b[e] = static_cast<std::int32_t>(b);
      constexpr double last = tile_size - 1;
      const double least = std::min(0.0, last * a) + std::min(0.0, last * b);
      const double most = std::max(0.0, last * a) + std::max(0.0, last * b);
      along_low[e] = hn::MulAdd(columns, hn::Set(d, tile_size * a), hn::Set(d, c + least));
      to_greatest[e] = hn::Set(d, most - least);
      across[e] = hn::Set(d, tile_size * a * row_lanes);
      t.to_corner[e] = -least;
      up[e] = tile_size * b;
      greatest_c[e] = 0.0;
    }
    static_cast<void>(greatest_c);
    t.nearness = block.nearness[lane];
    t.step_x = block.step_x[lane];
    t.step_y = block.step_y[lane];
    t.id = block.id[lane];
    constexpr float last = tile_size - 1;
    // Rounding is monotone: these are what the pixels of a tile have at least and at most.
    t.low = std::min(0.0F, t.step_x * last) + std::min(0.0F, t.step_y * last);
    t.high = std::max(0.0F, t.step_x * last) + std::max(0.0F, t.step_y * last);
    const auto low = hn::Set(df, t.low), high = hn::Set(df, t.high);
    const auto step_x = hn::Set(df, t.step_x), step_y = hn::Set(df, t.step_y);
    const auto dx0 = hn::Mul(hn::Iota(df, 0.0F), hn::Set(df, static_cast<float>(tile_size)));
    for (int y = y0; y < y1; ++y) {
      if (rows.count > 1 && (y / 2) % rows.count != rows.index) continue;
      const int dy = y - y0;
      const auto value_up = hn::Mul(step_y, hn::Set(df, static_cast<float>(dy * tile_size)));
      hn::Vec<Doubles> edge[3];
      for (std::size_t e = 0; e < 3; ++e) {
        edge[e] = hn::Add(along_low[e], hn::Set(d, up[e] * dy));
      }
      const std::size_t row = tiles_.index(0, y);
      for (int x = x0; x < x1; x += row_lanes) {
        const std::size_t at = row + static_cast<std::size_t>(x);
        const auto dx = hn::Add(dx0, hn::Set(df, static_cast<float>((x - x0) * tile_size)));
        const auto value = hn::Add(hn::Add(hn::Set(df, t.nearness), hn::Mul(step_x, dx)), value_up);
        const auto most = hn::Add(value, high);
        const auto nearer = hn::Gt(most, hn::LoadU(df, farthest_ + at));
        const auto greatest =
            hn::Min(hn::Min(hn::Add(edge[0], to_greatest[0]), hn::Add(edge[1], to_greatest[1])),
                    hn::Add(edge[2], to_greatest[2]));
        const auto touched = hn::Ge(greatest, hn::Zero(d));
        std::uint32_t open = bits(d, touched) & bits(df, nearer);
        if (x1 - x < row_lanes) open &= (1U << (x1 - x)) - 1;
        if (open != 0) {
          const auto inside = hn::Ge(hn::Min(hn::Min(edge[0], edge[1]), edge[2]), hn::Zero(d));
          const std::uint32_t whole = bits(d, inside) & open;
          std::uint32_t partial = open & ~whole;
          if (whole != 0) {
            const auto least = hn::Add(value, low);
            const auto before = hn::LoadU(df, nearest_ + at);
            const std::uint32_t replaced =
                whole & bits(df, with_ids ? hn::Gt(least, before) : hn::Ge(least, before));
            if (replaced != 0) {
              replace(at, replaced, least, most, value, t);
            }
            partial |= whole & ~replaced;
          }
          if (partial != 0) {
            alignas(64) std::int32_t corner[3][8];
            alignas(64) float values[8], mosts[8];
            const hn::Rebind<std::int32_t, Doubles> di;
            for (std::size_t e = 0; e < 3; ++e) {
              const auto exact = hn::Add(edge[e], hn::Set(d, t.to_corner[e]));
              const auto clamped =
                  hn::Min(hn::Max(exact, hn::Set(d, -greatest_edge)), hn::Set(d, greatest_edge));
              hn::Store(hn::DemoteTo(di, clamped), di, corner[e]);
            }
            hn::Store(value, df, values);
            hn::Store(most, df, mosts);
            for (; partial != 0; partial &= partial - 1) {
              const int i = std::countr_zero(partial);
              if (HWY_UNLIKELY(x + i >= odd_x_ || y >= odd_y_)) tiles_.store(x + i, y);
              paint(at + static_cast<std::size_t>(i), t, corner[0][i], corner[1][i], corner[2][i],
                    values[i], mosts[i]);
            }
          }
        }
        for (std::size_t e = 0; e < 3; ++e) edge[e] = hn::Add(edge[e], across[e]);
      }
    }
  }

 private:
  struct Triangle {
    std::int32_t edge_a[3], edge_b[3];
    double to_corner[3];  // from the least value in a tile to that at its lower left pixel
    float nearness, step_x, step_y;
    float low, high;  // of the pixels of a tile, from the lower left one's
    std::uint32_t id;
  };

  template <class Lanes>
  static HWY_INLINE std::uint32_t bits(Lanes d, hn::Mask<Lanes> mask) {
    return simd::HWY_NAMESPACE::mask_bits(d, mask);
  }

  HWY_INLINE void replace(std::size_t at, std::uint32_t replaced, hn::Vec<Headers> least,
                          hn::Vec<Headers> most, hn::Vec<Headers> value, const Triangle& t) {
    const Headers df;
    const HeaderBits du;
    const std::array<std::uint8_t, 8> bytes{static_cast<std::uint8_t>(replaced)};
    const auto mask = hn::LoadMaskBits(df, bytes.data());
    const auto mask_u = hn::LoadMaskBits(du, bytes.data());
    hn::BlendedStore(least, mask, df, farthest_ + at);
    hn::BlendedStore(most, mask, df, nearest_ + at);
    hn::BlendedStore(value, mask, df, value_ + at);
    hn::BlendedStore(hn::Set(df, t.step_x), mask, df, step_x_ + at);
    hn::BlendedStore(hn::Set(df, t.step_y), mask, df, step_y_ + at);
    hn::BlendedStore(hn::Zero(du), mask_u, du, stored_ + at);
    if (with_ids) hn::BlendedStore(hn::Set(du, t.id), mask_u, du, tiles_.plane_id() + at);
  }

  /// Compares the covered pixels of one tile; c0 … c2 are the edge functions at its lower left
  /// pixel, `value` is the nearness there, and none in the tile is above `most`.
  HWY_INLINE void paint(std::size_t tile, const Triangle& t, std::int32_t c0, std::int32_t c1,
                        std::int32_t c2, float value, float most) {
    const Floats df;
    const Ints di;
    const Ids du;
    float* const pixels = tiles_.pixels(tile);
    std::uint32_t* const ids = with_ids ? tiles_.ids(tile) : nullptr;
    const bool stored = stored_[tile] != 0;
    const auto old_value = hn::Set(df, value_[tile]);
    const auto old_x = hn::Set(df, step_x_[tile]), old_y = hn::Set(df, step_y_[tile]);
    const auto new_value = hn::Set(df, value);
    const auto new_x = hn::Set(df, t.step_x), new_y = hn::Set(df, t.step_y);
    hn::Vec<Floats> after[vectors];
    auto any = hn::MaskFromVec(hn::Zero(df));
    auto farthest = hn::Set(df, INFINITY);
    hn::Mask<Floats> taken[vectors];
    for (int i = 0; i < vectors; ++i) {
      const auto column = hn::Load(di, pixel_columns.data() + i * lanes);
      const auto line = hn::Load(di, pixel_rows.data() + i * lanes);
      const auto edge = [&](std::size_t e, std::int32_t c) HWY_ATTR {
        return hn::Add(hn::Set(di, c), hn::Add(hn::Mul(column, hn::Set(di, t.edge_a[e])),
                                               hn::Mul(line, hn::Set(di, t.edge_b[e]))));
      };
      const auto sign = hn::Or(edge(0, c0), hn::Or(edge(1, c1), edge(2, c2)));
      const auto covered = hn::RebindMask(df, hn::Gt(sign, hn::Set(di, -1)));
      const auto dx = hn::ConvertTo(df, column), dy = hn::ConvertTo(df, line);
      const auto fresh = hn::Add(new_value, hn::Add(hn::Mul(new_x, dx), hn::Mul(new_y, dy)));
      const auto before = stored
                              ? hn::Load(df, pixels + i * lanes)
                              : hn::Add(old_value, hn::Add(hn::Mul(old_x, dx), hn::Mul(old_y, dy)));
      taken[i] = hn::And(covered, hn::Gt(fresh, before));
      any = hn::Or(any, taken[i]);
      after[i] = hn::IfThenElse(taken[i], fresh, before);
      farthest = hn::Min(farthest, after[i]);
    }
    if (hn::AllFalse(df, any)) return;
    for (int i = 0; i < vectors; ++i) hn::Store(after[i], df, pixels + i * lanes);
    if (with_ids) {
      if (!stored) {
        const auto before = hn::Set(du, tiles_.plane_id()[tile]);
        for (int i = 0; i < vectors; ++i) hn::Store(before, du, ids + i * lanes);
      }
      for (int i = 0; i < vectors; ++i) {
        hn::BlendedStore(hn::Set(du, t.id), hn::RebindMask(du, taken[i]), du, ids + i * lanes);
      }
    }
    stored_[tile] = 1;
    farthest_[tile] = hn::GetLane(hn::MinOfLanes(df, farthest));
    nearest_[tile] = std::max(nearest_[tile], most);
  }

  TileStore& tiles_;
  float* farthest_;
  float* nearest_;
  std::uint32_t* stored_;
  float* value_;
  float* step_x_;
  float* step_y_;
  int odd_x_, odd_y_;
};

template <bool with_ids>
HWY_ATTR void draw_all(std::span<const TriangleBlock> blocks, TileStore& tiles,
                       const TileRows& rows) {
  TilePainter<with_ids> painter(tiles);
  for (const TriangleBlock& block : blocks) {
    for (std::size_t lane = 0; lane < TriangleBlock::lanes; ++lane) painter.draw(block, lane, rows);
  }
}

HWY_ATTR void draw_tiles(std::span<const TriangleBlock> blocks, TileStore& tiles,
                         const TileRows& rows) {
  if (tiles.has_ids()) {
    draw_all<true>(blocks, tiles, rows);
  } else {
    draw_all<false>(blocks, tiles, rows);
  }
}

}  // namespace
}  // namespace vislab::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab {

HWY_EXPORT(draw_tiles);

void draw_blocks(std::span<const TriangleBlock> blocks, TileStore& tiles, const TileRows& rows) {
  HWY_DYNAMIC_DISPATCH(draw_tiles)(blocks, tiles, rows);
}

}  // namespace vislab
#endif
