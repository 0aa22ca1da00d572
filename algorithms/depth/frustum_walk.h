// Emits what of a structure is in the view, without asking what hides what: for methods that alone
// stand for culling, while occlusion culling does not pay.
//
// Guarantee: conservative: leaves out only what a plane of the frustum has surely outside.
// Cost: O(nodes that the frustum's surface cuts + spans).
// Sources: Clark 1976; Assarsson and Moeller 2000.
#pragma once

#include <algorithm>
#include <vector>

#include "common/culler/candidates.h"
#include "common/geometry/frustum.h"
#include "common/spatial/spatial_structure.h"

namespace vislab::depth_culling {

class FrustumWalk {
 public:
  void build(std::size_t object_count) {
    kept_.reserve(object_count);
    stack_.reserve(256);
  }

  /// The structure holds exactly the objects that are shown, each once. Spans hold until the next
  /// call, and until the structure changes.
  void emit(const SpatialStructure& structure, const Frame& frame, DrawSink& out) {
    frustum_ = frustum_of(frame.camera);
    kept_.clear();
    stack_.clear();
    const std::uint32_t all = (1U << static_cast<unsigned>(frustum_.plane_count)) - 1;
    for (const ObjectId object : structure.unplaced()) kept_.push_back(object);
    const std::span<const SpatialNode> nodes = structure.nodes();
    stack_.push_back({SpatialStructure::root, all});
    while (!stack_.empty()) {
      auto [index, planes] = stack_.back();
      stack_.pop_back();
      const SpatialNode& node = nodes[index];
      if (node.box.empty() || outside(node.box, planes)) continue;
      const std::span<const ObjectId> below = structure.objects_below(index);
      if (planes == 0 && !below.empty()) {
        if (below.size() >= long_run) {
          out.objects(below);
        } else {
          kept_.insert(kept_.end(), below.begin(), below.end());
        }
        continue;
      }
      for (const ObjectId object : structure.objects_at(index)) {
        std::uint32_t of_object = planes;
        if (!outside(frame.objects.bounds[object], of_object)) kept_.push_back(object);
      }
      for (std::uint32_t i = 0; i < node.child_count; ++i) {
        stack_.push_back({node.first_child + i, planes});
      }
    }
    out.objects(kept_);
  }

  std::size_t bytes() const {
    return kept_.capacity() * sizeof(ObjectId) + stack_.capacity() * sizeof(Item);
  }

 private:
  struct Item {
    SpatialStructure::NodeIndex node;
    std::uint32_t planes;  // bits: those that the parent is not surely inside of
  };
  /// Shorter runs are copied: an emission costs more than that.
  static constexpr std::size_t long_run = 64;

  /// Takes planes that the box is surely inside of out of `planes`.
  bool outside(const Aabb& box, std::uint32_t& planes) const {
    for (std::size_t i = 0; i < static_cast<std::size_t>(frustum_.plane_count); ++i) {
      const std::uint32_t bit = 1U << i;
      if ((planes & bit) == 0) continue;
      if (surely_outside(frustum_.planes[i], box)) return true;
      if (surely_inside(frustum_.planes[i], box)) planes &= ~bit;
    }
    return false;
  }

  Frustum frustum_;
  std::vector<Item> stack_;
  std::vector<ObjectId> kept_;
};

}  // namespace vislab::depth_culling
