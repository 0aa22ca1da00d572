// Which clusters have a part in the window, and where their vertices lie there. Compiled once for
// each instruction set, by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/raster/cluster_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/rounding.h"
#include "common/raster/margins.h"
#include "common/raster/setup_constants.h"
#include "common/raster/setup_kernel.h"

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

HWY_INLINE Vector set(double value) { return hn::Set(Doubles(), value); }

/// Centre and half size of the box of a cluster's box in the world; half sizes are enlarged by more
/// than what rounding may do to both.
struct WorldBox {
  double center[3], half[3];
};

HWY_INLINE WorldBox world_box(const glm::dmat4x3& m, const RasterCluster& cluster) {
  constexpr double slack = 1e-9;
  WorldBox box;
  for (int i = 0; i < 3; ++i) {
    const double x = m[0][i] * cluster.center.x, y = m[1][i] * cluster.center.y;
    const double z = m[2][i] * cluster.center.z;
    const double half = std::abs(m[0][i]) * cluster.half_size.x +
                        std::abs(m[1][i]) * cluster.half_size.y +
                        std::abs(m[2][i]) * cluster.half_size.z;
    box.center[i] = (x + y) + (z + m[3][i]);
    box.half[i] = half + slack * (half + std::abs(box.center[i]) + std::abs(m[3][i]));
  }
  return box;
}

HWY_ATTR void find(const ClusterPlanes& planes, std::span<const RasterDraw> draws,
                   std::vector<ClusterDraw>& out) {
  const Doubles d;
  constexpr std::size_t vectors = ClusterPlanes::lanes / double_lanes;
  Vector x[vectors], y[vectors], z[vectors], w[vectors];
  for (std::size_t v = 0; v < vectors; ++v) {
    x[v] = hn::Load(d, planes.x.data() + v * double_lanes);
    y[v] = hn::Load(d, planes.y.data() + v * double_lanes);
    z[v] = hn::Load(d, planes.z.data() + v * double_lanes);
    const auto constant = hn::Load(d, planes.d.data() + v * double_lanes);
    w[v] = hn::Add(hn::Mul(hn::Abs(constant), set(1e-9)), constant);
  }
  constexpr std::size_t near_plane = ClusterPlanes::lanes - 1;
  for (const RasterDraw& draw : draws) {
    if (draw.count == 0) continue;
    const auto clusters = draw.mesh->clusters();
    const std::uint32_t after = draw.first + draw.count;
    for (std::size_t c = draw.first / RasterCluster::greatest_size; c < clusters.size(); ++c) {
      const RasterCluster& cluster = clusters[c];
      if (cluster.first_triangle >= after) break;
      const WorldBox box = world_box(*draw.transform, cluster);
      bool outside = false;
      for (std::size_t v = 0; v < vectors; ++v) {
        // Not fused: what is outside is told to callers, and must not depend on the processor.
        const auto along = [&](Vector across, Vector up, Vector back, const auto& by) HWY_ATTR {
          return hn::Add(hn::Mul(across, set(by[0])),
                         hn::Add(hn::Mul(up, set(by[1])), hn::Mul(back, set(by[2]))));
        };
        const auto at = hn::Add(along(x[v], y[v], z[v], box.center), w[v]);
        const auto reach = along(hn::Abs(x[v]), hn::Abs(y[v]), hn::Abs(z[v]), box.half);
        outside = outside || !hn::AllFalse(d, hn::Lt(hn::Add(at, reach), hn::Zero(d)));
      }
      if (outside) continue;
      const std::uint32_t first = std::max(draw.first, cluster.first_triangle);
      const std::uint32_t end = std::min(after, cluster.first_triangle + cluster.triangle_count);
      const double beyond_near = planes.x[near_plane] * box.center[0] +
                                 planes.y[near_plane] * box.center[1] +
                                 planes.z[near_plane] * box.center[2] + planes.d[near_plane] -
                                 std::abs(planes.x[near_plane]) * box.half[0] -
                                 std::abs(planes.y[near_plane]) * box.half[1] -
                                 std::abs(planes.z[near_plane]) * box.half[2];
      out.push_back({&draw, &cluster, first, end - first, static_cast<float>(beyond_near)});
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
  constexpr int margin = static_cast<int>(setup::subpixels * snapping_margin_px) + 1;
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
  if (depth > window.camera().lens.far_m * (1.0 + rounding_margin)) return;
  where->place = BoxPlace::inside;
  const double nearest = window.nearness(depth);
  box.nearness = round_up(nearest + window.device_margin() + rounding_margin * std::abs(nearest));
}

}  // namespace
}  // namespace vislab::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vislab {

HWY_EXPORT(find);
HWY_EXPORT(transform);

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

}  // namespace vislab
#endif
