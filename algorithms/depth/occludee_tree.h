// A hierarchy over the objects that are shown, as occlusion culling walks it: tight boxes, and how
// many objects a hidden node saves.
#pragma once

#include <algorithm>
#include <optional>
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

  explicit OccludeeTree(const typename Structure::Limits& limits) : limits_(limits) {}

  /// Only after build().
  const Structure& structure() const { return followed_->structure(); }
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
    if constexpr (!has_tight_boxes) limits_.overlap_m = overlap(scene);
    followed_.emplace(limits_).build(scene);
    stale_ = true;
  }
  void reset() {
    if (followed_->reset()) stale_ = true;
  }
  void update(const Frame& frame, const Changes& changes) {
    if (followed_->update(frame, changes)) stale_ = true;
  }
  /// To be called before a walk.
  void start(const Frame& frame) {
    if constexpr (!has_tight_boxes) {
      if (stale_) tighten(frame);
    }
    stale_ = false;
  }

  std::size_t bytes() const {
    return (followed_ ? followed_->bytes() : 0) + tight_.capacity() * sizeof(Aabb) +
           order_.capacity() * sizeof(NodeIndex);
  }

 private:
  static constexpr bool has_tight_boxes = std::is_same_v<Structure, Bvh>;

  /// So much that nine in ten objects stay below planes that they straddle. Cells may be as loose:
  /// what counts are the tight boxes.
  static double overlap(const Scene& scene) {
    std::vector<double> radii;
    radii.reserve(scene.object_count());
    for (ObjectId object = 0; object < scene.object_count(); ++object) {
      const Aabb box = transformed(scene.mesh_of(object).bounds, scene.objects[object].transform);
      radii.push_back(box.valid() ? glm::length(box.half_size()) : 0.0);
    }
    const auto at = static_cast<std::ptrdiff_t>(radii.size() * 9 / 10);
    std::nth_element(radii.begin(), radii.begin() + at, radii.end());
    return radii[static_cast<std::size_t>(at)];
  }

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

  typename Structure::Limits limits_;
  std::optional<FollowedStructure<Structure>> followed_;
  bool stale_ = true;             // the structure has changed since the boxes were made
  std::vector<Aabb> tight_;       // by node
  std::vector<NodeIndex> order_;  // memory of tighten()
};

}  // namespace vislab::depth_culling
