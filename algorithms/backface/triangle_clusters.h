// Clusters: groups of a mesh's triangles that face alike, made to be tested as one.
//
// Idea: whether a triangle is seen from behind depends on its plane alone, so triangles belong
//   together if their planes are near each other as seen from where eyes usually are, connected or
//   not: slopes of several bumps that lie parallel cull better together than the two slopes of one
//   bump. Planes are points (normal, offset / distance of the eye) here, and are split top-down.
// Cost: O(n log n); see ./lab bench backface for triangles a second.
// Limits: triangles without area, or nearly, have no plane to tell by, and are set apart.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/backface/mesh_eye.h"

namespace vislab::backface_culling {

struct ClusterSettings {
  std::uint32_t size = 32;  // triangles in a cluster; at least 1
  /// Where eyes usually are: the distance from the middle of the mesh, as a multiple of its size
  /// (MeshFrame::size). Small: clusters are tight in space; large: in their normals.
  double eye_distance = 3.0;
};

/// A partition of a mesh's triangles, and the tree of splits that made it.
struct TriangleClusters {
  /// A cluster, or two subtrees that follow each other in `order`.
  struct Node {
    std::uint32_t first = 0, end = 0;   // positions in `order`
    std::uint32_t left = 0, right = 0;  // nodes; 0: a cluster

    bool is_cluster() const { return left == 0; }
  };

  std::vector<std::uint32_t> order;  // triangles, cluster by cluster, ascending within each
  std::vector<std::uint32_t> first;  // of each cluster in `order`, and the end: count() + 1
  std::uint32_t tested = 0;  // clusters from here on hold triangles that no test may leave out
  std::vector<Node> nodes;   // in pre-order, over the clusters below `tested`; empty without them

  std::uint32_t count() const { return static_cast<std::uint32_t>(first.size() - 1); }
  std::span<const std::uint32_t> of(std::uint32_t cluster) const {
    return std::span(order).subspan(first[cluster], first[cluster + 1] - first[cluster]);
  }
};

/// Plane of a triangle relative to the mesh's middle with a normal of unit length, n.p + d > 0 in
/// front. Zero if the triangle has no area, or nearly: then nothing may be concluded from it.
/// Else each coordinate of the normal is off by at most plane_error, and d by plane_error times the
/// frame's size, from a plane that is exactly that of the triangle.
glm::dvec4 unit_plane(const Mesh& mesh, const MeshFrame& frame, std::uint32_t triangle);
inline constexpr double plane_error = 4e-9;

/// Makes clusters of `size` triangles, the last few smaller. Deterministic.
TriangleClusters make_clusters(const Mesh& mesh, const MeshFrame& frame,
                               const ClusterSettings& settings);

/// Consecutive triangles of a mesh.
struct TriangleRun {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// Appends ascending triangles as runs.
void append_runs(std::span<const std::uint32_t> triangles, std::vector<TriangleRun>& runs);

}  // namespace vislab::backface_culling
