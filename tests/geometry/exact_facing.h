// Says in exact arithmetic which triangles face the eye, and what a culler of back faces did wrong.
// For property tests.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/culler/candidates.h"

namespace vislab::test {

/// How a triangle is seen. One without area is edge-on from everywhere.
enum class Facing : std::uint8_t { back, edge_on, front };

/// For every triangle of the scene, by TriangleId: on which side of its plane the eye is
/// (orthographic: whether it is turned to the direction to the viewer, pose.back). Vertices,
/// transforms and the eye are taken as the floats and doubles that they are, and everything is
/// exact: transforms may turn, shear, scale and mirror. Hidden objects are judged too.
///
/// Intervals decide first, rational numbers what they leave open. About 0.2 us a triangle, and 20
/// where the eye is next to its plane. Not for several threads at once.
std::vector<Facing> exact_facings(const Scene& scene, const Frame& frame);

/// What was left out of the shown objects' triangles.
struct FacingCounts {
  std::uint64_t front_left_out = 0;    // wrong
  std::uint64_t edge_on_left_out = 0;  // wrong too: edge-on is neither front nor back
  std::uint64_t back = 0;              // what a perfect method would leave out
  std::uint64_t back_left_out = 0;
  std::uint64_t twice = 0;  // kept more than once: wrong

  bool all_right() const { return front_left_out == 0 && edge_on_left_out == 0 && twice == 0; }
  double recall() const;  // 1 if there is nothing to find
  FacingCounts& operator+=(const FacingCounts& other);
};

/// Counts for a culler that was offered everything and kept `kept`. O(triangles).
FacingCounts count_facings(const Scene& scene, const Frame& frame, std::span<const Facing> facings,
                           std::span<const TriangleRange> kept);

}  // namespace vislab::test
