// Clusters of a mesh as runs of consecutive triangles: from clusters to bits of triangles.
#pragma once

#include <bit>
#include <span>
#include <vector>

#include "algorithms/backface/run_list.h"
#include "algorithms/backface/triangle_clusters.h"

namespace vislab::backface_culling {

/// The runs of every cluster of a partition, one after the other. 4 bytes a run and a cluster.
class ClusterRuns {
 public:
  /// Throws InputError for a mesh that has too many triangles (RunList).
  explicit ClusterRuns(const TriangleClusters& clusters) {
    RunList::check(clusters.order.size());
    first_run_.reserve(clusters.count() + 1);
    for (std::uint32_t cluster = 0; cluster < clusters.count(); ++cluster) {
      first_run_.push_back(runs_.size());
      runs_.append(clusters.of(cluster));
    }
    first_run_.push_back(runs_.size());
    runs_.shrink();
  }

  /// Sets the bits of all triangles of the clusters [first, end). O(runs).
  void set(std::uint32_t first, std::uint32_t end, std::span<std::uint64_t> triangles) const {
    runs_.mark(first_run_[first], first_run_[end], triangles.data());
  }

  /// Clears them.
  void clear(std::uint32_t first, std::uint32_t end, std::span<std::uint64_t> triangles) const {
    runs_.unmark(first_run_[first], first_run_[end], triangles.data());
  }

  /// Sets the bits of all triangles of those clusters whose bits are set; as many words as the
  /// clusters need. O(clusters / 64 + runs).
  void set(std::span<const std::uint64_t> clusters, std::span<std::uint64_t> triangles) const {
    for (std::uint32_t i = 0; i < clusters.size(); ++i) {
      for (std::uint64_t word = clusters[i]; word != 0; word &= word - 1) {
        const std::uint32_t cluster = i * 64 + static_cast<std::uint32_t>(std::countr_zero(word));
        set(cluster, cluster + 1, triangles);
      }
    }
  }

  std::size_t bytes() const {
    return runs_.bytes() + first_run_.capacity() * sizeof(std::uint32_t);
  }

 private:
  RunList runs_;
  std::vector<std::uint32_t> first_run_;  // of each cluster, and the end
};

}  // namespace vislab::backface_culling
