// Meshes as the software rasterisers want them.
//
// Idea: a mesh is cut into runs of few triangles (clusters) in their own order, each with its own
//   list of vertices and a box, so that what lies outside of the window is dropped by runs,
//   vertices are transformed once a run, and everything fits the processor's innermost cache.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "common/geometry/bounds.h"
#include "common/scene/scene.h"

namespace vislab {

/// A run of faces of a mesh, and the vertices that they use.
struct RasterCluster {
  static constexpr std::uint32_t greatest_size = 64;  // triangles

  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t first_face = 0, face_count = 0;
  std::uint32_t first_vertex = 0, vertex_count = 0;
  glm::dvec3 center{0.0}, half_size{0.0};  // of its box, mesh frame
};

/// Owns what it needs; the mesh may go.
class RasterMesh {
 public:
  /// Runs of vertices begin at multiples of this, and arrays of corners may be read by this many
  /// beyond their end.
  static constexpr std::uint32_t padding = 16;

  RasterMesh() = default;
  explicit RasterMesh(const Mesh& mesh);

  std::span<const glm::vec3> positions() const { return positions_; }
  std::span<const glm::uvec3> triangles() const { return triangles_; }
  /// Of the vertices that triangles use.
  const Aabb& bounds() const { return bounds_; }

  std::span<const RasterCluster> clusters() const { return clusters_; }
  /// Coordinates 0 … 2 of the clusters' vertices; the last of a run is repeated up to where the
  /// next begins.
  const float* vertices(int axis) const { return vertices_[axis].data(); }
  /// A face is one triangle, or (pair) this and the next one. `triangle` ascends.
  std::uint32_t face_triangle(std::uint32_t face) const { return face_triangles_[face]; }
  const std::uint32_t* face_triangles() const { return face_triangles_.data(); }
  bool is_pair(std::uint32_t face) const { return corners_[3][face] != corners_[0][face]; }
  /// The face that a triangle belongs to.
  std::uint32_t face_of(std::uint32_t triangle) const { return faces_[triangle]; }
  /// Corners 0 … 3 of all faces, as places in their cluster's run of vertices. A pair is the
  /// triangles (0, 1, 2) and (0, 2, 3), whose corners begin elsewhere in triangles(); of a face
  /// that is one triangle, corner 3 is corner 0.
  const std::uint32_t* corners(int corner) const { return corners_[corner].data(); }
  /// Corner 0 … 3 of a face.
  glm::vec3 position(const RasterCluster& cluster, std::uint32_t face, int corner) const {
    const std::uint32_t vertex = cluster.first_vertex + corners_[corner][face];
    return {vertices_[0][vertex], vertices_[1][vertex], vertices_[2][vertex]};
  }

  std::size_t bytes() const;

 private:
  void add_cluster(std::uint32_t first, std::uint32_t count);

  std::vector<glm::vec3> positions_;
  std::vector<glm::uvec3> triangles_;
  Aabb bounds_;
  std::vector<RasterCluster> clusters_;
  std::vector<float> vertices_[3];
  std::vector<std::uint32_t> corners_[4];
  std::vector<std::uint32_t> face_triangles_;
  std::vector<std::uint32_t> faces_;  // by triangle
};

/// Triangles [first, first + count) of a mesh, placed in the world; they get the ids first_id,
/// first_id + 1, …
struct RasterDraw {
  const RasterMesh* mesh = nullptr;
  const glm::dmat4x3* transform = nullptr;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::uint32_t first_id = 0;
  /// Leaves out triangles that are seen from behind: nothing is lost of a solid mesh.
  bool front_only = false;
};

}  // namespace vislab
