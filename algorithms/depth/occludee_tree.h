// A hierarchy over the objects that are shown, as occlusion culling walks it: tight boxes, and how
// many objects a hidden node saves.
#pragma once

#include <type_traits>
#include <vector>

#include "common/spatial/bvh.h"
#include "common/spatial/followed_structure.h"
#include "common/spatial/loose_octree.h"

namespace vislab::depth_culling {

/// Structure: Bvh, or LooseOctree. The octree's cells are much larger than what is in them (a
/// street with small things between high buildings), so for it the boxes of what is really there
/// are kept beside: O(nodes + objects) whenever anything has changed. A Bvh's boxes are tight, and
/// are kept so by itself, O(movers and their ancestors).
template <typename Structure>
class OccludeeTree {
 public:
  using NodeIndex = SpatialStructure::NodeIndex;

  explicit OccludeeTree(const typename Structure::Limits& limits) : followed_(limits) {}

  const Structure& structure() const { return followed_.structure(); }
  std::uint32_t count_below(NodeIndex node) const { return structure().count_below(node); }

  /// Empty if there is nothing at or below the node. Of all objects' boxes, but for those that are
  /// unplaced.
  const Aabb& box(NodeIndex node) const {
    if constexpr (has_tight_boxes) {
      return structure().nodes()[node].box;
    } else {
      return tight_[node];
    }
  }

  /// The scene outlives this.
  void build(const Scene& scene) {
    followed_.build(scene);
    stale_ = true;
  }
  void reset() {
    if (followed_.reset()) stale_ = true;
  }
  void update(const Frame& frame, const Changes& changes) {
    if (followed_.update(frame, changes)) stale_ = true;
  }
  /// To be called before a walk.
  void start(const Frame& frame) {
    if constexpr (!has_tight_boxes) {
      if (stale_) tighten(frame);
    }
    stale_ = false;
  }

  std::size_t bytes() const {
    return followed_.bytes() + tight_.capacity() * sizeof(Aabb) +
           order_.capacity() * sizeof(NodeIndex);
  }

 private:
  static constexpr bool has_tight_boxes = std::is_same_v<Structure, Bvh>;

  void tighten(const Frame& frame) {
    const std::span<const SpatialNode> nodes = structure().nodes();
    tight_.assign(nodes.size(), {});
    order_.assign(1, Structure::root);
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const SpatialNode& node = nodes[order_[i]];
      for (std::uint32_t child = 0; child < node.child_count; ++child) {
        order_.push_back(node.first_child + child);
      }
    }
    // Children stand after their parents.
    for (std::size_t i = order_.size(); i-- > 0;) {
      Aabb& box = tight_[order_[i]];
      for (const ObjectId object : structure().objects_at(order_[i])) {
        box.extend(frame.objects.bounds[object]);
      }
      const SpatialNode& node = nodes[order_[i]];
      for (std::uint32_t child = 0; child < node.child_count; ++child) {
        box.extend(tight_[node.first_child + child]);
      }
    }
  }

  FollowedStructure<Structure> followed_;
  bool stale_ = true;             // the structure has changed since the boxes were made
  std::vector<Aabb> tight_;       // by node
  std::vector<NodeIndex> order_;  // memory of tighten()
};

}  // namespace vislab::depth_culling
