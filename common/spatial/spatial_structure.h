// The one interface of all spatial structures over the objects' boxes: bounding-volume hierarchies,
// octrees, binary space partitions. WideBvh is none of them: it is a layout for queries, which is
// made of any structure that repeats no objects by WideBvh::build(boxes, tree).
#pragma once

#include <cstdint>
#include <span>

#include "common/geometry/bounds.h"
#include "common/scene/scene.h"

namespace vislab {

/// A node as queries see it. Its children lie side by side.
struct SpatialNode {
  Aabb box;  // holds the boxes of all objects at and below the node; empty if there are none
  std::uint32_t first_child = 0;
  std::uint32_t child_count = 0;  // 0: a leaf
};

/// A hierarchy of boxes over objects. Deterministic: the same calls give the same structure.
///
/// Objects may come, go and move. No object is ever lost: one that no node can hold (its box is not
/// valid, or lies outside of a root that does not grow) is kept in unplaced(). Every other object
/// is at one node, or, if the structure repeats objects, at several.
class SpatialStructure {
 public:
  using NodeIndex = std::uint32_t;
  static constexpr NodeIndex root = 0;

  virtual ~SpatialStructure() = default;

  /// Anew over the objects 0 to boxes.size() - 1. World frame. Forgets everything before.
  virtual void build(std::span<const Aabb> boxes) = 0;
  /// Ids may be any; an id that is in is not inserted again, one that is not in is not moved or
  /// removed: std::logic_error.
  virtual void insert(ObjectId object, const Aabb& box) = 0;
  virtual void remove(ObjectId object) = 0;
  virtual void move(ObjectId object, const Aabb& box) = 0;
  /// To be called after a batch of the three above and before the next query: nodes hold their
  /// objects again.
  virtual void finish_changes() = 0;

  /// All nodes; nodes()[root] is the root, and what is not reachable from it means nothing. There
  /// is always a root.
  virtual std::span<const SpatialNode> nodes() const = 0;
  /// The objects at the node itself. In every node of an octree for moving objects, in the leaves
  /// of the others.
  virtual std::span<const ObjectId> objects_at(NodeIndex node) const = 0;
  /// All objects at and below the node as one run, if the structure keeps them so; else empty.
  virtual std::span<const ObjectId> objects_below(NodeIndex /*node*/) const { return {}; }
  /// Objects that no node holds: every query has to look at them one by one.
  virtual std::span<const ObjectId> unplaced() const = 0;
  /// Can an object be at several nodes?
  virtual bool repeats_objects() const { return false; }
  virtual std::size_t bytes() const = 0;

  /// Checks everything that is promised above for the objects that were put in, whose present boxes
  /// are in `boxes` by id: each is found, once or (if repeated) at least once, below nodes whose
  /// boxes hold its box (or, if repeated, at leaves that together do). Throws std::logic_error that
  /// says what is broken. For tests; O(objects × depth).
  void audit(std::span<const Aabb> boxes, std::size_t object_count) const;
};

}  // namespace vislab
