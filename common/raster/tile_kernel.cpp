// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/raster/tile_kernel.cpp"
#include "common/raster/tile_kernel.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "common/raster/places_of_bits.h"
#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Tiles of a row: headers, and in as many parts as it takes edge functions in double.
using Headers = hn::CappedTag<float, 8>;
using HeaderBits = hn::Rebind<std::uint32_t, Headers>;
constexpr int row_lanes = HWY_MIN(HWY_LANES(float), 8);
using Doubles = hn::CappedTag<double, 8>;
constexpr int part_lanes = HWY_MIN(HWY_LANES(double), 8);
constexpr int parts = row_lanes / part_lanes;
// Pixels of a tile.
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::Rebind<std::int32_t, Floats>;
using Ids = hn::Rebind<std::uint32_t, Floats>;
constexpr int lanes = HWY_MIN(HWY_LANES(float), 16);
constexpr int vectors = tile_pixels / lanes;
constexpr std::size_t edges = SetupTriangle::edge_count;

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

alignas(64) constexpr auto pixel_dx = [] {
  std::array<float, tile_pixels> x{};
  for (int i = 0; i < tile_pixels; ++i) {
    x[static_cast<std::size_t>(i)] = static_cast<float>(i % tile_size);
  }
  return x;
}();
alignas(64) constexpr auto pixel_dy = [] {
  std::array<float, tile_pixels> y{};
  for (int i = 0; i < tile_pixels; ++i) {
    y[static_cast<std::size_t>(i)] = static_cast<float>(i / tile_size);
  }
  return y;
}();
/// Vectors that make up whole rows; all later ones have their columns.
constexpr int first_vectors = lanes < tile_size ? tile_size / lanes : 1;

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
    const Headers df;
    const int x0 = block.x0[lane], x1 = block.x1[lane];
    const int y0 = block.y0[lane], y1 = block.y1[lane];
    if (y0 >= y1) return;
    Triangle& t = triangle_;
    t.step_x = block.step_x[lane];
    t.step_y = block.step_y[lane];
    t.id = block.id[lane];
    t.ready = false;
    constexpr float last = tile_size - 1;
    // Rounding is monotone: these are what the pixels of a tile have at least and at most.
    const float low = std::min(0.0F, t.step_x * last) + std::min(0.0F, t.step_y * last);
    const float high = std::max(0.0F, t.step_x * last) + std::max(0.0F, t.step_y * last);
    const auto step_x = hn::Set(df, t.step_x);
    const auto value_0 = hn::Set(df, block.nearness[lane]);
    const auto highs = hn::Set(df, high);
    const auto dx_0 = hn::Mul(hn::Iota(df, 0.0F), hn::Set(df, static_cast<float>(tile_size)));
    const auto value_left = hn::Add(value_0, hn::Mul(step_x, dx_0));
    for (int y = y0; y < y1; ++y) {
      if (rows.count > 1 && (y / 2) % rows.count != rows.index) continue;
      const auto value_up = hn::Set(df, t.step_y * static_cast<float>((y - y0) * tile_size));
      auto value = hn::Add(value_left, value_up);
      std::size_t at = tiles_.index(x0, y);
      for (int x = x0;;) {
        const auto most = hn::Add(value, highs);
        std::uint32_t open = bits(df, hn::Gt(most, hn::LoadU(df, farthest_ + at)));
        if (x1 - x < row_lanes) open &= (1U << (x1 - x)) - 1;
        if (open != 0) {
          if (!t.ready) prepare(block, lane, t);
          draw_row(block, lane, t, x, y, at, x - x0, y - y0, open, value, most, low);
        }
        x += row_lanes;
        if (x >= x1) break;
        at += row_lanes;
        const auto dx = hn::Add(dx_0, hn::Set(df, static_cast<float>((x - x0) * tile_size)));
        value = hn::Add(hn::Add(value_0, hn::Mul(step_x, dx)), value_up);
      }
    }
    if (open_.count != 0) paint_all(t);
    open_.rows = 0;
  }

 private:
  struct Triangle {
    // Least value of each edge function in the tiles of a row, from the anchor's.
    hn::Vec<Doubles> along[edges];
    double to_most[edges];    // from the least value in a tile to the greatest
    double to_corner[edges];  // and to that at its lower left pixel
    // From the lower left pixel of a tile to its others: edge functions and nearness.
    hn::Vec<Ints> edge[edges][first_vectors];
    hn::Vec<Ints> edge_step[edges];  // from vector to vector
    hn::Vec<Floats> nearness[vectors];
    float step_x, step_y;
    std::uint32_t id;
    bool ready;
  };

  HWY_INLINE void prepare(const TriangleBlock& block, std::size_t lane, Triangle& t) {
    const Doubles d;
    const Floats df;
    const Ints di;
    t.ready = true;
    const auto columns = hn::Iota(d, 0.0);
    for (std::size_t e = 0; e < edges; ++e) {
      const double a = block.a[e][lane], b = block.b[e][lane], c = block.c[e][lane];
      constexpr double last = tile_size - 1;
      const double least = last * (std::min(0.0, a) + std::min(0.0, b));
      const double most = last * (std::max(0.0, a) + std::max(0.0, b));
      t.along[e] = hn::MulAdd(columns, hn::Set(d, tile_size * a), hn::Set(d, c + least));
      t.to_most[e] = most - least;
      t.to_corner[e] = -least;
      const auto edge_a = hn::Set(di, static_cast<std::int32_t>(a));
      const auto edge_b = hn::Set(di, static_cast<std::int32_t>(b));
      // Vectors repeat their columns.
      for (int i = 0; i < first_vectors; ++i) {
        t.edge[e][i] = hn::Add(hn::Mul(hn::Load(di, pixel_columns.data() + i * lanes), edge_a),
                               hn::Mul(hn::Load(di, pixel_rows.data() + i * lanes), edge_b));
      }
      t.edge_step[e] =
          hn::Set(di, static_cast<std::int32_t>(b) * (first_vectors * lanes / tile_size));
    }
    for (int i = 0; i < vectors; ++i) {
      const auto dx = hn::Load(df, pixel_dx.data() + i * lanes);
      const auto dy = hn::Load(df, pixel_dy.data() + i * lanes);
      t.nearness[i] =
          hn::Add(hn::Mul(hn::Set(df, t.step_x), dx), hn::Mul(hn::Set(df, t.step_y), dy));
    }
  }

  /// The tiles x … of a row whose bits are set in `open`: the triangle may be nearer there.
  /// dx and dy are how many tiles the first is from the anchor's.
  HWY_INLINE void draw_row(const TriangleBlock& block, std::size_t lane, const Triangle& t, int x,
                           int y, std::size_t at, int dx, int dy, std::uint32_t open,
                           hn::Vec<Headers> value, hn::Vec<Headers> most, float low) {
    const Doubles d;
    const Headers df;
    const hn::Rebind<std::int32_t, Doubles> di;
    const hn::Rebind<std::int32_t, Headers> places_d;
    const std::size_t from = 8 * open_.rows;
    std::uint32_t touched = 0, whole = 0;
    for (int part = 0; part < parts; ++part) {
      const std::uint32_t of_part = ((1U << part_lanes) - 1) << (part * part_lanes);
      if (parts > 1 && (open & of_part) == 0) continue;
      hn::Vec<Doubles> edge[edges];
      for (std::size_t e = 0; e < edges; ++e) {
        // Whole numbers below 2^53: exact.
        const double from_anchor =
            (block.a[e][lane] * (dx + part * part_lanes) + block.b[e][lane] * dy) *
            static_cast<double>(tile_size);
        edge[e] = hn::Add(t.along[e], hn::Set(d, from_anchor));
        const auto corner = hn::Add(edge[e], hn::Set(d, t.to_corner[e]));
        const auto clamped =
            hn::Min(hn::Max(corner, hn::Set(d, -greatest_edge)), hn::Set(d, greatest_edge));
        hn::StoreU(hn::DemoteTo(di, clamped), di, open_.corner[e] + from + part * part_lanes);
      }
      const auto greatest = hn::Min(hn::Min(hn::Add(edge[0], hn::Set(d, t.to_most[0])),
                                            hn::Add(edge[1], hn::Set(d, t.to_most[1]))),
                                    hn::Min(hn::Add(edge[2], hn::Set(d, t.to_most[2])),
                                            hn::Add(edge[3], hn::Set(d, t.to_most[3]))));
      const auto smallest = hn::Min(hn::Min(edge[0], edge[1]), hn::Min(edge[2], edge[3]));
      touched |= bits(d, hn::Ge(greatest, hn::Zero(d))) << (part * part_lanes);
      whole |= bits(d, hn::Ge(smallest, hn::Zero(d))) << (part * part_lanes);
    }
    open &= touched;
    whole &= open;
    std::uint32_t partial = open & ~whole;
    if (whole != 0) {
      const auto least = hn::Add(value, hn::Set(df, low));
      const auto before = hn::LoadU(df, nearest_ + at);
      const std::uint32_t replaced =
          whole & bits(df, with_ids ? hn::Gt(least, before) : hn::Ge(least, before));
      if (replaced != 0) replace(at, replaced, least, most, value, t);
      partial |= whole & ~replaced;
    }
    // To be painted together: a loop for each row would be of a length that nobody can foresee.
    hn::StoreU(value, df, open_.value + from);
    hn::StoreU(most, df, open_.most + from);
    open_.first_tile[open_.rows] = at;
    const hn::Rebind<std::uint8_t, Headers> du;
    const auto places = hn::PromoteTo(places_d, hn::Load(du, places_of_bits[partial].data()));
    hn::StoreU(hn::Add(places, hn::Set(places_d, static_cast<std::int32_t>(from))), places_d,
               open_.place + open_.count);
    open_.count += static_cast<std::size_t>(std::popcount(partial));
    open_.rows += partial != 0 ? 1 : 0;
    if (HWY_UNLIKELY(x + row_lanes > odd_x_ || y >= odd_y_)) {
      for (; partial != 0; partial &= partial - 1) {
        const int i = std::countr_zero(partial);
        if (x + i >= odd_x_ || y >= odd_y_) tiles_.store(x + i, y);
      }
    }
    if (HWY_UNLIKELY(open_.rows == OpenTiles::most_rows)) paint_all(t);
  }

  HWY_INLINE void paint_all(const Triangle& t) {
    for (std::size_t i = 0; i < open_.count; ++i) {
      const auto place = static_cast<std::size_t>(open_.place[i]);
      paint(open_.first_tile[place / 8] + place % 8, t,
            {open_.corner[0][place], open_.corner[1][place], open_.corner[2][place],
             open_.corner[3][place]},
            open_.value[place], open_.most[place]);
    }
    open_.count = open_.rows = 0;
  }

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

  /// Compares the covered pixels of one tile; `corner` are the edge functions at its lower left
  /// pixel, `value` is the nearness there, and none in
  /// the tile is above `most`.
  HWY_INLINE void paint(std::size_t tile, const Triangle& t,
                        const std::array<std::int32_t, edges>& corner, float value, float most) {
    const Floats df;
    const Ints di;
    const Ids du;
    float* const pixels = tiles_.pixels(tile);
    std::uint32_t* const ids = with_ids ? tiles_.ids(tile) : nullptr;
    const bool stored = stored_[tile] != 0;
    const auto new_value = hn::Set(df, value);
    hn::Vec<Ints> edge[edges][first_vectors];
    for (std::size_t e = 0; e < edges; ++e) {
      for (int i = 0; i < first_vectors; ++i) {
        edge[e][i] = hn::Add(hn::Set(di, corner[e]), t.edge[e][i]);
      }
    }
    auto any = hn::MaskFromVec(hn::Zero(df));
    auto farthest = hn::Set(df, INFINITY);
    hn::Mask<Floats> taken[vectors];
    // Pixels may be written though nothing is taken: they then stay what they are, or mean nothing.
    const auto compare = [&](int i, hn::Vec<Floats> before) HWY_ATTR {
      const int repeated = i % first_vectors;
      auto sign = edge[0][repeated];
      for (std::size_t e = 1; e < edges; ++e) sign = hn::Or(sign, edge[e][repeated]);
      for (std::size_t e = 0; e < edges; ++e) {
        edge[e][repeated] = hn::Add(edge[e][repeated], t.edge_step[e]);
      }
      const auto covered = hn::RebindMask(df, hn::Gt(sign, hn::Set(di, -1)));
      const auto fresh = hn::Add(new_value, t.nearness[i]);
      taken[i] = hn::And(covered, hn::Gt(fresh, before));
      any = hn::Or(any, taken[i]);
      const auto after = hn::IfThenElse(taken[i], fresh, before);
      farthest = hn::Min(farthest, after);
      hn::Store(after, df, pixels + i * lanes);
    };
    if (stored) {
      for (int i = 0; i < vectors; ++i) compare(i, hn::Load(df, pixels + i * lanes));
    } else {
      const auto old_value = hn::Set(df, value_[tile]);
      const auto old_x = hn::Set(df, step_x_[tile]), old_y = hn::Set(df, step_y_[tile]);
      for (int i = 0; i < vectors; ++i) {
        const auto dx = hn::Load(df, pixel_dx.data() + i * lanes);
        const auto dy = hn::Load(df, pixel_dy.data() + i * lanes);
        compare(i, hn::Add(old_value, hn::Add(hn::Mul(old_x, dx), hn::Mul(old_y, dy))));
      }
    }
    if (hn::AllFalse(df, any)) return;
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

  /// Tiles that a triangle covers in part, and what paint wants of them: eight of a row at a time.
  struct OpenTiles {
    static constexpr std::size_t most_rows = 16;

    alignas(64) std::int32_t corner[edges][8 * most_rows];
    alignas(64) float value[8 * most_rows], most[8 * most_rows];
    std::size_t first_tile[most_rows];
    std::int32_t place[8 * most_rows + 8];  // in these arrays, of those that are open
    std::size_t rows = 0, count = 0;
  };

  Triangle triangle_{};
  OpenTiles open_;
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
