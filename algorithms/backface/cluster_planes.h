// The planes of a mesh's triangles, cluster by cluster: for clusters that face neither way as a
// whole.
//
// Layout: eight triangles to a block of 128 bytes, so that a cluster is one piece of memory; a
//   cluster begins a block, and runs of its triangles end where 64 of them do, so that answers fit
//   a word.
// Guarantee: the answers are those of mark_behind() for the same triangles, bit for bit, on every
//   instruction set: products and sums in its order, each rounded.
// Cost: as mark_behind(), and an operation for every run of triangles to bring answers into the
//   mesh's order. Memory: 16 bytes a triangle, 4 a run and 16 a
//   cluster.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/backface/plane_kernel.h"
#include "algorithms/backface/run_list.h"
#include "algorithms/backface/triangle_clusters.h"

namespace vislab::backface_culling {

/// Immutable. Deterministic.
class ClusterPlanes {
 public:
  /// O(triangles). Throws InputError for a mesh that has too many triangles for a RunList.
  ClusterPlanes(const Mesh& mesh, const MeshFrame& frame, const TriangleClusters& clusters);

  /// Sets the bits of the triangles of these clusters that are surely seen from behind. Takes all
  /// clusters of `clusters`, those from `tested` on too.
  void mark(std::span<const std::uint32_t> clusters, const PlaneTest& test,
            std::uint64_t* bits) const;
  std::size_t cluster_count() const { return first_triangle_.size() - 1; }
  std::size_t triangle_count() const { return first_triangle_.back(); }
  std::size_t triangles_in(std::span<const std::uint32_t> clusters) const {
    std::size_t sum = 0;
    for (const std::uint32_t cluster : clusters) {
      sum += first_triangle_[cluster + 1] - first_triangle_[cluster];
    }
    return sum;
  }
  std::size_t bytes() const;

  static constexpr std::size_t width = 8;
  /// Rows x, y, z and distances, as PlaneArrays has them. Triangles that are none are never behind.
  struct alignas(64) Block {
    std::array<std::array<float, width>, 4> row{};
  };
  /// At most 64 triangles of a cluster: up to where the next begins.
  struct Part {
    std::uint32_t block = 0, run = 0;
  };

 private:
  std::vector<Block, HugePageAllocator<Block>> blocks_;
  std::vector<Part> parts_;                // and the end
  std::vector<std::uint32_t> first_part_;  // by cluster, and the end
  std::vector<std::uint32_t>
      first_triangle_;  // by cluster, and the end: as TriangleClusters::first
  RunList runs_;
};

}  // namespace vislab::backface_culling
