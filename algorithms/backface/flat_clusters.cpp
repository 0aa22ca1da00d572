#include "algorithms/backface/flat_clusters.h"

#include <algorithm>
#include <cmath>

namespace vislab::backface_culling {

FlatClusters::FlatClusters(const Mesh& mesh, const MeshFrame& frame,
                           const ClusterSettings& settings)
    : FlatClusters(mesh, frame, settings, make_clusters(mesh, frame, settings)) {}

FlatClusters::FlatClusters(const Mesh& mesh, const MeshFrame& frame,
                           const ClusterSettings& settings, const TriangleClusters& clusters)
    : triangle_count_(mesh.triangles.size()), cluster_count_(clusters.tested), runs_(clusters) {
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
  }
}

}  // namespace vislab::backface_culling
