#include "common/raster/box_samples.h"

#include <algorithm>
#include <array>
#include <bit>

#include "common/raster/covered_area.h"
#include "common/raster/tile_coverage.h"

namespace vislab {
namespace {

/// Counter-clockwise seen from outside. Corner i takes the greater x if bit 0 is set, y for bit 1,
/// z for bit 2.
constexpr std::array<std::array<std::size_t, 4>, 6> faces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

/// Pixels [x0, x1) x [y0, y1) of a tile: bit 8 y + x.
std::uint64_t rectangle_mask(int x0, int y0, int x1, int y1) {
  const auto row = (0xFFU >> static_cast<unsigned>(tile_size - (x1 - x0))) << x0;
  std::uint64_t mask = 0;
  for (int y = y0; y < y1; ++y) mask |= std::uint64_t{row} << static_cast<unsigned>(tile_size * y);
  return mask;
}

/// One face against the buffer.
class FaceCount {
 public:
  FaceCount(const TileStore& tiles, const SetupTriangle& face) : tiles_(tiles), face_(face) {
    for (std::size_t e = 0; e < SetupTriangle::edge_count; ++e) {
      const WindowEdge& edge = face.edges[e];
      steps_.a[e] = edge.a;
      steps_.b[e] = edge.b;
      least_[e] = last * (std::min<std::int64_t>(edge.a, 0) + std::min<std::int64_t>(edge.b, 0));
      greatest_[e] = last * (std::max<std::int64_t>(edge.a, 0) + std::max<std::int64_t>(edge.b, 0));
    }
    steps_.x = face.step_x;
    steps_.y = face.step_y;
  }

  std::uint64_t passed() const {
    std::uint64_t count = 0;
    for (int y = face_.y0 / tile_size; y * tile_size < face_.y1; ++y) {
      for (int x = face_.x0 / tile_size; x * tile_size < face_.x1; ++x) {
        count += static_cast<std::uint64_t>(std::popcount(passed_in(x, y)));
      }
    }
    return count;
  }

 private:
  static constexpr int last = tile_size - 1;

  std::uint64_t passed_in(int tile_x, int tile_y) const {
    const std::size_t tile = tiles_.index(tile_x, tile_y);
    const int left = tile_x * tile_size;
    const int below = tile_y * tile_size;
    // Rounding is monotone, so these are the very bits at the tile's corners.
    const float here = face_.nearness_of_tile(left, below);
    const float far_x = face_.step_x > 0.0F ? 0.0F : last, near_x = last - far_x;
    const float far_y = face_.step_y > 0.0F ? 0.0F : last, near_y = last - far_y;
    const float nearest = here + (face_.step_x * near_x + face_.step_y * near_y);
    if (nearest < tiles_.farthest()[tile]) return 0;
    const std::uint64_t covered = covered_in(left, below, here);
    const float farthest = here + (face_.step_x * far_x + face_.step_y * far_y);
    if (covered == 0 || farthest >= tiles_.nearest()[tile]) return covered;
    return covered & not_farther(tile, here);
  }

  std::uint64_t covered_in(int left, int below, float here) const {
    const std::uint64_t inside =
        rectangle_mask(std::max(face_.x0 - left, 0), std::max(face_.y0 - below, 0),
                       std::min(face_.x1 - left, tile_size), std::min(face_.y1 - below, tile_size));
    PartialTile part;
    bool whole = true;
    for (std::size_t e = 0; e < SetupTriangle::edge_count; ++e) {
      const std::int64_t at = face_.edges[e].at(left, below);
      if (at + greatest_[e] < 0) return 0;
      whole = whole && at + least_[e] >= 0;
      constexpr auto limit = static_cast<std::int64_t>(PartialTile::greatest_edge);
      part.edge[e] = static_cast<std::int32_t>(std::clamp(at, -limit, limit));
    }
    if (whole) return inside;
    part.nearness = here;
    TileCoverage coverage;
    cover_tiles(steps_, {&part, 1}, {&coverage, 1});
    return inside & coverage.mask;
  }

  /// The pixels of a tile at which the face is as near as the buffer or nearer.
  std::uint64_t not_farther(std::size_t tile, float here) const {
    std::uint64_t mask = 0;
    const bool stored = tiles_.stored()[tile] != 0;
    const float* const pixels = stored ? tiles_.pixels(tile) : nullptr;
    for (int y = 0; y < tile_size; ++y) {
      std::uint64_t row = 0;
      for (int x = 0; x < tile_size; ++x) {
        const float nearness =
            here + (face_.step_x * static_cast<float>(x) + face_.step_y * static_cast<float>(y));
        const float drawn = stored ? pixels[tile_size * y + x] : tiles_.nearness(tile, x, y);
        row |= std::uint64_t{nearness >= drawn ? 1U : 0U} << static_cast<unsigned>(x);
      }
      mask |= row << static_cast<unsigned>(tile_size * y);
    }
    return mask;
  }

  const TileStore& tiles_;
  const SetupTriangle& face_;
  TileSteps steps_;
  // What an edge function adds within a tile, from its lower left pixel.
  std::array<std::int64_t, SetupTriangle::edge_count> least_{}, greatest_{};
};

}  // namespace

BoxSamples count_box_samples(const WindowTransform& window, const TileStore& tiles,
                             const Aabb& box) {
  BoxSamples samples;
  if (!box.valid()) return samples;
  std::array<WindowPoint, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] =
        window.world()({(i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                        (i & 4) != 0 ? box.max.z : box.min.z});
  }
  std::int64_t area = 0;
  std::int64_t outlines = 0;
  const auto count = [&](const SetupTriangle& face) {
    area += covered_area(face, window.viewport());
    outlines += outline(face, window.viewport());
    samples.passed += FaceCount(tiles, face).passed();
  };
  for (const std::array<std::size_t, 4>& face : faces) {
    const std::array<WindowPoint, 4> points{corners[face[0]], corners[face[1]], corners[face[2]],
                                            corners[face[3]]};
    SetupResult result;
    std::array<SetupTriangle, 2> halves;
    if (set_up_pair(window, points, 0, {}, result, halves)) {
      if (result.facing != Facing::front || result.count == 0) continue;
      // The two share all but the diagonal.
      SetupTriangle whole = halves[0];
      whole.edges[2] = halves[1].edges[1];
      whole.edges[3] = halves[1].edges[2];
      count(whole);
      continue;
    }
    for (const std::size_t second : {std::size_t{1}, std::size_t{2}}) {
      std::array<SetupTriangle, max_setup_pieces> pieces;
      result =
          set_up_triangle(window, {points[0], points[second], points[second + 1]}, 0, {}, pieces);
      if (result.facing != Facing::front) continue;
      for (int i = 0; i < result.count; ++i) count(pieces[static_cast<std::size_t>(i)]);
    }
  }
  samples.covered = samples_of_area(area);
  samples.outline_px = static_cast<std::uint64_t>(outlines / outline_units);
  return samples;
}

}  // namespace vislab
