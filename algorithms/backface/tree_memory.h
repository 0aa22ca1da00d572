// What is remembered of a cone tree's verdicts from frame to frame, for one object.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "algorithms/backface/cone_tree.h"

namespace vislab::backface_culling {

/// How much of a tree a walk looked at.
struct WalkCounts {
  std::uint64_t tested = 0;  // nodes that have a cone
  std::uint64_t reused = 0;  // nodes that were not tested because their verdicts still held
};

/// The triangles that the tree surely shows from behind, without any memory: `back` has a bit for
/// each triangle. O(nodes down to the verdicts + runs).
void mark_tree(const ConeTree& tree, const TreeEye& eye, std::span<std::uint64_t> back,
               WalkCounts& counts);

/// The verdicts of one object's nodes, and how long they hold.
///
/// The eye's way is summed up. A node that was tested when the sum was s with a slack of r holds
/// until the sum is s + r, which is at least the distance between the two eyes; a subtree holds
/// until the first of its verdicts that count ends. The bits of triangles are kept, and only what
/// changes is written. The bits are those of mark_tree, always.
/// 24 bytes a node and a bit a triangle.
class TreeMemory {
 public:
  explicit TreeMemory(const ConeTree& tree);

  /// As if nothing had been seen yet.
  void forget() { known_ = false; }
  /// The bits for an eye. O(1) if the eye has not moved; O(nodes down to the verdicts that end, +
  /// runs that change). `tree` must be that of the constructor.
  std::span<const std::uint64_t> mark(const ConeTree& tree, const TreeEye& eye, WalkCounts& counts);

  std::size_t bytes() const {
    return nodes_.capacity() * sizeof(Node) + back_.capacity() * sizeof(std::uint64_t);
  }

 private:
  struct Node {
    /// The sum up to which this node's verdict holds, and all that count at and below it.
    double until = -std::numeric_limits<double>::infinity();
    double below_until = -std::numeric_limits<double>::infinity();
    std::uint32_t below = 0;  // verdicts of cones that count at and below it
    /// The last verdict; of a node that has none, what its bits say as they are.
    ConeTree::Facing facing = ConeTree::Facing::front;
  };

  void visit(const ConeTree& tree, const TreeEye& eye, std::uint32_t index, WalkCounts& counts);
  /// A node gets another verdict: the bits below it, or what its children start from.
  void change(const ConeTree& tree, std::uint32_t index, ConeTree::Facing facing);

  std::vector<Node> nodes_;
  std::vector<std::uint64_t> back_;
  TreeEye eye_;       // of the last call
  double way_ = 0.0;  // the sum
  bool known_ = false;
};

}  // namespace vislab::backface_culling
