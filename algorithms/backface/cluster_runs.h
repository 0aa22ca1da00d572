// Clusters of a mesh as runs of consecutive triangles: from clusters to bits of triangles.
#pragma once

#include <algorithm>
#include <bit>
#include <span>
#include <vector>

#include "algorithms/backface/back_bits.h"
#include "algorithms/backface/triangle_clusters.h"

namespace vislab::backface_culling {

/// The runs of every cluster of a partition, cut where a word of 64 bits ends, so that each is one
/// mask: where triangles of a cluster are scattered, as those with parallel planes are, setting
/// bits takes longer than the tests. 5 bytes a run, and 4 a cluster.
class ClusterRuns {
 public:
  explicit ClusterRuns(const TriangleClusters& clusters) {
    std::vector<TriangleRun> runs;
    first_run_.reserve(clusters.count() + 1);
    for (std::uint32_t cluster = 0; cluster < clusters.count(); ++cluster) {
      first_run_.push_back(static_cast<std::uint32_t>(triangles_.size()));
      runs.clear();
      append_runs(clusters.of(cluster), runs);
      for (TriangleRun run : runs) {
        while (run.count > 0) {
          const std::uint32_t count = std::min(run.count, 64 - run.first % 64);
          triangles_.push_back(run.first);
          counts_.push_back(static_cast<std::uint8_t>(count));
          run = {run.first + count, run.count - count};
        }
      }
    }
    first_run_.push_back(static_cast<std::uint32_t>(triangles_.size()));
    triangles_.shrink_to_fit();
    counts_.shrink_to_fit();
  }

  std::uint32_t run_count() const { return static_cast<std::uint32_t>(triangles_.size()); }

  /// Sets the bits of all triangles of the clusters [first, end). O(runs).
  void set(std::uint32_t first, std::uint32_t end, std::span<std::uint64_t> triangles) const {
    for_each_mask(first, end,
                  [&](std::uint32_t word, std::uint64_t mask) { triangles[word] |= mask; });
  }

  /// Clears them.
  void clear(std::uint32_t first, std::uint32_t end, std::span<std::uint64_t> triangles) const {
    for_each_mask(first, end,
                  [&](std::uint32_t word, std::uint64_t mask) { triangles[word] &= ~mask; });
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
    return (triangles_.capacity() + first_run_.capacity()) * sizeof(std::uint32_t) +
           counts_.capacity();
  }

 private:
  template <typename Function>
  void for_each_mask(std::uint32_t first, std::uint32_t end, Function&& f) const {
    for (std::uint32_t run = first_run_[first]; run < first_run_[end]; ++run) {
      const std::uint32_t triangle = triangles_[run];
      f(triangle / 64, (~std::uint64_t{0} >> (64U - counts_[run])) << (triangle % 64));
    }
  }

  std::vector<std::uint32_t> triangles_;  // the first of each run, in the order of clusters
  std::vector<std::uint8_t> counts_;      // of the same runs, 1 to 64
  std::vector<std::uint32_t> first_run_;  // of each cluster, and the end
};

}  // namespace vislab::backface_culling
