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
  /// Without limits a node has one box; so do units so light that many boxes cost about as much as
  /// they do. The scene outlives this.
  void build(const Scene& scene, const std::optional<TightBounds::Limits>& limits);

  /// Appends the boxes to ask about for a node, enlarged as devices need it. Returns how many. None
  /// if nothing may be concluded from an answer, because the node comes too near to the eye.
  std::uint32_t append(const Frame& frame, const QueryHierarchy& hierarchy,
                       QueryHierarchy::NodeIndex node, std::vector<Aabb>& out) const;

  std::size_t bytes() const { return tight_ ? bounds_.bytes() : 0; }

 private:
  bool tight_ = false;
  std::uint64_t least_work_ = 0;  // of units with several boxes
  TightBounds bounds_;
};

}  // namespace vislab::occlusion_culling
