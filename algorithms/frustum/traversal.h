// Walks a spatial structure with a frustum: the part that all tree cullers share.
#pragma once

#include <vector>

#include "algorithms/frustum/object_tester.h"
#include "common/culler/stamps.h"
#include "common/spatial/spatial_structure.h"

namespace vislab::frustum_culling {

/// What becomes of the objects at nodes that the frustum's planes cut.
enum class NodePolicy {
  refine,  // they are tested one by one
  keep     // they are kept untested
};

inline ParameterSpec node_policy_parameter() {
  return ParameterSpec::choice("intersecting", "refine", {"refine", "keep"},
                               ParameterSpec::Stage::query,
                               "objects at nodes that the frustum cuts are tested one by one, or "
                               "kept untested, which keeps more");
}

inline NodePolicy read_node_policy(const ParameterValues& values) {
  return values.choice("intersecting") == "keep" ? NodePolicy::keep : NodePolicy::refine;
}

/// Idea: a node outside of the frustum is skipped with everything below it; one inside is emitted
///   with everything below it, untested; one that is cut is looked into. Objects that no node holds
///   are tested one by one.
/// Guarantee: with NodePolicy::refine, test=vertex and the switches at their defaults, the objects
///   that are kept are exactly those that frustum_tester.h's definition keeps.
/// Cost: O(nodes that the frustum's planes cut + what is emitted). Nothing is allocated after the
///   first pass over a path.
/// Contract: the structure holds exactly the objects that are shown. Slots of the FrustumTester:
///   objects have their ids, node n has object_count + n. Who changes the structure calls
///   FrustumTester::forget(object) for each object that moved and forget_motion() for the nodes.
class Traversal {
 public:
  explicit Traversal(NodePolicy policy) : policy_(policy) {}

  void build(std::size_t object_count, bool repeats_objects) {
    object_count_ = object_count;
    kept_.reserve(object_count);
    stack_.reserve(256);
    if (repeats_objects) stamps_.resize(object_count);
  }

  /// Candidates are everything: walks the structure and emits what is kept.
  template <typename Structure>
  void cull(const Structure& structure, FrustumTester& tester, ObjectTester& objects,
            const Frame& frame, DrawSink& out) {
    start(tester, objects, frame, object_count_ + structure.nodes().size());
    const bool repeats = structure.repeats_objects();
    if (repeats) stamps_.clear();
    for (const ObjectId object : structure.unplaced()) {
      test(object, tester, objects, frame, tester.all_planes());
    }
    const std::span<const SpatialNode> nodes = structure.nodes();
    stack_.push_back({Structure::root, tester.all_planes()});
    while (!stack_.empty()) {
      auto [index, mask] = stack_.back();
      stack_.pop_back();
      const SpatialNode& node = nodes[index];
      if (node.box == Aabb{}) continue;  // nothing at or below it
      ++nodes_visited_;
      const auto slot = static_cast<std::uint32_t>(object_count_ + index);
      const Side side = tester.side(node.box, slot, mask);
      if (side == Side::outside) continue;
      if (side == Side::inside) {
        emit_below(structure, nodes, index, repeats, out);
        continue;
      }
      const std::span<const ObjectId> here = structure.objects_at(index);
      if (policy_ == NodePolicy::keep) {
        keep(here, repeats);
      } else {
        for (const ObjectId object : here) {
          // What was kept or tested at another node is not asked again.
          if (repeats && !stamps_.insert(object)) continue;
          // Only the part of an object that is repeated is in the node: all planes count for it.
          test(object, tester, objects, frame, repeats ? tester.all_planes() : mask);
        }
      }
      for (std::uint32_t child = node.child_count; child-- > 0;) {
        stack_.push_back({node.first_child + child, mask});
      }
    }
    out.objects(kept_);
  }

  /// Candidates are a list, or there is no structure: tests each. O(candidates).
  void cull_each(const Candidates& candidates, FrustumTester& tester, ObjectTester& objects,
                 const Frame& frame, DrawSink& out) {
    start(tester, objects, frame, object_count_);
    for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
      for (const ObjectId object : run) {
        test(object, tester, objects, frame, tester.all_planes());
      }
    });
    out.objects(kept_);
  }

  std::uint64_t nodes_visited() const { return nodes_visited_; }
  std::uint64_t objects_tested() const { return objects_tested_; }
  std::size_t bytes() const {
    return kept_.capacity() * sizeof(ObjectId) + stack_.capacity() * sizeof(Item) + stamps_.bytes();
  }

 private:
  struct Item {
    SpatialStructure::NodeIndex node;
    PlaneMask mask;  // planes that the parent is not inside of
  };
  /// Runs shorter than this are copied: an emission costs more than that.
  static constexpr std::size_t long_run = 64;

  void start(FrustumTester& tester, ObjectTester& objects, const Frame& frame, std::size_t slots) {
    tester.resize(slots);
    tester.start(frame);
    objects.start(frame);
    kept_.clear();
  }

  void test(ObjectId object, FrustumTester& tester, ObjectTester& objects, const Frame& frame,
            PlaneMask mask) {
    ++objects_tested_;
    if (objects.keeps(object, frame, tester, object, mask)) kept_.push_back(object);
  }

  void keep(std::span<const ObjectId> objects, bool repeats) {
    if (!repeats) {
      kept_.insert(kept_.end(), objects.begin(), objects.end());
      return;
    }
    for (const ObjectId object : objects) {
      if (stamps_.insert(object)) kept_.push_back(object);
    }
  }

  void emit(std::span<const ObjectId> objects, bool repeats, DrawSink& out) {
    if (!repeats && objects.size() >= long_run) {
      out.objects(objects);
    } else {
      keep(objects, repeats);
    }
  }

  template <typename Structure>
  void emit_below(const Structure& structure, std::span<const SpatialNode> nodes,
                  SpatialStructure::NodeIndex index, bool repeats, DrawSink& out) {
    const std::span<const ObjectId> run = structure.objects_below(index);
    if (!run.empty()) {
      emit(run, repeats, out);
      return;
    }
    // The stack is shared: what lies above this mark is the subtree's.
    const std::size_t mark = stack_.size();
    stack_.push_back({index, 0});
    while (stack_.size() > mark) {
      const SpatialNode& node = nodes[stack_.back().node];
      const std::span<const ObjectId> here = structure.objects_at(stack_.back().node);
      stack_.pop_back();
      if (node.box == Aabb{}) continue;
      emit(here, repeats, out);
      for (std::uint32_t child = node.child_count; child-- > 0;) {
        stack_.push_back({node.first_child + child, 0});
      }
    }
  }

  NodePolicy policy_;
  std::size_t object_count_ = 0;
  std::vector<Item> stack_;
  std::vector<ObjectId> kept_;
  ObjectStamps stamps_;
  std::uint64_t nodes_visited_ = 0;
  std::uint64_t objects_tested_ = 0;
};

}  // namespace vislab::frustum_culling
