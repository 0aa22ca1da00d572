// The clusters of a mesh as a tree with 16 children a node, and the triangles to mark for each.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "algorithms/backface/cluster_kernel.h"
#include "algorithms/backface/cluster_planes.h"
#include "algorithms/backface/run_list.h"
#include "algorithms/backface/triangle_clusters.h"

namespace vislab::backface_culling {

/// What a tree holds for clusters that are seen from both sides.
enum class MixedClusters {
  keep,  // nothing: their triangles are kept
  test   // the planes of all triangles
};

/// Immutable. Deterministic.
class ClusterTree {
 public:
  /// Throws InputError for a mesh that has too many triangles for a RunList. O(n log n).
  ClusterTree(const Mesh& mesh, const MeshFrame& frame, const ClusterSettings& settings,
              MixedClusters mixed = MixedClusters::keep);

  /// Every node's bound is made from the planes below it, about its own origin: those of its
  /// children hold for other origins.
  std::span<const ClusterTreeNode> nodes() const { return nodes_; }  // empty: nothing to test
  /// Largest absolute coordinate of all bounds' origins, for cluster_eye().
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
  /// With MixedClusters::test: sets the bits of those triangles that are surely seen from behind,
  /// of these clusters and of all triangles that are in no tested cluster. Returns how many planes
  /// that took.
  std::size_t mark_mixed(std::span<const std::uint32_t> clusters, const PlaneTest& test,
                         std::uint64_t* bits) const;
  /// With MixedClusters::test: would testing the planes of all triangles, in the mesh's order, take
  /// less time? Judged by what is marked for eyes all around, by declared times of an operation.
  bool is_slower_than_planes(const MeshFrame& frame, double eye_distance) const;
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
  std::optional<ClusterPlanes> planes_;
  double reach_ = 0.0;
  std::uint32_t cluster_count_ = 0;
};

}  // namespace vislab::backface_culling
