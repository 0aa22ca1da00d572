#include "algorithms/backface/flat_clusters.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace vislab::backface_culling {

FlatClusters::FlatClusters(const Mesh& mesh, const MeshFrame& frame,
                           const ClusterSettings& settings)
    : triangle_count_(mesh.triangles.size()) {
  RunList::check(triangle_count_);
  const TriangleClusters clusters = make_clusters(mesh, frame, settings);
  const std::vector<glm::dvec4> planes = planes_in_order(mesh, frame, clusters);
  constexpr std::uint32_t width = ClusterBlock::width;
  blocks_.resize((clusters.tested + width - 1) / width);
  for (std::uint32_t cluster = 0; cluster < clusters.tested; ++cluster) {
    const std::span<const std::uint32_t> triangles = clusters.of(cluster);
    const ClusterBound bound =
        bound_of(std::span(planes).subspan(clusters.first[cluster], triangles.size()),
                 box_of(mesh, frame, triangles), frame, settings.origin);
    blocks_[cluster / width].set(cluster % width, bound);
    for (int axis = 0; axis < 3; ++axis) {
      reach_ = std::max(reach_, double(std::abs(bound.origin[axis])));
    }
    first_run_.push_back(runs_.size());
    runs_.append(triangles);
  }
  first_run_.push_back(runs_.size());
  first_run_.shrink_to_fit();
  runs_.shrink();
}

void FlatClusters::mark(std::span<const std::uint64_t> clusters, std::uint64_t* bits) const {
  for (std::uint32_t word = 0; word < clusters.size(); ++word) {
    for (std::uint64_t rest = clusters[word]; rest != 0; rest &= rest - 1) {
      const std::uint32_t cluster = word * 64 + static_cast<std::uint32_t>(std::countr_zero(rest));
      runs_.mark(first_run_[cluster], first_run_[cluster + 1], bits);
    }
  }
}

std::size_t FlatClusters::bytes() const {
  return blocks_.capacity() * sizeof(ClusterBlock) + first_run_.capacity() * sizeof(std::uint32_t) +
         runs_.bytes();
}

}  // namespace vislab::backface_culling
