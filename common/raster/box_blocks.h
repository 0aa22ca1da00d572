// Boxes in blocks of sixteen, for kernels that place a whole block in a window at once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/raster/box_silhouette.h"

namespace vislab {

/// Bounds by row, box by column. Columns that are not `present` hold anything finite.
struct alignas(64) BoxColumns {
  static constexpr std::size_t width = 16;
  enum Row : std::size_t { min_x, min_y, min_z, max_x, max_y, max_z };

  std::array<std::array<float, width>, 6> rows{};
  std::uint32_t present = 0;  // bit by column
  std::uint32_t always = 0;   // those of them that are never culled: their bounds say nothing

  /// False for boxes that are not valid or reach beyond 10^12 m: they are `always`.
  static bool says_something(const Aabb& box);
  /// Puts a box into a column; it is then present.
  void put(std::size_t column, const Aabb& box);

  Aabb box(std::size_t column) const {
    return {{rows[min_x][column], rows[min_y][column], rows[min_z][column]},
            {rows[max_x][column], rows[max_y][column], rows[max_z][column]}};
  }
};

/// What placing a block needs to know of a view, in float, relative to the eye.
///
/// The eye is subtracted from bounds as the sum of two floats, so that what is near it stays exact.
/// Every sum carries a bound of its rounding: 2^-20 of its terms, which are less than a dozen
/// operations old.
struct ColumnView {
  /// Of one linear function of a point relative to the eye: (x px + y py) + z pz + constant, and
  /// what bounds its error: reach_error (|px| + |py| + |pz|) + constant_error.
  struct Row {
    float x = 0.0F, y = 0.0F, z = 0.0F, constant = 0.0F;
    float reach_error = 0.0F, constant_error = 0.0F;
  };

  ColumnView(const WindowTransform& window, Coverage coverage);

  bool perspective = true;
  std::array<float, 3> eye_high{}, eye_low{};
  Row window_x, window_y, depth;
  std::array<Row, 4> sides;  // greater or equal 0 inside of the image's sides
  float near_m = 0.0F, far_m = 0.0F;
  float width = 0.0F, height = 0.0F;
  float reach = 0.0F;        // from a window position to the last pixel that counts, with a margin
  float depth_to_px = 0.0F;  // the error of a position for an error of 1 m in a depth of 1 m
  float device_margin = 0.0F;
};

/// Where the boxes of a block lie. Bits by column, of those present and not `always` only; a box
/// with neither bit is outside: nothing of it can be seen.
struct ColumnPlaces {
  std::uint32_t undecided = 0;  // crosses the near plane, or is too near to tell
  std::uint32_t inside = 0;     // the arrays say where
  alignas(64) std::array<std::int32_t, BoxColumns::width> x0, y0, x1, y1;
  alignas(64) std::array<float, BoxColumns::width> nearness;

  BoxWindow window(std::size_t column) const {
    return {x0[column], y0[column], x1[column], y1[column], nearness[column]};
  }
};

/// As project_box, with float's margins.
void place_columns(const ColumnView& view, const BoxColumns& boxes, ColumnPlaces& out);
/// The same bits without SIMD.
void place_columns_scalar(const ColumnView& view, const BoxColumns& boxes, ColumnPlaces& out);

/// A hierarchy of blocks: column c of block b of level n + 1 is the box around block 16 b + c of
/// level n. The last level has one block.
using BoxLevels = std::vector<std::vector<BoxColumns>>;

struct BoxWalk {
  std::vector<std::uint32_t> now, next;  // blocks of a level
  std::uint64_t blocks = 0;              // placed
  std::uint64_t silhouettes = 0;         // boxes that their rectangle did not decide
};

/// Sets the bits of the boxes of level 0 that may be seen: bit ids[16 b + c] of `visible` for
/// column c of block b. Tests whole blocks by their rectangle first.
void find_visible(const ColumnView& view, const PixelRays& rays, const TileStore& tiles,
                  const BoxLevels& levels, const std::uint32_t* ids, BoxWalk& walk,
                  std::uint64_t* visible);
/// Of one block without a hierarchy: bits by column.
std::uint32_t visible_columns(const ColumnView& view, const PixelRays& rays, const TileStore& tiles,
                              const BoxColumns& boxes);

}  // namespace vislab
