#include "common/raster/raster_mesh.h"

#include <algorithm>

namespace vislab {

RasterMesh::RasterMesh(const Mesh& mesh) : positions_(mesh.positions), triangles_(mesh.triangles) {
  const auto count = static_cast<std::uint32_t>(triangles_.size());
  for (std::uint32_t first = 0; first < count; first += RasterCluster::greatest_size) {
    add_cluster(first, std::min(RasterCluster::greatest_size, count - first));
  }
  for (auto& corners : corners_) {
    corners.resize(triangles_.size() + padding, 0);
    corners.shrink_to_fit();
  }
  for (auto& vertices : vertices_) vertices.shrink_to_fit();
}

void RasterMesh::add_cluster(std::uint32_t first, std::uint32_t count) {
  RasterCluster cluster;
  cluster.first_triangle = first;
  cluster.triangle_count = count;
  cluster.first_vertex = static_cast<std::uint32_t>(vertices_[0].size());
  std::vector<std::uint32_t> used;
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (int corner = 0; corner < 3; ++corner) used.push_back(triangles_[i][corner]);
  }
  std::ranges::sort(used);
  used.erase(std::ranges::unique(used).begin(), used.end());
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto at = std::ranges::lower_bound(used, triangles_[i][corner]);
      corners_[corner].push_back(static_cast<std::uint32_t>(at - used.begin()));
    }
  }
  cluster.vertex_count = static_cast<std::uint32_t>(used.size());
  Aabb box;
  for (const std::uint32_t vertex : used) box.extend(positions_[vertex]);
  cluster.center = box.center();
  cluster.half_size = box.half_size();
  bounds_.extend(box);
  while (used.size() % padding != 0) used.push_back(used.back());
  for (const std::uint32_t vertex : used) {
    for (int axis = 0; axis < 3; ++axis) vertices_[axis].push_back(positions_[vertex][axis]);
  }
  clusters_.push_back(cluster);
}

std::size_t RasterMesh::bytes() const {
  std::size_t bytes = positions_.capacity() * sizeof(glm::vec3) +
                      triangles_.capacity() * sizeof(glm::uvec3) +
                      clusters_.capacity() * sizeof(RasterCluster);
  for (const auto& vertices : vertices_) bytes += vertices.capacity() * sizeof(float);
  for (const auto& corners : corners_) bytes += corners.capacity() * sizeof(std::uint32_t);
  return bytes;
}

}  // namespace vislab
