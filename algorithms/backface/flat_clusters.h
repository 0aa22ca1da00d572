// The clusters of a mesh in a row, and the triangles to mark for each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/backface/cluster_kernel.h"
#include "algorithms/backface/run_list.h"
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
  std::size_t cluster_count() const { return first_run_.size() - 1; }
  std::size_t triangle_count() const { return triangle_count_; }
  /// Sets the bits of the triangles of all clusters whose bit is set in `clusters`.
  void mark(std::span<const std::uint64_t> clusters, std::uint64_t* bits) const;
  std::size_t bytes() const;

 private:
  std::size_t triangle_count_;
  std::vector<ClusterBlock> blocks_;
  std::vector<std::uint32_t> first_run_;  // by cluster, and the end
  RunList runs_;
  double reach_ = 0.0;
};

}  // namespace vislab::backface_culling
