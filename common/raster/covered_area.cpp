#include "common/raster/covered_area.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace vislab {
namespace {

constexpr std::size_t edge_count = SetupTriangle::edge_count;

/// Edge functions c + a x + b y, x and y in pixels from the centre of the anchor.
struct Edges {
  std::array<double, edge_count> c, a, b;
};

struct Point {
  double x, y;
};

/// Twice the area, in squares of the grid. a and b are the edges' extents on the grid, turned by a
/// right angle.
std::int64_t whole_area(const Edges& e) {
  // Below 2^52: exact. The second part is 0 for triangles, whose fourth edge is. Edges of what is
  // seen from behind are turned, but still in the other order.
  return std::abs(static_cast<std::int64_t>((e.a[0] * e.b[1] - e.b[0] * e.a[1]) +
                                            (e.a[2] * e.b[3] - e.b[2] * e.a[3])));
}

/// The rectangle (anchor's frame, pixels) cut by the edges.
std::int64_t cut_area(const Edges& e, const Point& low, const Point& high) {
  // Each cut adds a corner; room for what rounding may make of it.
  std::array<Point, 20> polygon{
      {{low.x, low.y}, {high.x, low.y}, {high.x, high.y}, {low.x, high.y}}};
  std::size_t count = 4;
  for (std::size_t k = 0; k < edge_count; ++k) {
    std::array<Point, 20> kept;
    std::size_t kept_count = 0;
    const auto distance = [&](const Point& p) { return e.c[k] + e.a[k] * p.x + e.b[k] * p.y; };
    for (std::size_t i = 0; i < count; ++i) {
      const Point& p = polygon[i];
      const Point& q = polygon[(i + 1) % count];
      const double dp = distance(p);
      const double dq = distance(q);
      if (dp >= 0.0) kept[kept_count++] = p;
      if ((dp >= 0.0) != (dq >= 0.0)) {
        const double t = dp / (dp - dq);
        kept[kept_count++] = {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
      }
    }
    polygon = kept;
    count = kept_count;
  }
  double doubled = 0.0;
  for (std::size_t i = 2; i < count; ++i) {
    const Point& o = polygon[0];
    const Point& p = polygon[i - 1];
    const Point& q = polygon[i];
    doubled += (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x);
  }
  return std::max(std::int64_t{0}, static_cast<std::int64_t>(std::llround(doubled * 65'536.0)));
}

/// Tiles [x0, x1) x [y0, y1); the anchor is the first pixel of the first.
std::int64_t area(const Edges& edges, std::int32_t x0, std::int32_t y0, std::int32_t x1,
                  std::int32_t y1, const Viewport& image) {
  if (x0 > 0 && y0 > 0 && x1 * tile_size < image.width && y1 * tile_size < image.height) {
    return whole_area(edges);
  }
  const double left = x0 * tile_size + 0.5;
  const double below = y0 * tile_size + 0.5;
  const Point high{std::min(x1 * tile_size, image.width) - left,
                   std::min(y1 * tile_size, image.height) - below};
  return cut_area(edges, {-0.5, -0.5}, high);
}

/// Edges go around, so that each side of the rectangle about them is passed there and back.
std::int64_t outline_of(const std::array<double, edge_count>& a,
                        const std::array<double, edge_count>& b, const Viewport& image) {
  double width = 0.0, height = 0.0;
  for (std::size_t k = 0; k < edge_count; ++k) {
    width += 0.5 * std::abs(b[k]);
    height += 0.5 * std::abs(a[k]);
  }
  const auto unit = static_cast<double>(outline_units);
  const double triangles = a[3] != 0.0 || b[3] != 0.0 ? 2.0 : 1.0;
  return static_cast<std::int64_t>(
      triangles * (std::min(width, unit * image.width) + std::min(height, unit * image.height)));
}

}  // namespace

std::int64_t covered_area(const SetupTriangle& triangle, const Viewport& image) {
  Edges edges;
  for (std::size_t k = 0; k < edge_count; ++k) {
    const WindowEdge& edge = triangle.edges[k];
    edges.c[k] = static_cast<double>(edge.at(triangle.anchor_x, triangle.anchor_y));
    edges.a[k] = edge.a;
    edges.b[k] = edge.b;
  }
  return area(edges, triangle.x0 / tile_size, triangle.y0 / tile_size,
              (triangle.x1 + tile_size - 1) / tile_size, (triangle.y1 + tile_size - 1) / tile_size,
              image);
}

std::int64_t covered_area(const TriangleBlock& block, std::size_t lane, const Viewport& image) {
  if (block.x0[lane] >= block.x1[lane] || block.y0[lane] >= block.y1[lane]) return 0;
  Edges edges;
  for (std::size_t k = 0; k < edge_count; ++k) {
    edges.c[k] = block.c[k][lane];
    edges.a[k] = block.a[k][lane];
    edges.b[k] = block.b[k][lane];
  }
  return area(edges, block.x0[lane], block.y0[lane], block.x1[lane], block.y1[lane], image);
}

std::int64_t outline(const SetupTriangle& triangle, const Viewport& image) {
  std::array<double, edge_count> a, b;
  for (std::size_t k = 0; k < edge_count; ++k) {
    a[k] = triangle.edges[k].a;
    b[k] = triangle.edges[k].b;
  }
  return outline_of(a, b, image);
}

std::int64_t outline(const TriangleBlock& block, std::size_t lane, const Viewport& image) {
  if (block.x0[lane] >= block.x1[lane] || block.y0[lane] >= block.y1[lane]) return 0;
  std::array<double, edge_count> a, b;
  for (std::size_t k = 0; k < edge_count; ++k) {
    a[k] = block.a[k][lane];
    b[k] = block.b[k][lane];
  }
  return outline_of(a, b, image);
}

}  // namespace vislab
