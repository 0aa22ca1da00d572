// Triangles made ready for scan conversion: clipped, snapped to the window's grid, with edge
// functions and a plane of nearness. Every rasteriser of the lab works from this, so that all of
// them cover the same pixels and see the same depths, bit for bit.
//
// Idea: vertices are snapped to 1/256 pixel; edge functions are exact integers (Pineda 1988). With
//   an edge in common, exactly one of two triangles has a pixel whose centre lies on it: the upper
//   or, at upright edges, the right one, as the graphics device does it (OpenGL leaves this open).
//   By another rule a row of pixels would hide what the device shows. The plane of nearness comes
//   from the triangle before it was snapped or clipped.
// Coverage: a pixel counts if its centre does, or (whole_pixels) if all of it lies inside of the
//   triangle, by more than snapping can move an edge.
// Depth: exact up to rounding, or (lowered) never nearer than the triangle is: the plane is lowered
//   by a bound of what rounding can do, and with whole_pixels to its farthest value in the pixel.
// Border: lowered triangles that leave the image lose the step of the grid along their edges by
// which
//   a device that clips before it snaps may cover less.
// Limits: what lies within 1/512 pixel of an edge may be drawn or not, by snapping. Triangles that
//   are seen edge-on, up to rounding, are not drawn. Window positions beyond 32,768 pixels are
//   clipped.
// Cost: about 150 operations a triangle.
#pragma once

#include <array>
#include <cstdint>

#include "common/raster/window_transform.h"

namespace vislab {

enum class Coverage { centres, whole_pixels };
enum class DepthRounding { nearest, lowered };

/// Greater or equal 0 inside: c + a x + b y at the centre of pixel (x, y), exact, in units of
/// 1/256 of a square of the grid, rounded down.
struct WindowEdge {
  std::int64_t c = 0;
  std::int32_t a = 0;
  std::int32_t b = 0;

  std::int64_t at(int x, int y) const { return c + std::int64_t{a} * x + std::int64_t{b} * y; }
};

/// Tiles are squares of this many pixels; (0, 0) is the image's lower left one.
inline constexpr int tile_size = 8;
inline constexpr int tile_pixels = tile_size * tile_size;

struct SetupTriangle {
  // Pixels that may be covered: [x0, x1) x [y0, y1), in the image; never empty.
  std::int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  // The fourth is 0 everywhere, so does not count, but of quadrilaterals.
  static constexpr std::size_t edge_count = 4;
  std::array<WindowEdge, edge_count> edges;
  // The plane of nearness: its value at the centre of pixel (anchor_x, anchor_y), which is the
  // lower left pixel of a tile, and its steps by pixel.
  std::int32_t anchor_x = 0, anchor_y = 0;
  float nearness = 0.0F, step_x = 0.0F, step_y = 0.0F;
  std::uint32_t id = 0;

  bool covers(int x, int y) const {
    return (edges[0].at(x, y) | edges[1].at(x, y) | edges[2].at(x, y) | edges[3].at(x, y)) >= 0;
  }
  /// At the centre of the lower left pixel of the tile that holds pixel (x, y).
  float nearness_of_tile(int x, int y) const {
    const auto dx = static_cast<float>((x & -tile_size) - anchor_x);
    const auto dy = static_cast<float>((y & -tile_size) - anchor_y);
    return (nearness + step_x * dx) + step_y * dy;
  }
  /// At the centre of pixel (x, y): the very bits that every rasteriser stores.
  float nearness_at(int x, int y) const {
    const auto dx = static_cast<float>(x & (tile_size - 1));
    const auto dy = static_cast<float>(y & (tile_size - 1));
    return nearness_of_tile(x, y) + (step_x * dx + step_y * dy);
  }
};

struct SetupOptions {
  Coverage coverage = Coverage::centres;
  DepthRounding rounding = DepthRounding::nearest;
};

/// Clipping cuts a triangle into at most this many.
inline constexpr int max_setup_pieces = 6;

/// Which side of a triangle faces the eye: its window positions are counter-clockwise or not.
enum class Facing { front, back, edge_on };

struct SetupResult {
  int count = 0;  // pieces written
  Facing facing = Facing::edge_on;
};

/// Clips a triangle against the near plane and the range of window positions, and writes what is
/// left of it and may cover a pixel of the viewport to `out`; all pieces carry `id`. What lies
/// beyond the far plane is not clipped: its nearness is below the far plane's.
SetupResult set_up_triangle(const WindowTransform& window,
                            const std::array<WindowPoint, 3>& vertices, std::uint32_t id,
                            const SetupOptions& options,
                            std::array<SetupTriangle, max_setup_pieces>& out);

/// The triangles (0, 1, 2) and (0, 2, 3) of four vertices that make up a plane convex
/// quadrilateral, with one plane of nearness, so that they can be drawn as one. False if they
/// cannot, since they need clipping, or are not convex any more when snapped, or are seen edge-on:
/// each is then to be set up by itself. Else as set_up_triangle: Coverage::centres gives the two
/// triangles with the ids `id` and `id` + 1, whole_pixels the quadrilateral with `id`, which has
/// the pixels on the diagonal, too.
bool set_up_pair(const WindowTransform& window, const std::array<WindowPoint, 4>& vertices,
                 std::uint32_t id, const SetupOptions& options, SetupResult& result,
                 std::array<SetupTriangle, 2>& out);

/// Calls f(x, y, nearness) for every covered pixel, row by row from below.
template <typename Function>
void for_each_covered_pixel(const SetupTriangle& triangle, Function&& f) {
  for (int y = triangle.y0; y < triangle.y1; ++y) {
    for (int x = triangle.x0; x < triangle.x1; ++x) {
      if (triangle.covers(x, y)) f(x, y, triangle.nearness_at(x, y));
    }
  }
}

}  // namespace vislab
