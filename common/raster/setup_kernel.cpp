// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/raster/setup_kernel.cpp"
#include "common/raster/setup_kernel.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/raster/places_of_bits.h"
#include "common/raster/setup_constants.h"
#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t most_lanes = TriangleBlock::lanes;
// A box has three faces that are seen: more lanes would often be empty.
using Doubles = hn::CappedTag<double, 4>;
using Vector = hn::Vec<Doubles>;
constexpr std::size_t double_lanes = HWY_MIN(HWY_LANES(double), 4);
// As many lanes of other types as there are of Doubles.
using NarrowInts = hn::Rebind<std::int32_t, Doubles>;
using NarrowFloats = hn::Rebind<float, Doubles>;
using Longs = hn::Rebind<std::int64_t, Doubles>;
using Ints = hn::CappedTag<std::int32_t, 16>;
constexpr std::size_t int_lanes = HWY_MIN(HWY_LANES(std::int32_t), 16);

HWY_INLINE Vector set(double value) { return hn::Set(Doubles(), value); }

/// One corner each of some triangles, by lane.
struct Corner {
  Vector x, y, w, value;  // value: nearness times w
  Vector snapped_x, snapped_y;
};

class SetUp {
 public:
  SetUp(const WindowTransform& window, const SetupOptions& options, bool ids,
        const ClusterDraw& what, SetupScratch& scratch)
      : window_(window),
        options_(options),
        apart_(ids && options.coverage == Coverage::centres),
        what_(what),
        mesh_(*what.draw->mesh),
        scratch_(scratch) {
    const glm::dmat3 linear(*what.draw->transform);
    // What the signed area of triangles that are left out has.
    if (what.draw->front_only) dropped_ = glm::determinant(linear) < 0.0 ? 1.0F : -1.0F;
    for (int corner = 0; corner < 4; ++corner) corners_[corner] = mesh_.corners(corner);
  }

  HWY_ATTR void run(const WindowRows& rows) {
    rows_ = &rows;
    const std::uint32_t first = what_.first;
    const std::uint32_t end = first + what_.count;
    std::uint32_t face = mesh_.face_of(first);
    std::uint32_t last = mesh_.face_of(end - 1) + 1;
    // Pairs of which one triangle is not to be drawn.
    if (mesh_.face_triangle(face) != first) {
      one_by_one(first, 1);
      if (++face == last) return;
    }
    const bool cut = mesh_.is_pair(last - 1) && mesh_.face_triangle(last - 1) + 1 == end;
    last -= cut ? 1 : 0;
    std::size_t survivors = 0;
    for (; face < last; face += int_lanes) {
      const std::size_t count = std::min<std::size_t>(int_lanes, last - face);
      if (HWY_UNLIKELY(scratch_.any_beyond) && any_beyond(face, count)) {
        // In order, so that the first drawn keeps a tie.
        set_up(survivors);
        survivors = 0;
        for (std::uint32_t i = face; i < face + count; ++i) one_face(i);
      } else {
        survivors += look(face, count, scratch_.face.data() + survivors);
      }
    }
    set_up(survivors);
    if (cut) one_by_one(end - 1, 1);
  }

 private:
  HWY_INLINE hn::Vec<Ints> gather(const std::int32_t* from, const std::uint32_t* at) const {
    const Ints di;
    return hn::GatherIndex(di, from, hn::LoadU(di, reinterpret_cast<const std::int32_t*>(at)));
  }

  HWY_ATTR bool any_beyond(std::uint32_t first, std::size_t count) const {
    const Ints di;
    const std::int32_t* beyond = scratch_.beyond.data();
    const auto any =
        hn::Or(hn::Or(gather(beyond, corners_[0] + first), gather(beyond, corners_[1] + first)),
               hn::Or(gather(beyond, corners_[2] + first), gather(beyond, corners_[3] + first)));
    return !hn::AllFalse(di, hn::And(hn::Ne(any, hn::Zero(di)), hn::FirstN(di, count)));
  }

  /// Writes the faces that may face the right way and may hold a pixel's centre; returns how many.
  /// Signed areas are rounded: faces in doubt are kept.
  HWY_ATTR std::size_t look(std::uint32_t first, std::size_t count, std::int32_t* out) const {
    const Ints di;
    const hn::Rebind<float, Ints> df;
    const std::int32_t* snapped_x = scratch_.snapped_x.data();
    const std::int32_t* snapped_y = scratch_.snapped_y.data();
    const auto px = gather(snapped_x, corners_[0] + first);
    const auto py = gather(snapped_y, corners_[0] + first);
    const auto qx = gather(snapped_x, corners_[1] + first);
    const auto qy = gather(snapped_y, corners_[1] + first);
    const auto rx = gather(snapped_x, corners_[2] + first);
    const auto ry = gather(snapped_y, corners_[2] + first);
    const auto sx = gather(snapped_x, corners_[3] + first);
    const auto sy = gather(snapped_y, corners_[3] + first);
    const auto first_centre = [&](auto low) HWY_ATTR {
      return hn::ShiftRight<8>(hn::Add(low, hn::Set(di, setup::subpixels / 2 - 1)));
    };
    const auto after_last = [&](auto high) HWY_ATTR {
      return hn::ShiftRight<8>(hn::Add(high, hn::Set(di, setup::subpixels / 2)));
    };
    const auto zero = hn::Zero(di);
    const auto width = hn::Set(di, window_.viewport().width);
    const auto height = hn::Set(di, window_.viewport().height);
    const auto x0 = hn::Max(zero, first_centre(hn::Min(hn::Min(px, qx), hn::Min(rx, sx))));
    const auto y0 = hn::Max(zero, first_centre(hn::Min(hn::Min(py, qy), hn::Min(ry, sy))));
    const auto x1 = hn::Min(width, after_last(hn::Max(hn::Max(px, qx), hn::Max(rx, sx))));
    const auto y1 = hn::Min(height, after_last(hn::Max(hn::Max(py, qy), hn::Max(ry, sy))));
    auto keep = hn::And(hn::And(hn::Lt(x0, x1), hn::Lt(y0, y1)), hn::FirstN(di, count));
    if (dropped_ != 0.0F) {
      const auto difference = [&](auto a, auto b)
                                  HWY_ATTR { return hn::ConvertTo(df, hn::Sub(a, b)); };
      const auto error_part = hn::Set(df, 1.0F / 1'048'576.0F);
      const auto drops = hn::Set(df, dropped_);
      const auto diagonal_x = difference(rx, px), diagonal_y = difference(ry, py);
      // Of the first triangle, and of the second, which is nothing if there is none.
      const auto left_0 = hn::Mul(difference(qx, px), diagonal_y);
      const auto right_0 = hn::Mul(difference(qy, py), diagonal_x);
      const auto left_1 = hn::Mul(diagonal_x, difference(sy, py));
      const auto right_1 = hn::Mul(diagonal_y, difference(sx, px));
      const auto area_0 = hn::Mul(hn::Sub(left_0, right_0), drops);
      const auto area_1 = hn::Mul(hn::Sub(left_1, right_1), drops);
      const auto error_0 = hn::Mul(hn::Add(hn::Abs(left_0), hn::Abs(right_0)), error_part);
      const auto error_1 = hn::Mul(hn::Add(hn::Abs(left_1), hn::Abs(right_1)), error_part);
      const auto in_doubt = hn::Or(hn::Le(area_0, error_0), hn::Lt(area_1, error_1));
      keep = hn::And(keep, hn::RebindMask(di, in_doubt));
    }
    const auto base = hn::Set(di, static_cast<std::int32_t>(first));
    if constexpr (int_lanes > 8) {
      return hn::CompressStore(hn::Add(hn::Iota(di, 0), base), keep, di, out);
    } else {
      const hn::Rebind<std::uint8_t, Ints> du;
      const std::uint32_t bits = simd::HWY_NAMESPACE::mask_bits(di, keep);
      const auto places = hn::PromoteTo(di, hn::Load(du, places_of_bits[bits].data()));
      hn::StoreU(hn::Add(places, base), di, out);
      return static_cast<std::size_t>(std::popcount(bits));
    }
  }

  HWY_INLINE hn::Vec<NarrowInts> of_faces(const std::uint32_t* values,
                                          hn::Vec<NarrowInts> faces) const {
    return hn::GatherIndex(NarrowInts(), reinterpret_cast<const std::int32_t*>(values), faces);
  }

  HWY_INLINE Corner corner(hn::Vec<NarrowInts> vertices) const {
    const Doubles d;
    const NarrowInts di;
    const auto index = hn::PromoteTo(Longs(), vertices);
    Corner c;
    c.x = hn::GatherIndex(d, scratch_.x.data(), index);
    c.y = hn::GatherIndex(d, scratch_.y.data(), index);
    c.w = hn::GatherIndex(d, scratch_.w.data(), index);
    c.value = window_.perspective() ? set(1.0)
                                    : hn::Neg(hn::GatherIndex(d, scratch_.depth.data(), index));
    c.snapped_x = hn::PromoteTo(d, hn::GatherIndex(di, scratch_.snapped_x.data(), vertices));
    c.snapped_y = hn::PromoteTo(d, hn::GatherIndex(di, scratch_.snapped_y.data(), vertices));
    return c;
  }

  HWY_ATTR void set_up(std::size_t survivors) {
    for (std::size_t i = 0; i < survivors; i += double_lanes) {
      set_up_some(scratch_.face.data() + i, std::min(double_lanes, survivors - i));
    }
  }

  /// Of `count` faces, at most as many as there are lanes; as many may be read.
  HWY_ATTR void set_up_some(const std::int32_t* faces, std::size_t count) {
    const Doubles d;
    const NarrowInts di;
    const auto zero = hn::Zero(d);
    // Lanes beyond the count repeat the first.
    const auto which =
        hn::IfThenElse(hn::FirstN(di, count), hn::LoadU(di, faces), hn::Set(di, faces[0]));
    const auto vertex_0 = of_faces(corners_[0], which), vertex_3 = of_faces(corners_[3], which);
    const auto pair = hn::Ne(hn::PromoteTo(d, vertex_0), hn::PromoteTo(d, vertex_3));
    Corner v[4] = {corner(vertex_0), corner(of_faces(corners_[1], which)),
                   corner(of_faces(corners_[2], which)), corner(vertex_3)};

    const auto area_of = [](const Corner& p, const Corner& q, const Corner& r) HWY_ATTR {
      return hn::Sub(hn::Mul(hn::Sub(q.snapped_x, p.snapped_x), hn::Sub(r.snapped_y, p.snapped_y)),
                     hn::Mul(hn::Sub(q.snapped_y, p.snapped_y), hn::Sub(r.snapped_x, p.snapped_x)));
    };
    const auto area = area_of(v[0], v[1], v[2]);
    const auto area_1 = area_of(v[0], v[2], v[3]);
    const auto area_2 = area_of(v[0], v[1], v[3]);
    const auto area_3 = area_of(v[1], v[2], v[3]);
    const auto all_front = hn::Gt(hn::Min(hn::Min(area, area_1), hn::Min(area_2, area_3)), zero);
    const auto all_back = hn::Lt(hn::Max(hn::Max(area, area_1), hn::Max(area_2, area_3)), zero);
    // Pairs that are to be taken apart, and what is to be drawn.
    auto apart = hn::AndNot(hn::Or(all_front, all_back), pair);
    auto keep = hn::Ne(area, zero);
    if (dropped_ != 0.0F) keep = hn::And(keep, hn::Lt(hn::Mul(area, set(dropped_)), zero));

    // Pixels, and the anchor.
    const auto by_grid = set(1.0 / setup::subpixels);
    const auto half = set(setup::subpixels / 2);
    const auto first_centre = [&](Vector a, Vector b, Vector c, Vector e) HWY_ATTR {
      const auto low = hn::Min(hn::Min(a, b), hn::Min(c, e));
      return hn::Max(zero, hn::Floor(hn::Mul(hn::Add(low, hn::Sub(half, set(1.0))), by_grid)));
    };
    const auto after_last = [&](Vector a, Vector b, Vector c, Vector e, int size) HWY_ATTR {
      const auto high = hn::Max(hn::Max(a, b), hn::Max(c, e));
      return hn::Min(set(size), hn::Floor(hn::Mul(hn::Add(high, half), by_grid)));
    };
    const auto x0 = first_centre(v[0].snapped_x, v[1].snapped_x, v[2].snapped_x, v[3].snapped_x);
    const auto y0 = first_centre(v[0].snapped_y, v[1].snapped_y, v[2].snapped_y, v[3].snapped_y);
    const auto x1 = after_last(v[0].snapped_x, v[1].snapped_x, v[2].snapped_x, v[3].snapped_x,
                               window_.viewport().width);
    const auto y1 = after_last(v[0].snapped_y, v[1].snapped_y, v[2].snapped_y, v[3].snapped_y,
                               window_.viewport().height);
    const auto holds_pixels = hn::And(hn::Lt(x0, x1), hn::Lt(y0, y1));
    keep = hn::And(keep, holds_pixels);
    apart = hn::And(apart, holds_pixels);
    const auto by_tile = set(1.0 / tile_size);
    const auto to_tile = set(tile_size);
    const auto tile_x0 = hn::Floor(hn::Mul(x0, by_tile));
    const auto tile_y0 = hn::Floor(hn::Mul(y0, by_tile));
    const auto tile_x1 = hn::Ceil(hn::Mul(x1, by_tile));
    const auto tile_y1 = hn::Ceil(hn::Mul(y1, by_tile));
    const auto anchor_x = hn::Mul(tile_x0, to_tile);
    const auto anchor_y = hn::Mul(tile_y0, to_tile);

    // The plane of nearness.
    const auto pixel_x = hn::Add(anchor_x, set(0.5));
    const auto pixel_y = hn::Add(anchor_y, set(0.5));
    for (int i = 0; i < 3; ++i) {
      v[i].x = hn::Sub(v[i].x, hn::Mul(pixel_x, v[i].w));
      v[i].y = hn::Sub(v[i].y, hn::Mul(pixel_y, v[i].w));
    }
    auto determinant = zero, terms = zero, a = zero, b = zero, value = zero;
    for (std::size_t i = 0; i < 3; ++i) {
      const Corner& q = v[(i + 1) % 3];
      const Corner& r = v[(i + 2) % 3];
      const auto qr = hn::Mul(q.y, r.w);
      const auto rq = hn::Mul(q.w, r.y);
      const auto minor = hn::Sub(qr, rq);
      determinant = hn::Add(determinant, hn::Mul(v[i].x, minor));
      terms = hn::Add(terms, hn::Mul(hn::Abs(v[i].x), hn::Add(hn::Abs(qr), hn::Abs(rq))));
      a = hn::Add(a, hn::Mul(v[i].value, minor));
      b = hn::Add(b, hn::Mul(v[i].value, hn::Sub(hn::Mul(q.w, r.x), hn::Mul(q.x, r.w))));
      value = hn::Add(value, hn::Mul(v[i].value, hn::Sub(hn::Mul(q.x, r.y), hn::Mul(q.y, r.x))));
    }
    const auto seen =
        hn::And(hn::Gt(hn::Abs(determinant), hn::Mul(set(setup::least_determinant), terms)),
                hn::Lt(terms, set(setup::greatest_terms)));
    a = hn::Div(a, determinant);
    b = hn::Div(b, determinant);
    value = hn::Div(value, determinant);
    const auto size = hn::Add(hn::Add(hn::Abs(a), hn::Abs(b)), hn::Abs(value));
    const auto good = hn::And(seen, hn::Lt(size, set(setup::greatest_plane)));
    // The triangles of a pair that is not drawn by the first one's plane may have planes.
    apart = hn::Or(apart, hn::And(pair, hn::AndNot(good, keep)));
    keep = hn::AndNot(apart, hn::And(keep, good));
    if (options_.rounding == DepthRounding::lowered) {
      const auto reach_x = hn::Add(hn::Sub(x1, anchor_x), to_tile);
      const auto reach_y = hn::Add(hn::Sub(y1, anchor_y), to_tile);
      const auto here = hn::Add(hn::Add(hn::Abs(value), hn::Mul(hn::Abs(a), reach_x)),
                                hn::Mul(hn::Abs(b), reach_y));
      value = hn::Sub(value, hn::Mul(set(setup::plane_error), here));
      if (options_.coverage == Coverage::whole_pixels) {
        value = hn::Sub(value, hn::Mul(set(0.5), hn::Add(hn::Abs(a), hn::Abs(b))));
      }
    }

    // Edges, counter-clockwise.
    const auto sense = hn::IfThenElse(hn::Lt(area, zero), set(-1.0), set(1.0));
    auto inset = zero;
    if (options_.coverage == Coverage::whole_pixels) {
      inset = set(setup::whole_pixel_inset);
    } else if (options_.rounding == DepthRounding::lowered) {
      const auto right = set(setup::subpixels * window_.viewport().width);
      const auto top = set(setup::subpixels * window_.viewport().height);
      for (const Corner& corner : v) {
        const auto beside = hn::Or(hn::Lt(corner.snapped_x, zero), hn::Gt(corner.snapped_x, right));
        const auto above = hn::Or(hn::Lt(corner.snapped_y, zero), hn::Gt(corner.snapped_y, top));
        inset = hn::IfThenElse(hn::Or(beside, above), set(setup::border_inset), inset);
      }
    }
    Vector edge_a[5], edge_b[5], edge_c[5];
    const auto edge = [&](std::size_t e, const Corner& from, const Corner& to,
                          Vector inward) HWY_ATTR {
      const auto ea = hn::Mul(sense, hn::Sub(from.snapped_y, to.snapped_y));
      const auto eb = hn::Mul(sense, hn::Sub(to.snapped_x, from.snapped_x));
      const auto level = hn::Eq(ea, zero);
      const auto owns = hn::Or(hn::Gt(ea, zero), hn::And(level, hn::Gt(eb, zero)));
      auto at = hn::Add(hn::Mul(ea, hn::Sub(half, from.snapped_x)),
                        hn::Mul(eb, hn::Sub(half, from.snapped_y)));
      at = hn::Sub(at, hn::IfThenElse(owns, zero, set(1.0)));
      at = hn::Sub(at, hn::Mul(hn::Add(hn::Abs(ea), hn::Abs(eb)), inward));
      at = hn::Floor(hn::Mul(at, by_grid));
      edge_a[e] = ea;
      edge_b[e] = eb;
      edge_c[e] = hn::Add(at, hn::Add(hn::Mul(ea, anchor_x), hn::Mul(eb, anchor_y)));
    };
    edge(0, v[0], v[1], inset);
    edge(1, v[1], v[2], inset);
    edge(2, v[2], v[3], inset);
    edge(3, v[3], v[0], inset);
    // A triangle has no fourth edge.
    edge_c[3] = hn::IfThenElseZero(pair, edge_c[3]);

    const std::uint32_t valid = (1U << count) - 1;
    const std::uint32_t kept = simd::HWY_NAMESPACE::mask_bits(d, keep) & valid;
    const std::uint32_t taken_apart = simd::HWY_NAMESPACE::mask_bits(d, apart) & valid;
    if ((kept | taken_apart) == 0) return;
    const std::uint32_t pairs = simd::HWY_NAMESPACE::mask_bits(d, pair);
    const auto offset = static_cast<std::int32_t>(what_.draw->first_id - what_.draw->first);
    const auto ids = hn::Add(of_faces(mesh_.face_triangles(), which), hn::Set(di, offset));
    TriangleBlock fresh;
    for (std::size_t e = 0; e < SetupTriangle::edge_count; ++e) {
      hn::Store(edge_a[e], d, fresh.a[e].data());
      hn::Store(edge_b[e], d, fresh.b[e].data());
      hn::Store(edge_c[e], d, fresh.c[e].data());
    }
    const auto store_int =
        [&](Vector value_of, std::array<std::int32_t, most_lanes>& array)
            HWY_ATTR { hn::Store(hn::DemoteTo(di, value_of), di, array.data()); };
    const auto store_float = [&](Vector value_of, std::array<float, most_lanes>& array) HWY_ATTR {
      const NarrowFloats df;
      hn::Store(hn::DemoteTo(df, value_of), df, array.data());
    };
    store_int(tile_x0, fresh.x0);
    store_int(tile_y0, fresh.y0);
    store_int(tile_x1, fresh.x1);
    store_int(tile_y1, fresh.y1);
    store_float(value, fresh.nearness);
    store_float(a, fresh.step_x);
    store_float(b, fresh.step_y);
    hn::Store(ids, di, reinterpret_cast<std::int32_t*>(fresh.id.data()));
    scratch_.drawn += static_cast<std::size_t>(std::popcount(kept) + std::popcount(kept & pairs));
    Diagonal diagonal;
    if (apart_) {
      edge(4, v[0], v[2], zero);
      hn::Store(edge_a[4], d, diagonal.a.data());
      hn::Store(edge_b[4], d, diagonal.b.data());
      hn::Store(edge_c[4], d, diagonal.c.data());
    }
    for (std::uint32_t rest = kept | taken_apart; rest != 0; rest &= rest - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rest));
      if ((taken_apart >> i & 1U) != 0) {
        one_by_one(mesh_.face_triangle(static_cast<std::uint32_t>(faces[i])), 2);
      } else if (apart_ && (pairs >> i & 1U) != 0) {
        add_triangles(fresh, diagonal, i);
      } else {
        add_lane(fresh, i);
      }
    }
  }

  /// From corner 0 to corner 2 of pairs, as an edge of their second triangles.
  struct Diagonal {
    alignas(64) std::array<double, most_lanes> a, b, c;
  };

  /// The two triangles of a pair, with ids of their own.
  void add_triangles(TriangleBlock& pair, const Diagonal& diagonal, std::size_t i) const {
    const auto edge = [&](std::size_t e, double a, double b, double c) {
      pair.a[e][i] = a;
      pair.b[e][i] = b;
      pair.c[e][i] = c;
    };
    const std::array<double, 3> third{pair.a[2][i], pair.b[2][i], pair.c[2][i]};
    const std::array<double, 3> fourth{pair.a[3][i], pair.b[3][i], pair.c[3][i]};
    // The first has what the second has not: values are whole numbers, so -x - 1 >= 0 if x < 0.
    edge(2, -diagonal.a[i], -diagonal.b[i], -diagonal.c[i] - 1.0);
    edge(3, 0.0, 0.0, 0.0);
    add_lane(pair, i);
    edge(0, diagonal.a[i], diagonal.b[i], diagonal.c[i]);
    edge(1, third[0], third[1], third[2]);
    edge(2, fourth[0], fourth[1], fourth[2]);
    ++pair.id[i];
    add_lane(pair, i);
  }

  TriangleBlock& next_block() const {
    if (scratch_.block_count == scratch_.blocks.size()) {
      scratch_.blocks.resize(2 * scratch_.block_count + 16);
    }
    return scratch_.blocks[scratch_.block_count++];
  }

  TriangleBlock& next_lane(std::size_t& lane) const {
    TriangleBlock& block =
        scratch_.lane == 0 ? next_block() : scratch_.blocks[scratch_.block_count - 1];
    lane = scratch_.lane;
    scratch_.lane = (lane + 1) % most_lanes;
    return block;
  }

  void add_lane(const TriangleBlock& from, std::size_t i) const {
    std::size_t lane = 0;
    TriangleBlock& to = next_lane(lane);
    for (std::size_t e = 0; e < SetupTriangle::edge_count; ++e) {
      to.a[e][lane] = from.a[e][i];
      to.b[e][lane] = from.b[e][i];
      to.c[e][lane] = from.c[e][i];
    }
    to.x0[lane] = from.x0[i];
    to.y0[lane] = from.y0[i];
    to.x1[lane] = from.x1[i];
    to.y1[lane] = from.y1[i];
    to.nearness[lane] = from.nearness[i];
    to.step_x[lane] = from.step_x[i];
    to.step_y[lane] = from.step_y[i];
    to.id[lane] = from.id[i];
  }

  /// What set_up_triangle makes of triangles of the mesh.
  void one_by_one(std::uint32_t first, std::uint32_t count) const {
    const auto positions = mesh_.positions();
    const Facing dropped = dropped_ < 0.0F ? Facing::back : Facing::front;
    for (std::uint32_t i = first; i < first + count; ++i) {
      const glm::uvec3& t = mesh_.triangles()[i];
      const std::array<WindowPoint, 3> points{(*rows_)(positions[t.x]), (*rows_)(positions[t.y]),
                                              (*rows_)(positions[t.z])};
      std::array<SetupTriangle, max_setup_pieces> pieces;
      const SetupResult result = set_up_triangle(
          window_, points, what_.draw->first_id + (i - what_.draw->first), options_, pieces);
      if (result.count == 0 || (dropped_ != 0.0F && result.facing == dropped)) continue;
      for (int piece = 0; piece < result.count; ++piece) {
        std::size_t lane = 0;
        TriangleBlock& block = next_lane(lane);
        block.set_lane(lane, pieces[static_cast<std::size_t>(piece)]);
      }
      ++scratch_.drawn;
    }
  }

  /// A face of a cluster that has something beyond.
  HWY_ATTR void one_face(std::uint32_t face) {
    std::int32_t all = -1, any = 0;
    for (const std::uint32_t* corners : corners_) {
      all &= scratch_.beyond[corners[face]];
      any |= scratch_.beyond[corners[face]];
    }
    // Nothing is left of what lies wholly beyond one plane.
    if (all != 0) return;
    if (any == 0) {
      std::array<std::int32_t, most_lanes> faces{static_cast<std::int32_t>(face)};
      set_up_some(faces.data(), 1);
    } else {
      one_by_one(mesh_.face_triangle(face), mesh_.is_pair(face) ? 2 : 1);
    }
  }

  const WindowTransform& window_;
  const SetupOptions& options_;
  bool apart_;  // triangles of pairs need ids of their own
  const ClusterDraw& what_;
  const RasterMesh& mesh_;
  SetupScratch& scratch_;
  const WindowRows* rows_ = nullptr;
  float dropped_ = 0.0F;
  const std::uint32_t* corners_[4];
};

HWY_ATTR void set_up(const WindowTransform& window, const SetupOptions& options, bool ids,
                     const WindowRows& rows, const ClusterDraw& cluster, SetupScratch& scratch) {
  SetUp(window, options, ids, cluster, scratch).run(rows);
}

}  // namespace
}  // namespace vislab::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab {

HWY_EXPORT(set_up);

void set_up_cluster(const WindowTransform& window, const SetupOptions& options, bool ids,
                    const WindowRows& rows, const ClusterDraw& cluster, SetupScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(set_up)(window, options, ids, rows, cluster, scratch);
}

void finish_blocks(SetupScratch& scratch) {
  if (scratch.lane == 0) return;
  TriangleBlock& last = scratch.blocks[scratch.block_count - 1];
  for (std::size_t lane = scratch.lane; lane < TriangleBlock::lanes; ++lane) last.clear_lane(lane);
  scratch.lane = 0;
}

}  // namespace vislab
#endif
