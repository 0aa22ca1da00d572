// Cutting convex polygons of limited numbers of corners, in an image or in space.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vislab::portal_culling {

enum class Cut {
  all_outside,
  all_inside,
  in_two,
  undecided,  // not cut: lies along the boundary, on sides that rounding decides; or no room in
              // kept
};

/// Cuts by the corners' signed distances, >= 0 inside. The part inside is written to `kept` if it
/// is cut in two.
template <typename Point>
Cut cut_convex(std::span<const Point> corners, std::span<const double> distance,
               std::span<Point> kept, std::uint32_t& kept_count) {
  const std::size_t count = corners.size();
  std::size_t inside = 0;
  std::size_t crossings = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_in = distance[i] >= 0.0;
    inside += is_in ? 1 : 0;
    crossings += is_in != (distance[i + 1 == count ? 0 : i + 1] >= 0.0) ? 1 : 0;
  }
  if (inside == 0) return Cut::all_outside;
  if (inside == count) return Cut::all_inside;
  if (crossings > 2 || inside + crossings > kept.size()) return Cut::undecided;
  kept_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = i + 1 == count ? 0 : i + 1;
    const bool is_in = distance[i] >= 0.0;
    if (is_in) kept[kept_count++] = corners[i];
    if (is_in == (distance[next] >= 0.0)) continue;
    kept[kept_count++] =
        corners[i] + (corners[next] - corners[i]) * (distance[i] / (distance[i] - distance[next]));
  }
  return Cut::in_two;
}

}  // namespace vislab::portal_culling
