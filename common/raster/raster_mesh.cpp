#include "common/raster/raster_mesh.h"

#include <algorithm>

namespace vislab {
namespace {

/// Do the triangles (p, q, r) and (p, r, s) lie in one plane, exactly up to the rounding of double,
/// and make up a strictly convex quadrilateral?
bool is_plane_and_convex(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r,
                         const glm::dvec3& s) {
  const glm::dvec3 normal = glm::cross(q - p, r - p);
  if (glm::dot(normal, s - p) != 0.0) return false;
  const auto agrees = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::dot(normal, glm::cross(b - a, c - a)) > 0.0;
  };
  return agrees(p, q, r) && agrees(p, r, s) && agrees(p, q, s) && agrees(q, r, s);
}

/// Corners of the quadrilateral that two triangles make up, if they do.
bool pair_of(std::span<const glm::vec3> positions, const glm::uvec3& first,
             const glm::uvec3& second, glm::uvec4& out) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const glm::uvec4 quad(first[i], first[(i + 1) % 3], first[(i + 2) % 3], second[(j + 2) % 3]);
      if (second[j] != quad[0] || second[(j + 1) % 3] != quad[2]) continue;
      if (!is_plane_and_convex(positions[quad[0]], positions[quad[1]], positions[quad[2]],
                               positions[quad[3]])) {
        continue;
      }
      out = quad;
      return true;
    }
  }
  return false;
}

}  // namespace

RasterMesh::RasterMesh(const Mesh& mesh) : positions_(mesh.positions), triangles_(mesh.triangles) {
  const auto count = static_cast<std::uint32_t>(triangles_.size());
  for (std::uint32_t first = 0; first < count; first += RasterCluster::greatest_size) {
    add_cluster(first, std::min(RasterCluster::greatest_size, count - first));
  }
  for (auto& corners : corners_) {
    corners.resize(corners.size() + padding, 0);
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
  cluster.first_face = static_cast<std::uint32_t>(face_triangles_.size());
  for (std::uint32_t i = first; i < first + count;) {
    glm::uvec4 quad(triangles_[i], triangles_[i].x);
    const bool pair =
        i + 1 < first + count && pair_of(positions_, triangles_[i], triangles_[i + 1], quad);
    for (int corner = 0; corner < 4; ++corner) {
      const auto at = std::ranges::lower_bound(used, quad[corner]);
      corners_[corner].push_back(static_cast<std::uint32_t>(at - used.begin()));
    }
    const auto face = static_cast<std::uint32_t>(face_triangles_.size());
    face_triangles_.push_back(i);
    for (const std::uint32_t end = i + (pair ? 2 : 1); i < end; ++i) faces_.push_back(face);
  }
  cluster.face_count = static_cast<std::uint32_t>(face_triangles_.size()) - cluster.first_face;
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
  bytes += (face_triangles_.capacity() + faces_.capacity()) * sizeof(std::uint32_t);
  return bytes;
}

}  // namespace vislab
