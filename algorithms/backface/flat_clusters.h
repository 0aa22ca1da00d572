// The clusters of a mesh in a row, and the triangles to mark for each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/backface/back_bits.h"
#include "algorithms/backface/cluster_kernel.h"
#include "algorithms/backface/cluster_runs.h"
#include "algorithms/backface/triangle_clusters.h"

namespace vislab::backface_culling {

/// Immutable. Deterministic.
class FlatClusters {
 public:
  /// Throws InputError for a mesh that has too many triangles for a RunList. O(n log n).
  FlatClusters(const Mesh& mesh, const MeshFrame& frame, const ClusterSettings& settings);

  std::span<const ClusterBlock> blocks() const { return blocks_; }
  /// Largest absolute coordinate of all bounds' origins, for cluster_eye().
  double reach() const { return reach_; }
  std::size_t cluster_count() const { return cluster_count_; }
  std::size_t triangle_count() const { return triangle_count_; }
  /// Sets the bits of the triangles of all clusters whose bit is set in `clusters`.
  void mark(std::span<const std::uint64_t> clusters, std::uint64_t* bits) const {
    runs_.set(clusters, std::span(bits, words_of(triangle_count_)));
  }
  std::size_t bytes() const { return blocks_.capacity() * sizeof(ClusterBlock) + runs_.bytes(); }

 private:
  FlatClusters(const Mesh& mesh, const MeshFrame& frame, const ClusterSettings& settings,
               const TriangleClusters& clusters);

  std::size_t triangle_count_;
  std::size_t cluster_count_;  // without triangles that no test may leave out
  std::vector<ClusterBlock> blocks_;
  ClusterRuns runs_;
  double reach_ = 0.0;
};

}  // namespace vislab::backface_culling
