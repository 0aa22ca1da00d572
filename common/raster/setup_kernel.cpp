// Compiled once for each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/raster/setup_kernel.cpp"
#include "common/raster/setup_kernel.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/geometry/rounding.h"
#include "common/raster/setup_constants.h"
#include "common/simd/mask_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vislab::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t most_lanes = TriangleBlock::lanes;
using Doubles = hn::CappedTag<double, most_lanes>;
using Vector = hn::Vec<Doubles>;
constexpr std::size_t double_lanes = HWY_MIN(HWY_LANES(double), most_lanes);
// As many lanes of other types as there are of Doubles.
using NarrowInts = hn::Rebind<std::int32_t, Doubles>;
using NarrowFloats = hn::Rebind<float, Doubles>;
using Longs = hn::Rebind<std::int64_t, Doubles>;
using Ints = hn::CappedTag<std::int32_t, 16>;
constexpr std::size_t int_lanes = HWY_MIN(HWY_LANES(std::int32_t), 16);

HWY_INLINE Vector set(double value) { return hn::Set(Doubles(), value); }

HWY_ATTR void find(const ClusterPlanes& planes, std::span<const RasterDraw> draws,
                   std::vector<ClusterDraw>& out) {
  const Doubles d;
  // The tests are of exact arithmetic's results by this much at most, relative to their terms.
  const auto slack = set(1e-9);
  constexpr std::size_t vectors = ClusterPlanes::lanes / double_lanes;
  for (const RasterDraw& draw : draws) {
    const glm::dmat4x3& m = *draw.transform;
    // The planes in the mesh's frame.
    Vector x[vectors], y[vectors], z[vectors], w[vectors], w_terms[vectors];
    for (std::size_t v = 0; v < vectors; ++v) {
      const auto px = hn::Load(d, planes.x.data() + v * double_lanes);
      const auto py = hn::Load(d, planes.y.data() + v * double_lanes);
      const auto pz = hn::Load(d, planes.z.data() + v * double_lanes);
      const auto pd = hn::Load(d, planes.d.data() + v * double_lanes);
      const auto column = [&](int c) HWY_ATTR {
        return hn::MulAdd(px, set(m[c].x), hn::MulAdd(py, set(m[c].y), hn::Mul(pz, set(m[c].z))));
      };
      x[v] = column(0);
      y[v] = column(1);
      z[v] = column(2);
      const auto tx = hn::Mul(px, set(m[3].x));
      const auto ty = hn::Mul(py, set(m[3].y));
      const auto tz = hn::Mul(pz, set(m[3].z));
      w[v] = hn::Add(hn::Add(tx, ty), hn::Add(tz, pd));
      w_terms[v] = hn::Add(hn::Add(hn::Abs(tx), hn::Abs(ty)), hn::Add(hn::Abs(tz), hn::Abs(pd)));
    }
    const auto clusters = draw.mesh->clusters();
    const std::uint32_t after = draw.first + draw.count;
    if (draw.count == 0) continue;
    for (std::size_t c = draw.first / RasterCluster::greatest_size; c < clusters.size(); ++c) {
      const RasterCluster& cluster = clusters[c];
      if (cluster.first_triangle >= after) break;
      bool outside = false;
      for (std::size_t v = 0; v < vectors; ++v) {
        const auto cx = hn::Mul(x[v], set(cluster.center.x));
        const auto cy = hn::Mul(y[v], set(cluster.center.y));
        const auto cz = hn::Mul(z[v], set(cluster.center.z));
        const auto extent =
            hn::MulAdd(hn::Abs(x[v]), set(cluster.half_size.x),
                       hn::MulAdd(hn::Abs(y[v]), set(cluster.half_size.y),
                                  hn::Mul(hn::Abs(z[v]), set(cluster.half_size.z))));
        const auto at = hn::Add(hn::Add(cx, cy), hn::Add(cz, w[v]));
        const auto terms = hn::Add(hn::Add(hn::Abs(cx), hn::Abs(cy)),
                                   hn::Add(hn::Add(hn::Abs(cz), extent), w_terms[v]));
        const auto greatest = hn::MulAdd(terms, slack, hn::Add(at, extent));
        outside = outside || !hn::AllFalse(d, hn::Lt(greatest, hn::Zero(d)));
      }
      if (outside) continue;
      const std::uint32_t first = std::max(draw.first, cluster.first_triangle);
      const std::uint32_t end = std::min(after, cluster.first_triangle + cluster.triangle_count);
      out.push_back({&draw, &cluster, first, end - first});
    }
  }
}

/// ((a x + b y) + c z) + d
HWY_INLINE Vector row(const std::array<double, 4>& r, Vector x, Vector y, Vector z) {
  const auto xy = hn::Add(hn::Mul(set(r[0]), x), hn::Mul(set(r[1]), y));
  return hn::Add(hn::Add(xy, hn::Mul(set(r[2]), z)), set(r[3]));
}

HWY_INLINE Vector snapped(Vector x, Vector w) {
  const auto grid = hn::Mul(hn::Div(x, w), set(setup::subpixels));
  return hn::Floor(hn::Add(grid, set(0.5)));
}

HWY_ATTR void transform(const WindowTransform& window, const WindowRows& rows,
                        const ClusterDraw& what, SetupScratch& scratch, Coverage coverage,
                        ClusterWindow* where) {
  const Doubles d;
  const NarrowInts di;
  const NarrowFloats df;
  const RasterCluster& cluster = *what.cluster;
  const float* mesh_x = what.draw->mesh->vertices(0) + cluster.first_vertex;
  const float* mesh_y = what.draw->mesh->vertices(1) + cluster.first_vertex;
  const float* mesh_z = what.draw->mesh->vertices(2) + cluster.first_vertex;
  const bool perspective = window.perspective();
  const auto near_m = set(window.camera().lens.near_m);
  const auto greatest = set(setup::greatest_position);
  const auto zero = hn::Zero(d);
  auto least_x = set(INFINITY), least_y = least_x, least_depth = least_x;
  auto greatest_x = set(-INFINITY), greatest_y = greatest_x, greatest_depth = greatest_x;
  scratch.any_beyond = false;
  for (std::size_t v = 0; v < cluster.vertex_count; v += double_lanes) {
    const auto px = hn::PromoteTo(d, hn::LoadU(df, mesh_x + v));
    const auto py = hn::PromoteTo(d, hn::LoadU(df, mesh_y + v));
    const auto pz = hn::PromoteTo(d, hn::LoadU(df, mesh_z + v));
    const auto x = row(rows.x, px, py, pz);
    const auto y = row(rows.y, px, py, pz);
    const auto depth = row(rows.depth, px, py, pz);
    const auto w = perspective ? depth : set(1.0);
    hn::Store(x, d, scratch.x.data() + v);
    hn::Store(y, d, scratch.y.data() + v);
    hn::Store(w, d, scratch.w.data() + v);
    hn::Store(depth, d, scratch.depth.data() + v);
    const auto reach = hn::Mul(greatest, w);
    const auto in_depth = hn::Sub(depth, near_m);
    const auto in_left = hn::Add(x, reach), in_right = hn::Sub(reach, x);
    const auto in_below = hn::Add(y, reach), in_above = hn::Sub(reach, y);
    const auto in =
        hn::Min(hn::Min(hn::Min(in_left, in_right), hn::Min(in_below, in_above)), in_depth);
    const auto regular = hn::Ge(in, zero);
    auto beyond = hn::Zero(di);
    auto snapped_x = snapped(x, w), snapped_y = snapped(y, w);
    if (HWY_UNLIKELY(!hn::AllTrue(d, regular))) {
      scratch.any_beyond = true;
      const auto code = [&](Vector inside, double bit) HWY_ATTR {
        return hn::IfThenElseZero(hn::Not(hn::Ge(inside, zero)), set(bit));
      };
      beyond = hn::DemoteTo(di, hn::Add(hn::Add(hn::Add(code(in_depth, 1.0), code(in_left, 2.0)),
                                                hn::Add(code(in_right, 4.0), code(in_below, 8.0))),
                                        code(in_above, 16.0)));
      snapped_x = hn::IfThenElseZero(regular, snapped_x);
      snapped_y = hn::IfThenElseZero(regular, snapped_y);
    }
    hn::Store(beyond, di, scratch.beyond.data() + v);
    hn::Store(hn::DemoteTo(di, snapped_x), di, scratch.snapped_x.data() + v);
    hn::Store(hn::DemoteTo(di, snapped_y), di, scratch.snapped_y.data() + v);
    least_x = hn::Min(least_x, snapped_x);
    greatest_x = hn::Max(greatest_x, snapped_x);
    least_y = hn::Min(least_y, snapped_y);
    greatest_y = hn::Max(greatest_y, snapped_y);
    least_depth = hn::Min(least_depth, depth);
    greatest_depth = hn::Max(greatest_depth, depth);
  }
  if (where == nullptr) return;
  where->place = BoxPlace::undecided;
  if (scratch.any_beyond) return;
  const auto least = [&](Vector v) HWY_ATTR { return hn::GetLane(hn::MinOfLanes(d, v)); };
  const auto most = [&](Vector v) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(d, v)); };
  // A graphics device may snap otherwise, and round window positions.
  constexpr int margin = setup::subpixels / 32 + 1;
  const int reach = margin + (coverage == Coverage::centres ? 0 : setup::subpixels / 2);
  BoxWindow& box = where->window;
  box.x0 = std::max(0, setup::first_centre(static_cast<std::int32_t>(least(least_x)) - reach));
  box.y0 = std::max(0, setup::first_centre(static_cast<std::int32_t>(least(least_y)) - reach));
  box.x1 = std::min(window.viewport().width,
                    setup::after_last_centre(static_cast<std::int32_t>(most(greatest_x)) + reach));
  box.y1 = std::min(window.viewport().height,
                    setup::after_last_centre(static_cast<std::int32_t>(most(greatest_y)) + reach));
  where->place = BoxPlace::outside;
  if (box.x0 >= box.x1 || box.y0 >= box.y1) return;
  const double depth = least(least_depth);
  if (depth > window.camera().lens.far_m * (1.0 + 1e-6)) return;
  where->place = BoxPlace::inside;
  const double nearest = window.nearness(depth);
  box.nearness = round_up(nearest + window.device_margin() + 1e-6 * std::abs(nearest));
}

/// One corner each of some triangles, by lane.
struct Corner {
  Vector x, y, w, value;  // value: nearness times w
  Vector snapped_x, snapped_y;
};

class SetUp {
 public:
  SetUp(const WindowTransform& window, const SetupOptions& options, const ClusterDraw& what,
        SetupScratch& scratch)
      : window_(window), options_(options), what_(what), scratch_(scratch) {
    const glm::dmat3 linear(*what.draw->transform);
    // What the signed area of triangles that are left out has.
    if (what.draw->front_only) dropped_ = glm::determinant(linear) < 0.0 ? 1.0F : -1.0F;
    for (int corner = 0; corner < 3; ++corner) corners_[corner] = what.draw->mesh->corners(corner);
  }

  HWY_ATTR void run(const WindowRows& rows) {
    const std::uint32_t end = what_.first + what_.count;
    std::size_t survivors = 0;
    for (std::uint32_t first = what_.first; first < end; first += int_lanes) {
      const std::size_t count = std::min<std::size_t>(int_lanes, end - first);
      if (HWY_UNLIKELY(scratch_.any_beyond) && any_beyond(first, count)) {
        // In order, so that the first drawn keeps a tie.
        set_up(survivors);
        survivors = 0;
        one_by_one(rows, first, static_cast<std::uint32_t>(count));
      } else {
        survivors += look(first, count, scratch_.triangle.data() + survivors);
      }
    }
    set_up(survivors);
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
        hn::Or(gather(beyond, corners_[0] + first),
               hn::Or(gather(beyond, corners_[1] + first), gather(beyond, corners_[2] + first)));
    return !hn::AllFalse(di, hn::And(hn::Ne(any, hn::Zero(di)), hn::FirstN(di, count)));
  }

  /// Writes the triangles that may face the right way and may hold a pixel's centre; returns how
  /// many. The signed area is rounded: triangles in doubt are kept.
  HWY_ATTR std::size_t look(std::uint32_t first, std::size_t count, std::int32_t* out) const {
    const Ints di;
    const hn::Rebind<float, Ints> df;
    const auto px = gather(scratch_.snapped_x.data(), corners_[0] + first);
    const auto py = gather(scratch_.snapped_y.data(), corners_[0] + first);
    const auto qx = gather(scratch_.snapped_x.data(), corners_[1] + first);
    const auto qy = gather(scratch_.snapped_y.data(), corners_[1] + first);
    const auto rx = gather(scratch_.snapped_x.data(), corners_[2] + first);
    const auto ry = gather(scratch_.snapped_y.data(), corners_[2] + first);
    const auto first_centre = [&](auto low) HWY_ATTR {
      return hn::ShiftRight<8>(hn::Add(low, hn::Set(di, setup::subpixels / 2 - 1)));
    };
    const auto after_last = [&](auto high) HWY_ATTR {
      return hn::ShiftRight<8>(hn::Add(high, hn::Set(di, setup::subpixels / 2)));
    };
    const auto zero = hn::Zero(di);
    const auto x0 = hn::Max(zero, first_centre(hn::Min(px, hn::Min(qx, rx))));
    const auto y0 = hn::Max(zero, first_centre(hn::Min(py, hn::Min(qy, ry))));
    const auto x1 =
        hn::Min(hn::Set(di, window_.viewport().width), after_last(hn::Max(px, hn::Max(qx, rx))));
    const auto y1 =
        hn::Min(hn::Set(di, window_.viewport().height), after_last(hn::Max(py, hn::Max(qy, ry))));
    auto keep = hn::And(hn::And(hn::Lt(x0, x1), hn::Lt(y0, y1)), hn::FirstN(di, count));
    if (dropped_ != 0.0F) {
      const auto difference = [&](auto a, auto b)
                                  HWY_ATTR { return hn::ConvertTo(df, hn::Sub(a, b)); };
      const auto left = hn::Mul(difference(qx, px), difference(ry, py));
      const auto right = hn::Mul(difference(qy, py), difference(rx, px));
      const auto area = hn::Mul(hn::Sub(left, right), hn::Set(df, dropped_));
      const auto error =
          hn::Mul(hn::Add(hn::Abs(left), hn::Abs(right)), hn::Set(df, 1.0F / 1'048'576.0F));
      keep = hn::And(keep, hn::RebindMask(di, hn::Le(area, error)));
    }
    const auto ids = hn::Add(hn::Iota(di, 0), hn::Set(di, static_cast<std::int32_t>(first)));
    return hn::CompressStore(ids, keep, di, out);
  }

  HWY_INLINE Corner corner(const std::uint32_t* corners, hn::Vec<NarrowInts> triangles) const {
    const Doubles d;
    const Longs dl;
    const NarrowInts di;
    const auto narrow =
        hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(corners), triangles);
    const auto index = hn::PromoteTo(dl, narrow);
    Corner c;
    c.x = hn::GatherIndex(d, scratch_.x.data(), index);
    c.y = hn::GatherIndex(d, scratch_.y.data(), index);
    c.w = hn::GatherIndex(d, scratch_.w.data(), index);
    c.value = window_.perspective() ? set(1.0)
                                    : hn::Neg(hn::GatherIndex(d, scratch_.depth.data(), index));
    c.snapped_x = hn::PromoteTo(d, hn::GatherIndex(di, scratch_.snapped_x.data(), narrow));
    c.snapped_y = hn::PromoteTo(d, hn::GatherIndex(di, scratch_.snapped_y.data(), narrow));
    return c;
  }

  HWY_ATTR void set_up(std::size_t survivors) {
    for (std::size_t i = 0; i < survivors; i += double_lanes) {
      set_up_some(scratch_.triangle.data() + i, std::min(double_lanes, survivors - i));
    }
  }

  HWY_ATTR void set_up_some(std::int32_t* triangles, std::size_t count) {
    const Doubles d;
    const NarrowInts di;
    const auto zero = hn::Zero(d);
    const auto in_range = hn::FirstN(di, count);
    // Lanes beyond the count repeat the first.
    const auto which =
        hn::IfThenElse(in_range, hn::LoadU(di, triangles), hn::Set(di, triangles[0]));
    Corner v[3];
    for (int i = 0; i < 3; ++i) v[i] = corner(corners_[i], which);

    const auto area = hn::Sub(
        hn::Mul(hn::Sub(v[1].snapped_x, v[0].snapped_x), hn::Sub(v[2].snapped_y, v[0].snapped_y)),
        hn::Mul(hn::Sub(v[1].snapped_y, v[0].snapped_y), hn::Sub(v[2].snapped_x, v[0].snapped_x)));
    auto keep = hn::Ne(area, zero);
    if (dropped_ != 0.0F) keep = hn::And(keep, hn::Lt(hn::Mul(area, set(dropped_)), zero));

    // Pixels, and the anchor.
    const auto least3 = [](Vector a, Vector b, Vector c)
                            HWY_ATTR { return hn::Min(a, hn::Min(b, c)); };
    const auto most3 = [](Vector a, Vector b, Vector c)
                           HWY_ATTR { return hn::Max(a, hn::Max(b, c)); };
    const auto by_grid = set(1.0 / setup::subpixels);
    const auto half = set(setup::subpixels / 2);
    const auto first_centre = [&](Vector low) HWY_ATTR {
      return hn::Floor(hn::Mul(hn::Add(low, hn::Sub(half, set(1.0))), by_grid));
    };
    const auto after_last = [&](Vector high) HWY_ATTR {
      return hn::Floor(hn::Mul(hn::Add(high, half), by_grid));
    };
    const auto x0 =
        hn::Max(zero, first_centre(least3(v[0].snapped_x, v[1].snapped_x, v[2].snapped_x)));
    const auto y0 =
        hn::Max(zero, first_centre(least3(v[0].snapped_y, v[1].snapped_y, v[2].snapped_y)));
    const auto x1 = hn::Min(set(window_.viewport().width),
                            after_last(most3(v[0].snapped_x, v[1].snapped_x, v[2].snapped_x)));
    const auto y1 = hn::Min(set(window_.viewport().height),
                            after_last(most3(v[0].snapped_y, v[1].snapped_y, v[2].snapped_y)));
    keep = hn::And(keep, hn::And(hn::Lt(x0, x1), hn::Lt(y0, y1)));
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
    for (Corner& c : v) {
      c.x = hn::Sub(c.x, hn::Mul(pixel_x, c.w));
      c.y = hn::Sub(c.y, hn::Mul(pixel_y, c.w));
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
    keep = hn::And(
        keep, hn::And(hn::Gt(hn::Abs(determinant), hn::Mul(set(setup::least_determinant), terms)),
                      hn::Lt(terms, set(setup::greatest_terms))));
    a = hn::Div(a, determinant);
    b = hn::Div(b, determinant);
    value = hn::Div(value, determinant);
    keep = hn::And(keep, hn::Lt(hn::Add(hn::Add(hn::Abs(a), hn::Abs(b)), hn::Abs(value)),
                                set(setup::greatest_plane)));
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
    const auto clockwise = hn::Lt(area, zero);
    const Vector px = v[0].snapped_x, py = v[0].snapped_y;
    const Vector qx = hn::IfThenElse(clockwise, v[2].snapped_x, v[1].snapped_x);
    const Vector qy = hn::IfThenElse(clockwise, v[2].snapped_y, v[1].snapped_y);
    const Vector rx = hn::IfThenElse(clockwise, v[1].snapped_x, v[2].snapped_x);
    const Vector ry = hn::IfThenElse(clockwise, v[1].snapped_y, v[2].snapped_y);
    Vector edge_a[3], edge_b[3], edge_c[3];
    const auto edge = [&](std::size_t e, Vector fx, Vector fy, Vector tx, Vector ty) HWY_ATTR {
      const auto ea = hn::Sub(fy, ty);
      const auto eb = hn::Sub(tx, fx);
      const auto owns = hn::Or(hn::Gt(ea, zero), hn::And(hn::Eq(ea, zero), hn::Lt(eb, zero)));
      auto at = hn::Add(hn::Mul(ea, hn::Sub(half, fx)), hn::Mul(eb, hn::Sub(half, fy)));
      at = hn::Sub(at, hn::IfThenElse(owns, zero, set(1.0)));
      if (options_.coverage == Coverage::whole_pixels) {
        at = hn::Sub(at, hn::Mul(hn::Add(hn::Abs(ea), hn::Abs(eb)), set(setup::subpixels / 2 + 1)));
      }
      at = hn::Floor(hn::Mul(at, by_grid));
      edge_a[e] = ea;
      edge_b[e] = eb;
      edge_c[e] = hn::Add(at, hn::Add(hn::Mul(ea, anchor_x), hn::Mul(eb, anchor_y)));
    };
    edge(0, px, py, qx, qy);
    edge(1, qx, qy, rx, ry);
    edge(2, rx, ry, px, py);

    // Packed behind what is there. Whole vectors are written: their ends are overwritten later.
    const auto kept_bits = simd::HWY_NAMESPACE::mask_bits(d, keep) & ((1U << count) - 1);
    const auto kept = static_cast<std::size_t>(std::popcount(kept_bits));
    if (kept == 0) return;
    scratch_.drawn += kept;
    const auto ids = hn::Add(
        which, hn::Set(di, static_cast<std::int32_t>(what_.draw->first_id - what_.draw->first)));
    alignas(64) TriangleBlock fresh;
    const auto store = [&](Vector value_of, std::array<double, most_lanes>& to)
                           HWY_ATTR { hn::Store(value_of, d, to.data()); };
    const auto store_int = [&](Vector value_of, std::array<std::int32_t, most_lanes>& to)
                               HWY_ATTR { hn::Store(hn::DemoteTo(di, value_of), di, to.data()); };
    const auto store_float = [&](Vector value_of, std::array<float, most_lanes>& to) HWY_ATTR {
      const NarrowFloats df;
      hn::Store(hn::DemoteTo(df, value_of), df, to.data());
    };
    const bool whole = kept == most_lanes && scratch_.lane == 0;
    TriangleBlock& to = whole ? next_block() : fresh;
    for (std::size_t e = 0; e < 3; ++e) {
      store(edge_a[e], to.a[e]);
      store(edge_b[e], to.b[e]);
      store(edge_c[e], to.c[e]);
    }
    store_int(tile_x0, to.x0);
    store_int(tile_y0, to.y0);
    store_int(tile_x1, to.x1);
    store_int(tile_y1, to.y1);
    store_float(value, to.nearness);
    store_float(a, to.step_x);
    store_float(b, to.step_y);
    hn::Store(ids, di, reinterpret_cast<std::int32_t*>(to.id.data()));
    if (whole) return;
    for (std::uint32_t rest = kept_bits; rest != 0; rest &= rest - 1) {
      copy_lane(fresh, static_cast<std::size_t>(std::countr_zero(rest)));
    }
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

  void copy_lane(const TriangleBlock& from, std::size_t i) const {
    std::size_t lane = 0;
    TriangleBlock& to = next_lane(lane);
    for (std::size_t e = 0; e < 3; ++e) {
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

  void one_by_one(const WindowRows& rows, std::uint32_t first, std::uint32_t count) const {
    const RasterMesh& mesh = *what_.draw->mesh;
    const auto positions = mesh.positions();
    for (std::uint32_t i = first; i < first + count; ++i) {
      // Nothing is left of what lies wholly beyond one plane.
      if ((scratch_.beyond[corners_[0][i]] & scratch_.beyond[corners_[1][i]] &
           scratch_.beyond[corners_[2][i]]) != 0) {
        continue;
      }
      const glm::uvec3& t = mesh.triangles()[i];
      std::array<SetupTriangle, max_setup_pieces> pieces;
      const SetupResult result = set_up_triangle(
          window_, {rows(positions[t.x]), rows(positions[t.y]), rows(positions[t.z])},
          what_.draw->first_id + (i - what_.draw->first), options_, pieces);
      const Facing dropped = dropped_ < 0.0F ? Facing::back : Facing::front;
      if (dropped_ != 0.0F && result.facing == dropped) continue;
      for (int piece = 0; piece < result.count; ++piece) {
        std::size_t lane = 0;
        TriangleBlock& block = next_lane(lane);
        block.set_lane(lane, pieces[static_cast<std::size_t>(piece)]);
      }
      scratch_.drawn += result.count > 0 ? 1 : 0;
    }
  }

  const WindowTransform& window_;
  const SetupOptions& options_;
  const ClusterDraw& what_;
  SetupScratch& scratch_;
  float dropped_ = 0.0F;
  const std::uint32_t* corners_[3];
};

HWY_ATTR void set_up(const WindowTransform& window, const SetupOptions& options,
                     const WindowRows& rows, const ClusterDraw& cluster, SetupScratch& scratch) {
  SetUp(window, options, cluster, scratch).run(rows);
}

}  // namespace
}  // namespace vislab::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab {

HWY_EXPORT(find);
HWY_EXPORT(transform);
HWY_EXPORT(set_up);

ClusterPlanes::ClusterPlanes(const WindowTransform& window) {
  const WindowRows& rows = window.world();
  const double near_m = window.camera().lens.near_m;
  const double width = window.viewport().width, height = window.viewport().height;
  // left, right, below, above: what is at least 0 in the window, times w.
  const auto plane = [&](const std::array<double, 4>& row, double sign, double size,
                         std::size_t i) {
    std::array<double, 4> sum{};
    for (std::size_t k = 0; k < 4; ++k) {
      const double w = window.perspective() ? rows.depth[k] : (k == 3 ? 1.0 : 0.0);
      sum[k] = sign * row[k] + size * w;
    }
    x[i] = sum[0];
    y[i] = sum[1];
    z[i] = sum[2];
    d[i] = sum[3];
  };
  plane(rows.x, 1.0, 0.0, 0);
  plane(rows.x, -1.0, width, 1);
  plane(rows.y, 1.0, 0.0, 2);
  plane(rows.y, -1.0, height, 3);
  for (std::size_t i = 4; i < lanes; ++i) {
    x[i] = rows.depth[0];
    y[i] = rows.depth[1];
    z[i] = rows.depth[2];
    d[i] = rows.depth[3] - near_m;
  }
}

void find_clusters(const ClusterPlanes& planes, std::span<const RasterDraw> draws,
                   std::vector<ClusterDraw>& out) {
  HWY_DYNAMIC_DISPATCH(find)(planes, draws, out);
}

void transform_cluster(const WindowTransform& window, const WindowRows& rows,
                       const ClusterDraw& cluster, SetupScratch& scratch, Coverage coverage,
                       ClusterWindow* where) {
  HWY_DYNAMIC_DISPATCH(transform)(window, rows, cluster, scratch, coverage, where);
}

void set_up_cluster(const WindowTransform& window, const SetupOptions& options,
                    const WindowRows& rows, const ClusterDraw& cluster, SetupScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(set_up)(window, options, rows, cluster, scratch);
}

void finish_blocks(SetupScratch& scratch) {
  if (scratch.lane == 0) return;
  TriangleBlock& last = scratch.blocks[scratch.block_count - 1];
  for (std::size_t lane = scratch.lane; lane < TriangleBlock::lanes; ++lane) last.clear_lane(lane);
  scratch.lane = 0;
}

}  // namespace vislab
#endif
