#include "common/raster/triangle_setup.h"

#include <algorithm>
#include <cmath>

#include "common/raster/setup_constants.h"

namespace vislab {
namespace {

using setup::after_last_centre;
using setup::first_centre;
using setup::greatest_position;
using setup::subpixels;

struct Homogeneous {
  double x, y, w, depth;
};

/// What is left of a triangle after clipping.
struct Polygon {
  std::array<Homogeneous, 8> corners;
  int count = 0;
};

/// Keeps the part where distance(corner) >= 0. New corners are computed from the inner to the outer
/// one, so that two triangles with a common edge get the same.
template <typename Distance>
void clip(Polygon& polygon, Distance&& distance) {
  Polygon kept;
  for (int i = 0; i < polygon.count; ++i) {
    const Homogeneous& p = polygon.corners[static_cast<std::size_t>(i)];
    const Homogeneous& q = polygon.corners[static_cast<std::size_t>((i + 1) % polygon.count)];
    const double dp = distance(p);
    const double dq = distance(q);
    const auto between = [](const Homogeneous& in, double d_in, const Homogeneous& out,
                            double d_out) {
      const double t = d_in / (d_in - d_out);
      return Homogeneous{in.x + t * (out.x - in.x), in.y + t * (out.y - in.y),
                         in.w + t * (out.w - in.w), in.depth + t * (out.depth - in.depth)};
    };
    const auto add = [&](const Homogeneous& corner) {
      kept.corners[static_cast<std::size_t>(kept.count++)] = corner;
    };
    if (dp >= 0.0) add(p);
    if (dp >= 0.0 && dq < 0.0) add(between(p, dp, q, dq));
    if (dp < 0.0 && dq >= 0.0) add(between(q, dq, p, dp));
  }
  polygon = kept;
}

/// Nearness as a function of the window position: a x + b y + value, from the centre of a pixel.
struct NearnessPlane {
  double a, b, value;
};

/// From the corners before clipping. The pixel's centre is taken off the window positions first:
/// with numbers as small as the triangle the determinant keeps its digits wherever it is seen.
/// False if the triangle is seen edge-on, up to rounding, or anything is too large to be finite.
bool nearness_plane(const std::array<Homogeneous, 3>& corners, bool perspective, int pixel_x,
                    int pixel_y, NearnessPlane& plane) {
  std::array<Homogeneous, 3> v = corners;
  for (Homogeneous& corner : v) {
    corner.x -= (pixel_x + 0.5) * corner.w;
    corner.y -= (pixel_y + 0.5) * corner.w;
  }
  // Cofactors of the matrix of the corners; a x + b y + value w takes each corner to its nearness
  // times w.
  double determinant = 0.0, terms = 0.0, a = 0.0, b = 0.0, value = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Homogeneous& q = v[(i + 1) % 3];
    const Homogeneous& r = v[(i + 2) % 3];
    const double qr = q.y * r.w;
    const double rq = q.w * r.y;
    determinant += v[i].x * (qr - rq);
    terms += std::abs(v[i].x) * (std::abs(qr) + std::abs(rq));
    const double nearness = perspective ? 1.0 : -v[i].depth;
    a += nearness * (qr - rq);
    b += nearness * (q.w * r.x - q.x * r.w);
    value += nearness * (q.x * r.y - q.y * r.x);
  }
  if (!(std::abs(determinant) > setup::least_determinant * terms) ||
      !(terms < setup::greatest_terms)) {
    return false;
  }
  plane = {a / determinant, b / determinant, value / determinant};
  return (std::abs(plane.a) + std::abs(plane.b)) + std::abs(plane.value) < setup::greatest_plane;
}

struct Snapped {
  std::int32_t x, y;
};

Snapped snapped(const Homogeneous& corner) {
  return {static_cast<std::int32_t>(std::floor(corner.x / corner.w * subpixels + 0.5)),
          static_cast<std::int32_t>(std::floor(corner.y / corner.w * subpixels + 0.5))};
}

std::int64_t doubled_area(const Snapped& p, const Snapped& q, const Snapped& r) {
  return (std::int64_t{q.x} - p.x) * (std::int64_t{r.y} - p.y) -
         (std::int64_t{q.y} - p.y) * (std::int64_t{r.x} - p.x);
}

/// False if no pixel's centre may be covered.
template <std::size_t count>
bool set_pixels(SetupTriangle& t, const std::array<Snapped, count>& corners,
                const Viewport& viewport) {
  const auto [left, right] = std::ranges::minmax(corners, {}, &Snapped::x);
  const auto [below, above] = std::ranges::minmax(corners, {}, &Snapped::y);
  t.x0 = std::max(0, first_centre(left.x));
  t.y0 = std::max(0, first_centre(below.y));
  t.x1 = std::min(viewport.width, after_last_centre(right.x));
  t.y1 = std::min(viewport.height, after_last_centre(above.y));
  t.anchor_x = t.x0 & -tile_size;
  t.anchor_y = t.y0 & -tile_size;
  return t.x0 < t.x1 && t.y0 < t.y1;
}

/// After set_pixels. False as nearness_plane.
bool set_plane(SetupTriangle& t, const std::array<Homogeneous, 3>& corners, bool perspective,
               const SetupOptions& options) {
  NearnessPlane plane;
  if (!nearness_plane(corners, perspective, t.anchor_x, t.anchor_y, plane)) return false;
  double value = plane.value;
  if (options.rounding == DepthRounding::lowered) {
    const double terms_here = std::abs(value) +
                              std::abs(plane.a) * (t.x1 - t.anchor_x + tile_size) +
                              std::abs(plane.b) * (t.y1 - t.anchor_y + tile_size);
    value -= setup::plane_error * terms_here;
    if (options.coverage == Coverage::whole_pixels) {
      value -= 0.5 * (std::abs(plane.a) + std::abs(plane.b));
    }
  }
  t.nearness = static_cast<float>(value);
  t.step_x = static_cast<float>(plane.a);
  t.step_y = static_cast<float>(plane.b);
  return true;
}

/// By how many steps of the grid a triangle's or pair's outer edges are moved inward.
template <std::size_t count>
std::int64_t inset(const std::array<Snapped, count>& corners, const Viewport& viewport,
                   const SetupOptions& options) {
  if (options.coverage == Coverage::whole_pixels) return setup::whole_pixel_inset;
  if (options.rounding == DepthRounding::nearest) return 0;
  const bool leaves = std::ranges::any_of(corners, [&](const Snapped& corner) {
    return corner.x < 0 || corner.y < 0 || corner.x > subpixels * viewport.width ||
           corner.y > subpixels * viewport.height;
  });
  return leaves ? setup::border_inset : 0;
}

WindowEdge edge(const Snapped& p, const Snapped& q, std::int64_t inset) {
  const std::int64_t a = std::int64_t{p.y} - q.y;
  const std::int64_t b = std::int64_t{q.x} - p.x;
  // Left edges run down, lower edges run right: the inside is to the left of an edge.
  const bool owns_border = a > 0 || (a == 0 && b > 0);
  std::int64_t value = a * (subpixels / 2 - std::int64_t{p.x}) +
                       b * (subpixels / 2 - std::int64_t{p.y}) - (owns_border ? 0 : 1);
  value -= (std::abs(a) + std::abs(b)) * inset;
  return {value >> 8, static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)};
}

}  // namespace

SetupResult set_up_triangle(const WindowTransform& window,
                            const std::array<WindowPoint, 3>& vertices, std::uint32_t id,
                            const SetupOptions& options,
                            std::array<SetupTriangle, max_setup_pieces>& out) {
  SetupResult result;
  const bool perspective = window.perspective();
  std::array<Homogeneous, 3> v;
  for (std::size_t i = 0; i < 3; ++i) {
    v[i] = {vertices[i].x, vertices[i].y, perspective ? vertices[i].depth : 1.0, vertices[i].depth};
  }
  for (const Homogeneous& p : v) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.depth)) return result;
  }
  Polygon polygon;
  for (std::size_t i = 0; i < 3; ++i) polygon.corners[i] = v[i];
  polygon.count = 3;
  const double near_m = window.camera().lens.near_m;
  const auto beyond = [&](auto&& distance) {
    return std::ranges::any_of(v, [&](const Homogeneous& p) { return distance(p) < 0.0; });
  };
  const auto before_near = [&](const Homogeneous& p) { return p.depth - near_m; };
  if (beyond(before_near)) clip(polygon, before_near);
  const auto left = [](const Homogeneous& p) { return p.x + greatest_position * p.w; };
  const auto right = [](const Homogeneous& p) { return greatest_position * p.w - p.x; };
  const auto below = [](const Homogeneous& p) { return p.y + greatest_position * p.w; };
  const auto above = [](const Homogeneous& p) { return greatest_position * p.w - p.y; };
  if (beyond(left)) clip(polygon, left);
  if (beyond(right)) clip(polygon, right);
  if (beyond(below)) clip(polygon, below);
  if (beyond(above)) clip(polygon, above);
  if (polygon.count < 3) return result;

  std::array<Snapped, 8> corners;
  for (int i = 0; i < polygon.count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    corners[at] = snapped(polygon.corners[at]);
  }
  for (int i = 1; i + 1 < polygon.count; ++i) {
    Snapped p = corners[0];
    Snapped q = corners[static_cast<std::size_t>(i)];
    Snapped r = corners[static_cast<std::size_t>(i + 1)];
    const std::int64_t area = doubled_area(p, q, r);
    if (area == 0) continue;
    result.facing = area > 0 ? Facing::front : Facing::back;
    if (area < 0) std::swap(q, r);
    SetupTriangle& t = out[static_cast<std::size_t>(result.count)];
    if (!set_pixels(t, std::array{p, q, r}, window.viewport())) continue;
    if (!set_plane(t, v, perspective, options)) continue;
    const std::int64_t inward = inset(std::array{p, q, r}, window.viewport(), options);
    t.edges = {edge(p, q, inward), edge(q, r, inward), edge(r, p, inward), WindowEdge{}};
    t.id = id;
    ++result.count;
  }
  return result;
}

bool set_up_pair(const WindowTransform& window, const std::array<WindowPoint, 4>& vertices,
                 std::uint32_t id, const SetupOptions& options, SetupResult& result,
                 std::array<SetupTriangle, 2>& out) {
  result = {};
  const bool perspective = window.perspective();
  const double near_m = window.camera().lens.near_m;
  std::array<Homogeneous, 4> v;
  std::array<Snapped, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const double w = perspective ? vertices[i].depth : 1.0;
    v[i] = {vertices[i].x, vertices[i].y, w, vertices[i].depth};
    const double reach = greatest_position * w;
    const bool regular = v[i].depth - near_m >= 0.0 && v[i].x + reach >= 0.0 &&
                         reach - v[i].x >= 0.0 && v[i].y + reach >= 0.0 && reach - v[i].y >= 0.0;
    if (!regular) return false;
    corners[i] = snapped(v[i]);
  }
  const auto& [p, q, r, s] = corners;
  const std::array<std::int64_t, 4> areas{doubled_area(p, q, r), doubled_area(p, r, s),
                                          doubled_area(p, q, s), doubled_area(q, r, s)};
  const bool front = std::ranges::all_of(areas, [](std::int64_t area) { return area > 0; });
  const bool back = std::ranges::all_of(areas, [](std::int64_t area) { return area < 0; });
  if (!front && !back) return false;
  SetupTriangle both;
  both.id = id;
  if (set_pixels(both, corners, window.viewport())) {
    if (!set_plane(both, {v[0], v[1], v[2]}, perspective, options)) return false;
    const std::int64_t inward = inset(corners, window.viewport(), options);
    const auto line = [&](const Snapped& from, const Snapped& to, std::int64_t by) {
      return front ? edge(from, to, by) : edge(to, from, by);
    };
    const auto side = [&](const Snapped& from, const Snapped& to) {
      return line(from, to, inward);
    };
    both.edges = {side(p, q), side(q, r), side(r, s), side(s, p)};
    out = {both, both};
    result.count = 1;
    if (options.coverage == Coverage::centres) {
      out[0].edges = {side(p, q), side(q, r), line(r, p, 0), WindowEdge{}};
      out[1].edges = {line(p, r, 0), side(r, s), side(s, p), WindowEdge{}};
      out[1].id = id + 1;
      result.count = 2;
    }
  }
  result.facing = front ? Facing::front : Facing::back;
  return true;
}

}  // namespace vislab
