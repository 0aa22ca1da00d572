// Boxes of a hierarchy's nodes that are safe to ask a device about.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "algorithms/occlusion/tight_bounds.h"
#include "common/spatial/query_hierarchy.h"

namespace vislab::occlusion_culling {

class NodeBoxes {
 public:
  /// Without limits a node has one box. The scene outlives this.
  void build(const Scene& scene, const std::optional<TightBounds::Limits>& limits);

  /// Appends the boxes to ask about for a node, enlarged as devices need it: one for an inner node,
  /// several for a unit, as long as they cost much less than to draw it. Returns how many. None
  /// if nothing may be concluded from an answer, because the node comes too near to the eye.
  std::uint32_t append(const Frame& frame, const QueryHierarchy& hierarchy,
                       QueryHierarchy::NodeIndex node, std::vector<Aabb>& out) const;

  std::size_t bytes() const { return tight_ ? bounds_.bytes() : 0; }

 private:
  bool tight_ = false;
  TightBounds bounds_;
};

}  // namespace vislab::occlusion_culling
