// Clusters: groups of a mesh's triangles that face alike, made to be tested as one.
//
// Idea: whether a triangle is seen from behind depends on its plane alone, so triangles belong
//   together if their planes are near each other as seen from where eyes usually are, connected or
//   not: slopes of several bumps that lie parallel cull better together than the two slopes of one
//   bump. Planes are points (normal, offset / distance of the eye) here, which are split top-down
//   across their farthest extent until clusters are small; then the cost model of the slides joins
//   neighbours where a test costs more than it spares.
// Cost: O(n log n), and O(n) a level for clusters that are joined; ./lab bench backface tells
//   triangles a second.
// Limits: triangles without area, or nearly, have no plane to tell by, and are set apart. Runs of
//   triangles that follow each other in the mesh become short where the surface is rough.
// Sources: Zachmann slides 27-29 for the cost model. The slides take a share of the cluster's own
//   box as the possible places of the eye; clusters here may lie all over the mesh, so it is a box
//   around the mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/backface/culling_volume.h"

namespace vislab::backface_culling {

struct ClusterSettings {
  /// Triangles in a cluster before any are joined, at least 1. Smaller where a cluster would hardly
  /// ever be culled, across sharp edges say, and in small meshes, so that there are `least_count`.
  std::uint32_t size = 16;
  std::uint32_t least_count = 256;  // at least 1
  /// Where eyes usually are: the distance from the middle of the mesh, as a multiple of its size
  /// (MeshFrame::size), at least 2. What is near and what is probable is measured with it.
  double eye_distance = 3.0;
  /// t_C / r: the time to test a cluster in that of drawing a triangle. 0: nothing is joined
  /// unless it culls as well.
  double test_cost = 0.0;
  JoinRule join = JoinRule::derived;
  Origin origin = Origin::centre;  // of the bounds by which it is judged what joins
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

/// Deterministic.
TriangleClusters make_clusters(const Mesh& mesh, const MeshFrame& frame,
                               const ClusterSettings& settings);

/// Unit planes of the triangles of the clusters below `tested`, in the order of `order`.
std::vector<glm::dvec4> planes_in_order(const Mesh& mesh, const MeshFrame& frame,
                                        const TriangleClusters& clusters);

/// Box around triangles, relative to the mesh's middle, rounded to float.
Aabb box_of(const Mesh& mesh, const MeshFrame& frame, std::span<const std::uint32_t> triangles);

}  // namespace vislab::backface_culling
