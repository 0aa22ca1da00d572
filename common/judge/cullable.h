// What perfect methods of each kind would leave out of a frame: the denominators of recall.
#pragma once

#include <cstdint>
#include <vector>

#include "common/culler/visible_set.h"
#include "common/scene/frame.h"

namespace vislab {

/// Triangles of one kind: how many there are, and how many of them a set leaves out.
struct CulledOf {
  std::uint64_t cullable = 0;
  std::uint64_t culled = 0;

  friend bool operator==(const CulledOf&, const CulledOf&) = default;
};

/// Which triangles of a frame face away from the eye, and which lie wholly outside the frustum.
class CullableTriangles {
 public:
  /// Shown objects only. O(triangles). Frame and scene are not kept.
  CullableTriangles(const Frame& frame, const Scene& scene);

  /// Triangles seen from behind, by their winding; edge-on ones are not among them. O(runs).
  CulledOf back_facing(const VisibleSet& kept) const { return count(back_facing_before_, kept); }
  /// Triangles of which no point is inside all planes of the frustum. O(runs).
  CulledOf outside(const VisibleSet& kept) const { return count(outside_before_, kept); }

 private:
  static CulledOf count(const std::vector<std::uint32_t>& before, const VisibleSet& kept);

  // By triangle: how many of the triangles before it are of the kind.
  std::vector<std::uint32_t> back_facing_before_, outside_before_;
};

}  // namespace vislab
