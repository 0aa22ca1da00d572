// LeafOctree: an octree over the scene with every object in all the leaves that it touches.
//
// Idea: a cube around the scene is halved on all three axes until a leaf has few objects or the
//   depth is reached. An object stands in each leaf whose cube its box touches, so that a query may
//   look at leaves only and meets every object that reaches into them.
// Guarantee: the leaves of an object together hold its box; neighbours share their planes to the
//   last bit, so that nothing slips between them.
// Cost: build O(objects × depth) and one entry a touched leaf; insert, remove and move O(touched
//   leaves × depth). Node boxes are whole cells, looser than the objects in them.
// Limits: a query meets an object several times. Objects that are large beside the leaves stand in
//   very many of them; a leaf is therefore not halved if that would let the entries of all leaves
//   grow beyond 64 an object (or 2^18, if that is more), or if all eight octants would hold all its
//   objects. Made for scenes that stand still mostly.
// Source: Kowalka 2016 (thesis, HAW Hamburg), 2.5.4, 4.1; his values for depth and count are not
//   given.
#pragma once

#include "common/spatial/node_blocks.h"
#include "common/spatial/object_runs.h"
#include "common/spatial/spatial_structure.h"

namespace vislab {

class LeafOctree final : public SpatialStructure {
 public:
  /// A leaf is not halved at `depth` (the root is at 0) or with up to `leaf_objects` objects.
  struct Limits {
    int depth = 6;
    std::uint32_t leaf_objects = 64;
  };

  explicit LeafOctree(const Limits& limits) : limits_(limits) {}

  /// The root is the cube around all valid boxes.
  void build(std::span<const Aabb> boxes) override;
  void insert(ObjectId object, const Aabb& box) override;
  void remove(ObjectId object) override;
  void move(ObjectId object, const Aabb& box) override;
  /// If more objects lie outside of the root than are placed, the root is laid around all of them
  /// and everything is built anew. Until then they are unplaced: a root that grew with each stray
  /// would take from the others the depth they need.
  void finish_changes() override;

  std::span<const SpatialNode> nodes() const override { return nodes_; }
  std::span<const ObjectId> objects_at(NodeIndex node) const override {
    return runs_.of(details_[node].objects);
  }
  std::span<const ObjectId> unplaced() const override { return unplaced_; }
  bool repeats_objects() const override { return true; }
  std::size_t bytes() const override;

  /// Objects in leaves, counted once for each leaf.
  std::uint64_t entry_count() const { return entries_; }

 private:
  enum class State : std::uint8_t { absent, unplaced, placed };
  struct Entry {
    Aabb box;
    std::uint32_t position = 0;  // in unplaced_
    State state = State::absent;
  };
  struct Detail {
    Aabb cell;
    ObjectRuns::Run objects;
    int depth = 0;
    std::uint32_t split_at = 0;  // objects at which halving is tried (again)
  };

  void enter(ObjectId object, const Aabb& box);
  void leave(ObjectId object);
  void lay_root();
  void add(NodeIndex node, ObjectId object, const Aabb& box);
  void take(NodeIndex node, ObjectId object, const Aabb& box);
  void split_pending();
  void split_if_due(NodeIndex node);
  void merge_if_due(NodeIndex node);
  Entry& entry_of(ObjectId object, const char* what);

  Limits limits_;
  NodeBlocks blocks_{8};
  std::vector<SpatialNode> nodes_{1};
  std::vector<Detail> details_{1};
  ObjectRuns runs_;
  std::vector<Entry> entries_of_objects_;  // by object
  std::vector<ObjectId> unplaced_;
  std::size_t valid_unplaced_ = 0;  // of those, with a valid box: they are outside of the root
  std::size_t placed_ = 0;
  std::uint64_t entries_ = 0;
  std::vector<NodeIndex> pending_;  // leaves that may have to be halved
  std::vector<ObjectId> gathered_;
};

}  // namespace vislab
