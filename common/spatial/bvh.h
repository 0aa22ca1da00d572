// A binary bounding-volume hierarchy over the objects' boxes, built in four ways and kept up to
// date in three.
//
// Idea: every node's box holds its two children; objects lie in leaves. Top-down: ranges are split
//   where the surface-area heuristic, over bins of centres, promises the cheapest pair (Wald 2007).
//   Bottom-up: neighbours on the Z curve that are each other's best partner merge, round by round
//   (Meister and Bittner 2018). Incremental: each object becomes the sibling of the node that makes
//   the sum of surface areas grow least, found by branch and bound (Bittner, Hapala and Havran
//   2013), in shuffled order. Packed: halves of the Z curve (Lauterbach et al. 2009).
// Motion: the boxes of moved leaves and their ancestors are computed anew (refit), made larger but
//   never smaller (enlarge), the object is removed and inserted from the root (reinsert), or the
//   tree is built anew (rebuild). Enlarging and reinserting are Kowalka 2016, 2.5.2.
// Cost: top-down O(n log n), bottom-up about O(n), packed O(n), insertion usually O(log n), removal
//   O(depth), refit O(moved leaves and their ancestors). With motion by rebuilding, builders keep
//   their memory: to build the same again allocates nothing.
// Limits: refitted and enlarged trees get worse as objects mix. Memory grows with the largest id.
// Objects whose box is not valid are unplaced; all others have a node, wherever they are.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/spatial/spatial_structure.h"

namespace vislab {

struct BvhBuildMemory;

class Bvh : public SpatialStructure {
 public:
  enum class Build { top_down, bottom_up, incremental, packed };
  enum class Motion { refit, enlarge, reinsert, rebuild };
  struct Limits {
    Build build = Build::top_down;
    Motion motion = Motion::refit;
    std::uint32_t leaf_objects = 4;  // a leaf has at most so many; at least 1
  };

  explicit Bvh(const Limits& limits);
  ~Bvh() override;

  void build(std::span<const Aabb> boxes) override;
  void insert(ObjectId object, const Aabb& box) override;
  void remove(ObjectId object) override;
  void move(ObjectId object, const Aabb& box) override;
  void finish_changes() override;

  std::span<const SpatialNode> nodes() const override { return nodes_; }
  std::span<const ObjectId> objects_at(NodeIndex node) const override {
    return {objects_.data() + leaves_[node].first, leaves_[node].count};
  }
  /// Until the first insertion or removal after build().
  std::span<const ObjectId> objects_below(NodeIndex node) const override {
    if (!runs_intact_) return {};
    return {objects_.data() + links_[node].first_below, links_[node].count_below};
  }
  std::span<const ObjectId> unplaced() const override { return unplaced_; }
  /// Objects at and below the node.
  std::uint32_t count_below(NodeIndex node) const { return links_[node].count_below; }
  std::size_t bytes() const override;

  /// Sum of the surface areas of all nodes, metres squared. O(n).
  double surface_area() const;

 private:
  friend class BvhBuilder;
  static constexpr NodeIndex nowhere = 0xFFFFFFFFU;
  static constexpr NodeIndex in_unplaced = 0xFFFFFFFEU;

  struct Links {
    NodeIndex parent = nowhere;
    std::uint32_t count_below = 0;  // objects at and below
    std::uint32_t first_below = 0;  // their run, while runs are intact
    bool dirty = false;             // only within finish_changes()
  };
  struct Leaf {
    std::uint32_t first = 0, count = 0, capacity = 0;  // in objects_
  };
  struct Place {
    NodeIndex node = nowhere;    // nowhere, in_unplaced, or a leaf
    std::uint32_t unplaced = 0;  // index in unplaced_
    bool moved = false;          // is in moved_
    Aabb box;
  };
  struct Candidate {
    double bound;  // no sibling at or below the node makes the areas grow less
    NodeIndex node;
  };

  void clear_tree();
  void build_tree();
  NodeIndex add_pair(NodeIndex parent);
  void set_box(NodeIndex node);
  void put_in_tree(ObjectId object);
  void take_from_tree(ObjectId object);
  NodeIndex best_sibling(const Aabb& box);
  void add_to_leaf(NodeIndex leaf, ObjectId object);
  void make_sibling(NodeIndex node, ObjectId object);
  /// Parts the objects of two leaves anew: halves along the axis on which centres are farthest
  /// apart.
  void share_objects(NodeIndex full, NodeIndex other);
  void free_leaf_memory(NodeIndex leaf);
  void adopt(NodeIndex node);
  void replace_by_sibling(NodeIndex leaf);
  void refit_moved();

  Limits limits_;
  std::vector<SpatialNode> nodes_;  // the root, then pairs of siblings
  std::vector<Links> links_;        // by node
  std::vector<Leaf> leaves_;        // by node; inner nodes have no objects
  std::vector<ObjectId> objects_;
  std::vector<Place> places_;  // by object
  std::vector<ObjectId> unplaced_;
  std::vector<NodeIndex> free_pairs_;           // first nodes
  std::vector<std::uint32_t> free_capacities_;  // first places of leaf_objects each
  bool runs_intact_ = false;
  std::vector<ObjectId> moved_;  // since finish_changes(), for refit
  // Memory of searches.
  std::vector<Candidate> queue_;
  std::vector<NodeIndex> stack_;
  std::vector<ObjectId> shared_;
  std::unique_ptr<BvhBuildMemory> build_memory_;
};

}  // namespace vislab
