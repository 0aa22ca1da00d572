// The clusters of a mesh as a tree with 16 children a node, and the triangles to mark for each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/backface/cluster_kernel.h"
#include "algorithms/backface/run_list.h"
#include "algorithms/backface/triangle_clusters.h"

namespace vislab::backface_culling {

/// Immutable. Deterministic.
class ClusterTree {
 public:
  /// Throws InputError for a mesh that has too many triangles for a RunList. O(n log n).
  ClusterTree(const Mesh& mesh, const MeshFrame& frame, const ClusterSettings& settings);

  /// Every node's bound is made from the planes below it, about its own origin: those of its
  /// children hold for other origins.
  std::span<const ClusterTreeNode> nodes() const { return nodes_; }  // empty: nothing to test
  /// Largest absolute coordinate of all origins, for cluster_eye().
  double reach() const { return reach_; }
  std::uint32_t cluster_count() const { return cluster_count_; }
  /// Clusters that lie below a child (node * 16 + lane), numbered in the tree's order.
  struct Clusters {
    std::uint32_t first = 0, count = 0;
  };
  Clusters clusters_below(std::uint32_t child) const { return clusters_[child]; }
  /// Sets the bits of all triangles below a child.
  void mark(std::uint32_t child, std::uint64_t* bits) const {
    const Marks& marks = marks_[child];
    if (marks.as_words) {
      words_.mark(marks.first, marks.end, bits);
    } else {
      runs_.mark(marks.first, marks.end, bits);
    }
  }
  std::size_t bytes() const;

 private:
  class Builder;

  struct Marks {
    std::uint32_t first = 0, end = 0;  // in runs_, or in words_
    bool as_words = false;
  };

  std::vector<ClusterTreeNode> nodes_;
  std::vector<Clusters> clusters_;  // by child
  std::vector<Marks> marks_;        // by child
  RunList runs_;                    // of all clusters, one after the other
  WordList words_;                  // of the nodes for which that is shorter
  double reach_ = 0.0;
  std::uint32_t cluster_count_ = 0;
};

}  // namespace vislab::backface_culling
