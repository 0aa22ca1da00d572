// Questions to a depth buffer by SIMD: boxes, rectangles and silhouettes.
//
// Guarantee: the same bits with every instruction set and as the scalar twins: float operations are
//   multiplications, additions, divisions and comparisons in the same order, none fused.
#include "common/raster/box_blocks.h"
#include "common/raster/tile_queries.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/raster/box_query_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come before highway.h.
#include <hwy/highway.h>

#include <bit>
#include <numeric>

#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using FloatVector = hn::Vec<Floats>;
constexpr std::size_t lanes = HWY_MIN(HWY_LANES(float), 16);
static_assert(tile_pixels % lanes == 0 && TileStore::padding >= lanes);

HWY_INLINE FloatVector set(float value) { return hn::Set(Floats(), value); }
HWY_INLINE std::uint32_t bits_of(hn::Mask<Floats> mask) {
  return simd::HWY_NAMESPACE::mask_bits(Floats(), mask);
}

/// Bits of the columns whose first is `first`, of those that a vector holds.
HWY_INLINE std::uint32_t part(std::uint32_t bits, std::size_t first) {
  return (bits >> first) & ((std::uint32_t{1} << lanes) - 1);
}

/// Bounds of a vector of boxes relative to the eye.
struct Bounds {
  FloatVector low[3], high[3], reach;

  HWY_INLINE Bounds(const ColumnView& view, const BoxColumns& boxes, std::size_t first) {
    const Floats f;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto eye_high = set(view.eye_high[axis]);
      const auto eye_low = set(view.eye_low[axis]);
      const float* from = boxes.rows[axis].data() + first;
      const float* to = boxes.rows[axis + 3].data() + first;
      low[axis] = hn::Sub(hn::Sub(hn::Load(f, from), eye_high), eye_low);
      high[axis] = hn::Sub(hn::Sub(hn::Load(f, to), eye_high), eye_low);
    }
    const auto size = [&](int axis)
                          HWY_ATTR { return hn::Max(hn::Abs(low[axis]), hn::Abs(high[axis])); };
    reach = hn::Add(hn::Add(size(0), size(1)), size(2));
  }

  /// Of a function at the corner where it is greatest.
  HWY_INLINE FloatVector greatest(const ColumnView::Row& row) const {
    const auto x = hn::Mul(set(row.x), row.x >= 0.0F ? high[0] : low[0]);
    const auto y = hn::Mul(set(row.y), row.y >= 0.0F ? high[1] : low[1]);
    const auto z = hn::Mul(set(row.z), row.z >= 0.0F ? high[2] : low[2]);
    return hn::Add(hn::Add(hn::Add(x, y), z), set(row.constant));
  }
  HWY_INLINE FloatVector error(const ColumnView::Row& row) const {
    return hn::Add(hn::Mul(reach, set(row.reach_error)), set(row.constant_error));
  }
};

/// Values of a function at the eight corners.
struct Corners {
  FloatVector value[8];

  HWY_INLINE Corners(const Bounds& b, const ColumnView::Row& row) {
    const auto x = set(row.x), y = set(row.y), z = set(row.z), constant = set(row.constant);
    const FloatVector in_x[2] = {hn::Mul(x, b.low[0]), hn::Mul(x, b.high[0])};
    const FloatVector in_y[2] = {hn::Mul(y, b.low[1]), hn::Mul(y, b.high[1])};
    const FloatVector in_z[2] = {hn::Mul(z, b.low[2]), hn::Mul(z, b.high[2])};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto in_xy = hn::Add(in_x[i & 1], in_y[i / 2]);
      value[i] = hn::Add(hn::Add(in_xy, in_z[0]), constant);
      value[i + 4] = hn::Add(hn::Add(in_xy, in_z[1]), constant);
    }
  }
  HWY_INLINE FloatVector least() const {
    const auto a = hn::Min(hn::Min(value[0], value[1]), hn::Min(value[2], value[3]));
    const auto b = hn::Min(hn::Min(value[4], value[5]), hn::Min(value[6], value[7]));
    return hn::Min(a, b);
  }
  HWY_INLINE FloatVector greatest() const {
    const auto a = hn::Max(hn::Max(value[0], value[1]), hn::Max(value[2], value[3]));
    const auto b = hn::Max(hn::Max(value[4], value[5]), hn::Max(value[6], value[7]));
    return hn::Max(a, b);
  }
};

/// Pixels of the columns of `decided`, along one axis.
HWY_INLINE hn::Mask<Floats> place_axis(const Corners& at, FloatVector margin, float size,
                                       hn::Mask<Floats> decided, std::int32_t* from,
                                       std::int32_t* to) {
  const Ints i;
  const auto in_image = [&](FloatVector value) HWY_ATTR {
    // What is not decided may be anything, NaN too.
    const auto clamped = hn::Min(hn::Max(value, set(0.0F)), set(size));
    return hn::IfThenElseZero(decided, clamped);
  };
  const auto first = hn::ConvertTo(i, hn::Ceil(in_image(hn::Sub(at.least(), margin))));
  const auto last = hn::ConvertTo(i, hn::Floor(in_image(hn::Add(at.greatest(), margin))));
  hn::Store(first, i, from);
  hn::Store(last, i, to);
  return hn::RebindMask(Floats(), hn::Lt(first, last));
}

HWY_INLINE void place(const ColumnView& view, const BoxColumns& boxes, ColumnPlaces& out) {
  const Floats f;
  out.undecided = out.inside = 0;
  const std::uint32_t asked = boxes.present & ~boxes.always;
  for (std::size_t first = 0; first < BoxColumns::width; first += lanes) {
    if (part(asked, first) == 0) continue;
    const Bounds bounds(view, boxes, first);
    const auto depth_error = bounds.error(view.depth);
    auto outside = hn::Lt(hn::Add(bounds.greatest(view.depth), depth_error), set(view.near_m));
    for (const ColumnView::Row& side : view.sides) {
      const auto greatest = hn::Add(bounds.greatest(side), bounds.error(side));
      outside = hn::Or(outside, hn::Lt(greatest, set(0.0F)));
    }
    if (part(asked, first) == (part(asked, first) & bits_of(outside))) continue;

    const Corners depth(bounds, view.depth);
    const auto seen = hn::Sub(depth.least(), depth_error);
    outside = hn::Or(outside, hn::Gt(seen, set(view.far_m)));
    auto decided = hn::Gt(seen, set(view.near_m));
    auto inverse = set(1.0F);
    Corners x(bounds, view.window_x), y(bounds, view.window_y);
    if (view.perspective) {
      decided = hn::And(decided, hn::Gt(seen, hn::Mul(set(4.0F), depth_error)));
      inverse = hn::Div(inverse, seen);
      for (std::size_t corner = 0; corner < 8; ++corner) {
        const auto scale = hn::Div(set(1.0F), depth.value[corner]);
        x.value[corner] = hn::Mul(x.value[corner], scale);
        y.value[corner] = hn::Mul(y.value[corner], scale);
      }
    }
    const auto depth_px = hn::Mul(depth_error, set(view.depth_to_px));
    const auto margin = [&](const ColumnView::Row& row) HWY_ATTR {
      return hn::Add(set(view.reach), hn::Mul(hn::Add(bounds.error(row), depth_px), inverse));
    };
    auto inside = place_axis(x, margin(view.window_x), view.width, decided, out.x0.data() + first,
                             out.x1.data() + first);
    inside = hn::And(inside, place_axis(y, margin(view.window_y), view.height, decided,
                                        out.y0.data() + first, out.y1.data() + first));
    const auto nearest = view.perspective ? inverse : hn::Neg(seen);
    const auto rounding = hn::Mul(hn::Abs(nearest), set(nearness_rounding));
    hn::Store(hn::Add(hn::Add(nearest, rounding), set(view.device_margin)), f,
              out.nearness.data() + first);
    const std::uint32_t kept = part(asked, first) & ~bits_of(outside);
    out.undecided |= (kept & ~bits_of(decided)) << first;
    out.inside |= (kept & bits_of(hn::And(inside, decided))) << first;
  }
}

/// Are the headers of all tiles of the rectangle nearer than it?
HWY_INLINE bool headers_hide(const TileStore& tiles, const BoxWindow& r) {
  const Floats f;
  const auto nearness = set(r.nearness);
  const int first = r.x0 / tile_size, last = (r.x1 - 1) / tile_size;
  const int last_y = (r.y1 - 1) / tile_size;
  for (int y = r.y0 / tile_size; y <= last_y; ++y) {
    const float* row = tiles.farthest() + tiles.index(0, y);
    for (int x = first; x <= last; x += static_cast<int>(lanes)) {
      const auto asked = hn::FirstN(f, static_cast<std::size_t>(last - x + 1));
      const auto nearer = hn::Gt(hn::LoadU(f, row + x), nearness);
      if (!hn::AllFalse(f, hn::AndNot(nearer, asked))) return false;
    }
  }
  return true;
}

/// Columns and rows of a tile's pixels.
struct PixelPlaces {
  alignas(64) std::array<float, tile_pixels> x, y;

  constexpr PixelPlaces() : x{}, y{} {
    for (std::size_t i = 0; i < tile_pixels; ++i) {
      x[i] = static_cast<float>(i % tile_size);
      y[i] = static_cast<float>(i / tile_size);
    }
  }
};
constexpr PixelPlaces pixel_places;

/// c + (a x + b y) at pixels of a tile.
HWY_INLINE FloatVector plane_at(float c, float a, float b, std::size_t pixel) {
  const Floats f;
  const auto x = hn::Mul(set(a), hn::Load(f, pixel_places.x.data() + pixel));
  const auto y = hn::Mul(set(b), hn::Load(f, pixel_places.y.data() + pixel));
  return hn::Add(set(c), hn::Add(x, y));
}

/// What a tile's pixels hold.
class TilePixels {
 public:
  HWY_INLINE TilePixels(const TileStore& tiles, std::size_t tile)
      : stored_(tiles.stored()[tile] != 0 ? tiles.pixels(tile) : nullptr),
        value_(tiles.plane_value()[tile]),
        step_x_(tiles.plane_step_x()[tile]),
        step_y_(tiles.plane_step_y()[tile]) {}

  HWY_INLINE FloatVector at(std::size_t pixel) const {
    if (stored_ != nullptr) return hn::Load(Floats(), stored_ + pixel);
    return plane_at(value_, step_x_, step_y_, pixel);
  }

 private:
  const float* stored_;
  float value_, step_x_, step_y_;
};

/// Calls f(tile_x, tile_y, tile) for tiles of the rectangle whose headers are not nearer than it,
/// until it returns false.
template <typename Function>
HWY_INLINE bool for_open_tiles(const TileStore& tiles, const BoxWindow& r, Function&& f) {
  const Floats d;
  const auto nearness = set(r.nearness);
  const int first = r.x0 / tile_size, end = (r.x1 - 1) / tile_size + 1;
  const int last_y = (r.y1 - 1) / tile_size;
  for (int y = r.y0 / tile_size; y <= last_y; ++y) {
    const float* row = tiles.farthest() + tiles.index(0, y);
    for (int x = first; x < end; x += static_cast<int>(lanes)) {
      std::uint32_t open = bits_of(hn::Le(hn::LoadU(d, row + x), nearness));
      if (end - x < static_cast<int>(lanes)) open &= (1U << (end - x)) - 1;
      for (; open != 0; open &= open - 1) {
        const int at = x + std::countr_zero(open);
        if (!f(at, y, tiles.index(at, y))) return false;
      }
    }
  }
  return true;
}

/// Which pixels of a tile lie in a rectangle.
class InRectangle {
 public:
  HWY_INLINE InRectangle(const BoxWindow& r, int tile_x, int tile_y) {
    const auto in_tile = [](int at, int tile)
                             HWY_ATTR { return set(static_cast<float>(at - tile * tile_size)); };
    x0_ = in_tile(r.x0, tile_x);
    y0_ = in_tile(r.y0, tile_y);
    x1_ = in_tile(r.x1, tile_x);
    y1_ = in_tile(r.y1, tile_y);
  }

  HWY_INLINE hn::Mask<Floats> at(std::size_t pixel) const {
    const Floats f;
    const auto x = hn::Load(f, pixel_places.x.data() + pixel);
    const auto y = hn::Load(f, pixel_places.y.data() + pixel);
    return hn::And(hn::And(hn::Ge(x, x0_), hn::Lt(x, x1_)),
                   hn::And(hn::Ge(y, y0_), hn::Lt(y, y1_)));
  }

 private:
  FloatVector x0_, y0_, x1_, y1_;
};

bool rectangle(const TileStore& tiles, const BoxWindow& r) {
  return for_open_tiles(tiles, r, [&](int tile_x, int tile_y, std::size_t tile) HWY_ATTR {
    const Floats f;
    const TilePixels pixels(tiles, tile);
    const InRectangle asked(r, tile_x, tile_y);
    const auto nearness = set(r.nearness);
    for (std::size_t pixel = 0; pixel < tile_pixels; pixel += lanes) {
      const auto nearer = hn::Gt(pixels.at(pixel), nearness);
      if (!hn::AllFalse(f, hn::AndNot(nearer, asked.at(pixel)))) return false;
    }
    return true;
  });
}

bool silhouette(const TileStore& tiles, const BoxWindow& r, const BoxPlanes& planes) {
  return for_open_tiles(tiles, r, [&](int tile_x, int tile_y, std::size_t tile) HWY_ATTR {
    const Floats f;
    const TilePixels pixels(tiles, tile);
    const InRectangle asked(r, tile_x, tile_y);
    const TilePlanes in_tile(planes, tile_x, tile_y);
    const auto margin = set(planes.device_margin);
    const auto enter_count = static_cast<std::size_t>(planes.enter_count);
    const auto count = static_cast<std::size_t>(planes.count);
    for (std::size_t pixel = 0; pixel < tile_pixels; pixel += lanes) {
      auto nearest = set(r.nearness);
      for (std::size_t i = 0; i < enter_count; ++i) {
        const auto& p = in_tile.planes[i];
        const auto entry = plane_at(p.c, p.a, p.b, pixel);
        const auto rounding = hn::Mul(hn::Abs(entry), set(nearness_rounding));
        nearest = hn::Min(nearest, hn::Add(hn::Add(entry, rounding), margin));
      }
      auto hidden_below = pixels.at(pixel);
      for (std::size_t i = enter_count; i < count; ++i) {
        const auto& p = in_tile.planes[i];
        hidden_below = hn::Max(hidden_below, plane_at(p.c, p.a, p.b, pixel));
      }
      const auto hidden = hn::Gt(hidden_below, nearest);
      if (!hn::AllFalse(f, hn::AndNot(hidden, asked.at(pixel)))) return false;
    }
    return true;
  });
}

/// Bits of the columns that may be seen.
HWY_INLINE std::uint32_t test_columns(const ColumnView& view, const PixelRays& rays,
                                      const TileStore& tiles, const BoxColumns& boxes,
                                      std::uint64_t& silhouettes) {
  ColumnPlaces places;
  place(view, boxes, places);
  std::uint32_t open = boxes.always | places.undecided;
  for (std::uint32_t left = places.inside; left != 0; left &= left - 1) {
    const auto column = static_cast<std::size_t>(std::countr_zero(left));
    const BoxWindow window = places.window(column);
    if (headers_hide(tiles, window)) continue;
    ++silhouettes;
    if (!silhouette(tiles, window, rays.planes_of(boxes.box(column)))) open |= left & -left;
  }
  return open;
}

/// Bits of the columns whose blocks are to be looked at.
HWY_INLINE std::uint32_t open_columns(const ColumnView& view, const TileStore& tiles,
                                      const BoxColumns& boxes) {
  ColumnPlaces places;
  place(view, boxes, places);
  std::uint32_t open = boxes.always | places.undecided;
  for (std::uint32_t left = places.inside; left != 0; left &= left - 1) {
    const auto column = static_cast<std::size_t>(std::countr_zero(left));
    if (!headers_hide(tiles, places.window(column))) open |= left & -left;
  }
  return open;
}

void find(const ColumnView& view, const PixelRays& rays, const TileStore& tiles,
          const BoxLevels& levels, const std::uint32_t* ids, BoxWalk& walk,
          std::uint64_t* visible) {
  walk.now.assign(1, 0);
  for (std::size_t level = levels.size() - 1; level > 0; --level) {
    walk.next.clear();
    for (const std::uint32_t block : walk.now) {
      std::uint32_t open = open_columns(view, tiles, levels[level][block]);
      for (; open != 0; open &= open - 1) {
        const auto column = static_cast<std::uint32_t>(std::countr_zero(open));
        walk.next.push_back(block * BoxColumns::width + column);
      }
    }
    walk.blocks += walk.now.size();
    walk.now.swap(walk.next);
  }
  for (const std::uint32_t block : walk.now) {
    std::uint32_t open = test_columns(view, rays, tiles, levels[0][block], walk.silhouettes);
    for (; open != 0; open &= open - 1) {
      const auto column = static_cast<std::uint32_t>(std::countr_zero(open));
      const std::uint32_t id = ids[block * BoxColumns::width + column];
      visible[id / 64] |= std::uint64_t{1} << (id % 64);
    }
  }
  walk.blocks += walk.now.size();
}

std::uint32_t test_block(const ColumnView& view, const PixelRays& rays, const TileStore& tiles,
                         const BoxColumns& boxes) {
  std::uint64_t silhouettes = 0;
  return test_columns(view, rays, tiles, boxes, silhouettes);
}

void place_block(const ColumnView& view, const BoxColumns& boxes, ColumnPlaces& out) {
  place(view, boxes, out);
}

}  // namespace
}  // namespace vislab::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab {

HWY_EXPORT(place_block);
HWY_EXPORT(find);
HWY_EXPORT(test_block);
HWY_EXPORT(rectangle);
HWY_EXPORT(silhouette);

void place_columns(const ColumnView& view, const BoxColumns& boxes, ColumnPlaces& out) {
  HWY_DYNAMIC_DISPATCH(place_block)(view, boxes, out);
}

void find_visible(const ColumnView& view, const PixelRays& rays, const TileStore& tiles,
                  const BoxLevels& levels, const std::uint32_t* ids, BoxWalk& walk,
                  std::uint64_t* visible) {
  HWY_DYNAMIC_DISPATCH(find)(view, rays, tiles, levels, ids, walk, visible);
}

std::uint32_t visible_columns(const ColumnView& view, const PixelRays& rays, const TileStore& tiles,
                              const BoxColumns& boxes) {
  return HWY_DYNAMIC_DISPATCH(test_block)(view, rays, tiles, boxes);
}

bool hides_rectangle(const TileStore& tiles, const BoxWindow& rectangle) {
  return HWY_DYNAMIC_DISPATCH(rectangle)(tiles, rectangle);
}

bool hides_silhouette(const TileStore& tiles, const BoxWindow& rectangle, const BoxPlanes& planes) {
  return HWY_DYNAMIC_DISPATCH(silhouette)(tiles, rectangle, planes);
}

}  // namespace vislab
#endif
