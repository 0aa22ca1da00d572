// LooseOctree: an octree for moving objects, each of which stands at one node.
//
// Idea: an object stands at the smallest node whose box holds its bounding sphere. Node boxes are
//   cells enlarged by `overlap_m` on every side. With 0 the octree is strict: what straddles a
//   plane climbs, and what straddles one of the main planes stays in the root, where every query
//   meets it. An object knows its node; when it has moved it climbs from there as far as it must
//   and sinks again as far as it can. Octants that are not needed any more are given back.
// Guarantee: an object's box lies in the boxes of its node and of all nodes above.
// Cost: insert O(depth); move O(levels climbed and sunk), O(1) if the object stays at its node;
//   remove O(depth) for the counts. Node boxes are whole cells, looser than the objects in them.
// Limits: the overlap is a length, as in the report, and the same on all levels. Ulrich's loose
//   octree (each node box twice as large as its cell) is an overlap of half a cell's edge: this one
//   is as loose on one level, tighter above, looser below. Too small, and small objects on planes
//   climb; too large, and the enlarged nodes touch the frustum more often. The least edge keeps
//   cells from becoming small beside the overlap.
// Sources: engine report, 2.2.1-2.2.2 and 3; Ulrich 2000, Loose Octrees.
#pragma once

#include "common/spatial/node_blocks.h"
#include "common/spatial/object_runs.h"
#include "common/spatial/spatial_structure.h"

namespace vislab {

class LooseOctree final : public SpatialStructure {
 public:
  struct Limits {
    double overlap_m = 0.0;
    int depth = 8;                   // the root is at 0
    double least_edge_m = 0.0;       // cells are not halved into smaller ones
    std::uint32_t leaf_objects = 0;  // nor if that few objects are in them; 0: as in the report
  };

  explicit LooseOctree(const Limits& limits) : limits_(limits) {}

  /// The root is the cube around the bounding spheres of all valid boxes.
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
  /// Objects at and below the node.
  std::uint32_t count_below(NodeIndex node) const { return details_[node].below; }
  std::size_t bytes() const override;

  /// Nodes in use, empty ones among them.
  std::size_t node_count() const { return blocks_.used(); }
  /// The node an object stands at; none_id if it is not in or unplaced.
  NodeIndex node_of(ObjectId object) const;

 private:
  static constexpr NodeIndex absent = none_id;
  static constexpr NodeIndex nowhere = none_id - 1;  // unplaced

  struct Entry {
    Aabb box;
    Sphere sphere;
    NodeIndex node = absent;
    std::uint32_t position = 0;  // at the node, or in unplaced_
  };
  struct Detail {
    Aabb cell;
    Aabb loose;               // the cell with its overlap
    ObjectRuns::Run objects;  // at the node
    std::uint32_t below = 0;  // objects at the node and below
    NodeIndex parent = 0;
    int depth = 0;
    bool divisible = false;  // by depth, edge and float
  };

  void lay_root();
  void place(ObjectId object, NodeIndex from);
  void attach(NodeIndex node, ObjectId object);
  void detach(ObjectId object);
  void add_to_run(NodeIndex node, ObjectId object);
  void take_from_run(ObjectId object);
  void put_outside(ObjectId object);
  void take_from_outside(ObjectId object);
  void count(NodeIndex node, int change);
  bool accepts(NodeIndex node, const Entry& entry) const;
  std::uint32_t octant_of(const Detail& detail, const Entry& entry) const;
  bool fits_an_octant(NodeIndex node, const Entry& entry) const;
  void split(NodeIndex node);
  void collapse_from(NodeIndex node);
  void give_back_octants(NodeIndex node);
  Detail new_detail(const Aabb& cell, NodeIndex parent, int depth) const;
  Entry& entry_of(ObjectId object, const char* what);

  Limits limits_;
  NodeBlocks blocks_{8};
  std::vector<SpatialNode> nodes_{1};
  std::vector<Detail> details_{1};
  ObjectRuns runs_;
  std::vector<Entry> entries_;  // by object
  std::vector<ObjectId> unplaced_;
  std::size_t valid_unplaced_ = 0;  // of those, with a valid box: they are outside of the root
  std::vector<NodeIndex> pending_;
  std::vector<ObjectId> gathered_;
};

}  // namespace vislab
