// The inner loops of backface.cluster and backface.cluster_tree: sixteen bounds against an eye at
// once.
//
// Layout: blocks of 16 clusters, each of the ten numbers of a bound a row of 16 floats: 40 bytes a
//   cluster, all read in order.
// Guarantee: the answers are those of facing_of(), bit for bit, on every instruction set: products
//   and sums in its order, each rounded.
// Cost: a cluster takes three products, seven sums and comparisons, and three choices; twice that
//   where fronts are asked for too.
// Sources: Johannsen and Carter 1998; Zachmann slides 20-26.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/backface/cluster_bound.h"

namespace vislab::backface_culling {

/// Bounds of 16 clusters, without their fronts. The default is never seen from behind.
struct alignas(64) ClusterBlock {
  static constexpr std::size_t width = 16;
  using Row = std::array<float, width>;

  std::array<Row, 3> origin{};
  std::array<Row, 3> low{};
  std::array<Row, 3> high{};
  Row back;

  ClusterBlock() { back.fill(ClusterBound().back); }
  void set(std::size_t lane, const ClusterBound& bound);
};

/// A node of a tree: the bounds of its up to 16 children.
struct alignas(64) ClusterTreeNode {
  ClusterBlock children;
  ClusterBlock::Row front;
  /// Of each child: its own node, or 0 for a cluster.
  std::array<std::uint32_t, ClusterBlock::width> node{};
  std::uint32_t count = 0;     // children
  bool only_clusters = false;  // no child has a node

  ClusterTreeNode() { front.fill(ClusterBound().front); }
};

/// Writes a bit for each cluster, set if it is seen from behind: 16 to a block, four blocks to a
/// word. `back` has a word for every four blocks begun.
void find_back(std::span<const ClusterBlock> blocks, const ClusterEye& eye,
               std::span<std::uint64_t> back);

/// What a walk through a tree finds. Memory is used again.
struct TreeAnswer {
  /// Children that are seen from behind whole, as node * 16 + lane; none lies below another.
  std::vector<std::uint32_t> back;
  std::size_t back_count = 0;
  /// If asked for: clusters that are neither behind nor before the eye whole, likewise.
  std::vector<std::uint32_t> mixed;
  std::size_t mixed_count = 0;
  std::size_t nodes_tested = 0;
  std::vector<std::uint32_t> pending;

  std::span<const std::uint32_t> found() const { return std::span(back).first(back_count); }
  std::span<const std::uint32_t> found_mixed() const { return std::span(mixed).first(mixed_count); }

  /// Makes room for the answers of a tree.
  void reserve(std::size_t nodes);
  std::size_t bytes() const {
    return (back.capacity() + mixed.capacity() + pending.capacity()) * sizeof(std::uint32_t);
  }
};

/// Walks down from node 0, and no further where all triangles are seen from behind, or from the
/// front. `answer` must have room for the tree.
void find_back(std::span<const ClusterTreeNode> tree, const ClusterEye& eye, TreeAnswer& answer);

/// The same, with the mixed clusters.
void find_back_and_mixed(std::span<const ClusterTreeNode> tree, const ClusterEye& eye,
                         TreeAnswer& answer);

}  // namespace vislab::backface_culling
