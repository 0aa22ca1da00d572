#include "algorithms/backface/tree_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "algorithms/backface/back_bits.h"

namespace vislab::backface_culling {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

void mark_below(const ConeTree& tree, const TreeEye& eye, std::uint32_t index,
                std::span<std::uint64_t> back, WalkCounts& counts) {
  const ConeTree::Node& node = tree.nodes()[index];
  const ConeTree::Facing facing = ConeTree::verdict(node, eye).facing;
  counts.tested += node.cone.exists() ? 1 : 0;
  if (facing == ConeTree::Facing::back) {
    tree.runs().set(node.first, node.end, back);
  } else if (facing == ConeTree::Facing::mixed && !node.is_leaf()) {
    mark_below(tree, eye, node.left, back, counts);
    mark_below(tree, eye, node.right, back, counts);
  }
}

}  // namespace

void mark_tree(const ConeTree& tree, const TreeEye& eye, std::span<std::uint64_t> back,
               WalkCounts& counts) {
  std::ranges::fill(back, 0);
  if (!tree.nodes().empty()) mark_below(tree, eye, 0, back, counts);
}

TreeMemory::TreeMemory(const ConeTree& tree)
    : nodes_(tree.nodes().size()), back_(words_of(tree.triangle_count())) {}

std::span<const std::uint64_t> TreeMemory::mark(const ConeTree& tree, const TreeEye& eye,
                                                WalkCounts& counts) {
  if (nodes_.empty()) return back_;
  if (!known_ || eye.perspective != eye_.perspective) {
    std::ranges::fill(back_, 0);
    nodes_[0] = Node();
    way_ = 0.0;
    known_ = true;
  } else if (const double way = eye_.way_to(eye); way > 0.0) {
    // Rounded up, so that the sum never falls behind the way.
    way_ = std::nextafter(way_ + way, infinite);
  }
  eye_ = eye;
  const std::uint64_t before = counts.tested;
  visit(tree, eye, 0, counts);
  counts.reused += nodes_[0].below - (counts.tested - before);
  return back_;
}

void TreeMemory::change(const ConeTree& tree, std::uint32_t index, ConeTree::Facing facing) {
  using Facing = ConeTree::Facing;
  const ConeTree::Node& node = tree.nodes()[index];
  const Facing before = std::exchange(nodes_[index].facing, facing);
  if (facing == Facing::back) {
    tree.runs().set(node.first, node.end, back_);
  } else if (node.is_leaf()) {
    if (before == Facing::back) tree.runs().clear(node.first, node.end, back_);
  } else if (facing == Facing::front) {
    tree.runs().clear(node.first, node.end, back_);
  } else {
    // The bits say of the children what they said of the whole.
    for (const std::uint32_t child : {node.left, node.right}) {
      nodes_[child] = Node();
      nodes_[child].facing = before;
    }
  }
}

void TreeMemory::visit(const ConeTree& tree, const TreeEye& eye, std::uint32_t index,
                       WalkCounts& counts) {
  Node& here = nodes_[index];
  if (way_ < here.below_until) return;
  const ConeTree::Node& node = tree.nodes()[index];
  if (!(way_ < here.until)) {
    const ConeTree::Verdict verdict = ConeTree::verdict(node, eye);
    counts.tested += node.cone.exists() ? 1 : 0;
    here.until = std::nextafter(way_ + verdict.slack, -infinite);
    if (verdict.slack == infinite) here.until = infinite;
    if (verdict.facing != here.facing) change(tree, index, verdict.facing);
  }
  here.below_until = here.until;
  here.below = node.cone.exists() ? 1 : 0;
  if (here.facing == ConeTree::Facing::mixed && !node.is_leaf()) {
    for (const std::uint32_t child : {node.left, node.right}) {
      visit(tree, eye, child, counts);
      here.below_until = std::min(here.below_until, nodes_[child].below_until);
      here.below += nodes_[child].below;
    }
  }
}

}  // namespace vislab::backface_culling
