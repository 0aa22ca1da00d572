// A bounding-volume hierarchy in the layout for fast frustum queries: eight children a node, whose
// boxes are tested at once. It is no SpatialStructure, but a layout for queries that build(boxes,
// tree) makes of one: its blocks of boxes relative to an origin are not nodes that others could
// walk.
//
// Idea: the boxes of a node's children, and of a leaf's objects, are arrays of eight minima and
//   maxima an axis. Objects are kept in the order of the leaves, so that whatever lies below a node
//   is one run of ids: a subtree that is surely inside costs one span. Planes that a node is surely
//   inside of are not asked below it. Kernels are float and SIMD behind a margin
//   (frustum_filter.h); what they cannot decide is decided by surely_outside() in double.
// Guarantee: keeps exactly the present objects that no plane of the frustum has surely_outside, on
//   every instruction set.
// Cost: build O(n) along the Z curve and O(n log n) else; query O(blocks that the frustum's
//   surface touches + runs); move O(1), refit O(changed blocks and their ancestors).
// Memory: 50 to 80 bytes an object, half of it for rebuilds.
// Limits: moving objects keep their place in the order, so that queries get slower as they mix:
//   decay() tells, and a new build mends.
// Sources: Wald, Benthin and Boulos 2008 (wide nodes); Assarsson and Moeller 2000 (plane masks);
//   Lauterbach et al. 2009 (Z curve); Dammertz, Hanika and Keller 2008 (collapsing a binary tree).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/frustum.h"
#include "common/scene/scene.h"
#include "common/spatial/huge_pages.h"
#include "common/spatial/morton.h"
#include "common/spatial/spatial_structure.h"

namespace vislab {

/// Eight boxes as arrays: minima x, y, z, maxima x, y, z, in metres from the hierarchy's origin.
/// Lanes without a box have a minimum above their maximum.
struct alignas(64) BoxBlock {
  static constexpr std::size_t width = 8;
  std::array<std::array<float, width>, 6> bounds;
};

/// An inner node: the boxes of its children, and where these are. Children that are nodes come
/// first, then those that are leaves.
struct alignas(64) WideNode {
  BoxBlock boxes;
  std::uint32_t inner_count = 0;
  std::uint32_t child_count = 0;
  std::uint32_t first_inner = 0;                           // index of the first child node
  std::uint32_t first_leaf = 0;                            // index of the first child leaf
  std::array<std::uint32_t, BoxBlock::width + 1> first{};  // places of child i: from first[i] on
};

/// What a query keeps. Use the same one again, and nothing is allocated.
struct WideSelection {
  /// Of these the answer is made up, without overlap. Some point into the hierarchy, some into
  /// `loose`.
  std::vector<std::span<const ObjectId>> runs;

  std::uint64_t blocks_tested = 0;    // of eight boxes; these grow from query to query
  std::uint64_t plane_tests = 0;      // of a plane and a block
  std::uint64_t undecided_tests = 0;  // objects that were decided in double

  // The query's own memory.
  struct Pending {
    std::uint32_t node;
    std::uint32_t planes;  // bit by plane that is to be asked
  };
  struct PendingLeaf {
    std::uint32_t leaf;
    std::uint32_t first, count;  // places of its objects
    std::uint32_t planes;
  };
  struct Places {
    std::uint32_t begin, end;
  };
  std::vector<Pending> pending;             // nodes that are visited
  std::vector<PendingLeaf> pending_leaves;  // leaves that are
  std::vector<Places> places;               // long runs, before absent objects are taken out
  std::vector<ObjectId> undecided;          // objects that float could not decide
  std::vector<ObjectId> loose;              // what is in no long run: its first loose_count
  std::size_t loose_count = 0;

  std::size_t bytes() const;
};

class WideBvh {
 public:
  enum class Order {
    median,  // halved at medians, along the longest side
    morton   // along the Z curve: built faster
  };
  struct QueryOptions {
    bool masking = true;             // planes that a node is inside of are not asked below it
    bool keep_intersecting = false;  // all objects of a leaf that is not surely outside are kept
  };

  /// Over objects 0 to boxes.size() - 1, world frame, all present. Forgets everything before, but
  /// keeps memory. Objects whose box is not valid, or so far out that float would blur the others,
  /// are kept apart.
  void build(std::span<const Aabb> boxes, Order order);
  /// The same with the hierarchy of `tree`, which must hold those objects, each once, in leaves of
  /// at most eight; nodes with at most eight children. Throws std::logic_error for others.
  void build(std::span<const Aabb> boxes, const SpatialStructure& tree);
  /// The same objects at new places: those that were not present stay so. No memory is taken that
  /// an equal build did not take.
  void rebuild(std::span<const Aabb> boxes, Order order);
  void rebuild(std::span<const Aabb> boxes, const SpatialStructure& tree);

  /// An object that is not present is in no query's answer.
  void set_present(ObjectId object, const Aabb& box, bool present);
  /// O(1). Of an object that is not present, nothing is kept.
  void move(ObjectId object, const Aabb& box);
  /// After changes and before the next query: all nodes hold their objects again.
  void refit();

  /// Sum of the surface areas of all nodes, as a multiple of what it was when built, with all
  /// objects present; less than 1 while many are absent, and 1 if there is nothing.
  double decay() const;
  /// Objects that are kept apart: each query tests them one by one.
  std::size_t apart_count() const { return apart_.size(); }
  std::size_t object_count() const { return state_.size(); }

  /// Present objects that are not surely outside a plane of the frustum. `boxes` are the present
  /// boxes by id, as they were given to build and move. The selection's runs hold until it is used
  /// again or the hierarchy changes.
  void query(const Frustum& frustum, std::span<const Aabb> boxes, const QueryOptions& options,
             WideSelection& out) const;

  /// Takes the memory that a selection can ever need.
  void reserve(WideSelection& out) const;

  std::size_t bytes() const;
  /// Throws std::logic_error that says what is broken. For tests; O(n).
  void audit(std::span<const Aabb> boxes) const;

 private:
  friend class WideBvhBuilder;
  static constexpr std::uint32_t nowhere = 0xFFFFFFFFU;
  enum State : std::uint8_t { present = 1, apart = 2, listed_apart = 4 };

  void start(std::span<const Aabb> boxes, bool forget);
  void pack(std::span<const Aabb> boxes, Order order);
  void collapse(std::span<const Aabb> boxes, const SpatialStructure& tree);
  void finish_build(std::span<const Aabb> boxes);
  bool fits(const Aabb& box) const;
  void write_box(ObjectId object, const Aabb& box);
  void write_absent(ObjectId object);
  void place(ObjectId object, const Aabb& box);
  void set_absent_bit(ObjectId object, bool absent);
  void refit_child(const BoxBlock& block, std::uint32_t parent_lane);
  void take_present(std::uint32_t begin, std::uint32_t end, WideSelection& out) const;

  glm::vec3 origin_{0.0F};
  float limit_ = 0.0F;  // no coordinate in the tree is farther from the origin

  std::vector<WideNode, HugePageAllocator<WideNode>>
      nodes_;  // the root first, children after their parents
  std::vector<BoxBlock, HugePageAllocator<BoxBlock>> leaves_;   // in the order of the objects
  std::vector<ObjectId, HugePageAllocator<ObjectId>> objects_;  // place to object
  std::vector<std::uint32_t> first_place_;                      // by leaf
  std::vector<std::uint32_t> node_parent_;                      // by node: parent * 8 + lane
  std::vector<std::uint32_t> leaf_parent_;                      // by leaf: parent * 8 + lane
  std::vector<std::uint32_t> slot_;         // by object: leaf * 8 + lane, or nowhere
  std::vector<std::uint8_t> state_;         // by object
  std::vector<std::uint64_t> absent_bits_;  // by place: is its object to be skipped?
  std::size_t absent_count_ = 0;
  std::vector<ObjectId> apart_;
  bool apart_changed_ = false;
  std::vector<std::uint64_t> dirty_leaves_;  // bits
  std::vector<std::uint64_t> dirty_nodes_;   // bits
  double area_ = 0.0;                        // of all children's boxes
  double area_when_built_ = 0.0;

  struct Item {
    glm::vec3 center;
    ObjectId object;
  };
  std::vector<Item> items_;  // memory of builds
  std::vector<MortonKey> keys_, key_scratch_;
  struct Source {
    std::uint32_t node;
    std::uint32_t tree_node;
    std::uint32_t first_place;
  };
  std::vector<std::uint32_t> tree_counts_;  // memory of builds from a tree: objects by its node
  std::vector<std::uint32_t> tree_order_;
  std::vector<Source> sources_;  // nodes still to be filled, and the tree's nodes they are made of
};

}  // namespace vislab
