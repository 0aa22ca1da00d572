// AxisBsp: a binary space partition by axis-aligned planes.
//
// Idea: each inner node has a plane across one axis. Objects on one side of it go into that child.
//   What straddles it stays at the node, goes into both children, or goes where its centre is. The
//   plane halves the node's box, halves its objects, or is the cheapest of a set of candidates by
//   the surface-area heuristic.
// Guarantee: an object's box lies in the boxes of its nodes (of all of them together if it is in
//   both children) and of all nodes above. Node boxes are tight: around the objects in them, or the
//   parts of these within the node's region.
// Cost: build O(objects × depth), insert, remove and move O(depth) and, with both children, one
//   entry a touched leaf; finish_changes() O(nodes that changed, with what is at them).
// Limits: planes stay as they were chosen; leaves that become too full are split, siblings that
//   become empty are merged, but nothing is balanced anew. A straddler that stays at a node near
//   the root is met by almost all queries. With both children, a leaf is not split if that would
//   let the entries of all leaves grow beyond 64 an object (or 2^18, if that is more).
// Sources: Kowalka 2016 (thesis, HAW Hamburg), 2.5.3; Fuchs, Kedem and Naylor 1980; MacDonald and
//   Booth 1990 (surface-area heuristic).
#pragma once

#include "common/spatial/node_blocks.h"
#include "common/spatial/object_runs.h"
#include "common/spatial/spatial_structure.h"

namespace vislab {

class AxisBsp final : public SpatialStructure {
 public:
  enum class Straddlers { node, both, centre };
  enum class Split { midpoint, median, cost };
  struct Limits {
    Straddlers straddlers = Straddlers::centre;
    Split split = Split::cost;
    int depth = 24;  // the root is at 0
    std::uint32_t leaf_objects = 32;
  };

  explicit AxisBsp(const Limits& limits) : limits_(limits) {}

  void build(std::span<const Aabb> boxes) override;
  void insert(ObjectId object, const Aabb& box) override;
  void remove(ObjectId object) override;
  void move(ObjectId object, const Aabb& box) override;
  void finish_changes() override;

  std::span<const SpatialNode> nodes() const override { return nodes_; }
  std::span<const ObjectId> objects_at(NodeIndex node) const override {
    return runs_.of(details_[node].objects);
  }
  /// Only objects whose box is not valid: the root's region is all of space.
  std::span<const ObjectId> unplaced() const override { return unplaced_; }
  bool repeats_objects() const override { return limits_.straddlers == Straddlers::both; }
  std::size_t bytes() const override;

  /// Nodes in use, empty ones among them.
  std::size_t node_count() const { return blocks_.used(); }

 private:
  enum class State : std::uint8_t { absent, unplaced, placed };
  struct Entry {
    Aabb box;
    std::uint32_t position = 0;  // in unplaced_, or in the run of its node (unless repeated)
    State state = State::absent;
  };
  struct Cut {
    int axis = -1;  // none
    float position = 0.0F;

    bool exists() const { return axis >= 0; }
  };
  struct Detail {
    Cut cut;  // of an inner node
    ObjectRuns::Run objects;
    int depth = 0;
    std::uint32_t split_at = 0;  // objects at which splitting is tried (again)
    bool stale = false;          // its box has to be made anew, and so have those of all above
    Aabb region = everywhere();
  };
  /// Where an object of an inner node goes.
  struct Sides {
    bool lower, upper;  // neither: it stays
  };

  Sides sides_of(const Cut& cut, const Aabb& box) const;
  void enter(ObjectId object, const Aabb& box);
  void leave(ObjectId object);
  void add(NodeIndex node, ObjectId object);
  void take(NodeIndex node, ObjectId object);
  void push(NodeIndex node, ObjectId object);
  void split_pending();
  void split_if_due(NodeIndex node);
  void merge_if_due(NodeIndex node);
  Cut choose_cut(NodeIndex leaf);
  Cut halving_cut(NodeIndex leaf);
  Cut cheapest_cut(NodeIndex leaf) const;
  /// Does the cut make both children smaller than the leaf? `added`: entries there would be more.
  bool separates(const Cut& cut, NodeIndex leaf, std::uint64_t& added) const;
  Aabb part_in(NodeIndex node, ObjectId object) const;
  void refit(NodeIndex node);
  static Aabb everywhere();
  Entry& entry_of(ObjectId object, const char* what);

  Limits limits_;
  NodeBlocks blocks_{2};
  std::vector<SpatialNode> nodes_{1};
  std::vector<Detail> details_{1};
  ObjectRuns runs_;
  std::vector<Entry> entries_of_objects_;  // by object
  std::vector<ObjectId> unplaced_;
  std::size_t placed_ = 0;
  std::uint64_t entries_ = 0;  // placed objects, counted once for each node they are at
  std::vector<NodeIndex> pending_;
  std::vector<ObjectId> gathered_;
  std::vector<float> centres_;
};

}  // namespace vislab
