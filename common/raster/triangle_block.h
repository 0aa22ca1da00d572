// Triangles and quadrilaterals that are set up, eight at a time, as the kernels that scan-convert
// tiles read them.
#pragma once

#include <array>
#include <cstdint>

#include "common/raster/triangle_setup.h"

namespace vislab {

/// What SetupTriangle says, by kind. Edge functions are relative to the centre of the anchor, the
/// lower left pixel of the triangle's lower left tile; they are whole numbers, exact as doubles.
struct TriangleBlock {
  static constexpr std::size_t lanes = 8;

  alignas(64) std::array<std::array<double, lanes>, SetupTriangle::edge_count> c;
  alignas(64) std::array<std::array<double, lanes>, SetupTriangle::edge_count> a;
  alignas(64) std::array<std::array<double, lanes>, SetupTriangle::edge_count> b;
  // Tiles that may be covered: [x0, x1) x [y0, y1). None, for lanes without a triangle.
  alignas(64) std::array<std::int32_t, lanes> x0, y0, x1, y1;
  // At the centre of the anchor, and steps by pixel.
  alignas(64) std::array<float, lanes> nearness, step_x, step_y;
  std::array<std::uint32_t, lanes> id;

  void clear_lane(std::size_t lane) {
    x0[lane] = y0[lane] = x1[lane] = y1[lane] = 0;
    id[lane] = 0;
  }
  void set_lane(std::size_t lane, const SetupTriangle& triangle) {
    for (std::size_t e = 0; e < c.size(); ++e) {
      const WindowEdge& edge = triangle.edges[e];
      c[e][lane] = static_cast<double>(edge.at(triangle.anchor_x, triangle.anchor_y));
      a[e][lane] = edge.a;
      b[e][lane] = edge.b;
    }
    x0[lane] = triangle.x0 / tile_size;
    y0[lane] = triangle.y0 / tile_size;
    x1[lane] = (triangle.x1 + tile_size - 1) / tile_size;
    y1[lane] = (triangle.y1 + tile_size - 1) / tile_size;
    nearness[lane] = triangle.nearness;
    step_x[lane] = triangle.step_x;
    step_y[lane] = triangle.step_y;
    id[lane] = triangle.id;
  }
};

}  // namespace vislab
