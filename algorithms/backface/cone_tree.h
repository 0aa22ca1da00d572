// A hierarchy of clusters with cones of normals: which parts of a mesh are seen from behind, which
// from the front, and for how long that stays so while the eye moves.
//
// Idea: a node holds two cones, one of eyes that see all of its triangles from behind and one of
//   eyes that see all of them from the front. How deep an eye is in such a cone, as
//   axis . (apex - eye) - sine |apex - eye| tells, changes by at most 1 + sine times the way of the
//   eye. So a verdict holds until the eye has gone that depth (or, where it is in neither cone,
//   what is missing to the nearer one) over 1 + sine: the node's slack.
// Sources: Kumar, Manocha, Garrett and Lin 1996, Hierarchical Back-Face Culling; cones as
//   normal_cone.h. The slack is this lab's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/backface/cluster_runs.h"
#include "algorithms/backface/normal_cone.h"
#include "algorithms/backface/triangle_clusters.h"

namespace vislab::backface_culling {

/// The eye as the tree takes it.
struct TreeEye {
  glm::dvec3 position{0.0};  // perspective: relative to the mesh's middle; else a unit direction
  bool perspective = true;
  double margin = 0.0;  // what the depth in a cone may be wrong by because the eye is

  explicit TreeEye(const MeshEye& eye);
  TreeEye() = default;

  /// How far verdicts may change between two eyes of the same projection, as their slack counts it;
  /// rounded up, and 0 only if the eyes are equal.
  double way_to(const TreeEye& other) const;
};

/// The tree of one mesh. Immutable.
class ConeTree {
 public:
  enum class Facing : std::uint8_t { back, front, mixed };

  struct Node {
    NormalCone cone;
    glm::dvec3 back_apex{0.0};          // behind all planes
    glm::dvec3 front_apex{0.0};         // in front of all planes
    std::uint32_t first = 0, end = 0;   // clusters
    std::uint32_t left = 0, right = 0;  // nodes; 0: a leaf

    bool is_leaf() const { return left == 0; }
  };

  struct Verdict {
    Facing facing = Facing::mixed;
    double slack = 0.0;  // the verdict holds for eyes whose way_to is below this
  };

  /// O(triangles log triangles).
  ConeTree(const Mesh& mesh, const MeshFrame& frame, const ClusterSettings& settings);

  /// In pre-order; nodes()[0] is the root. Empty if no triangle can be tested.
  std::span<const Node> nodes() const { return nodes_; }
  std::size_t triangle_count() const { return triangle_count_; }
  const ClusterRuns& runs() const { return runs_; }

  /// What an eye sees of a node, surely: exactly the same for the same node and eye. A node without
  /// a cone is mixed for ever.
  static Verdict verdict(const Node& node, const TreeEye& eye);

  std::size_t bytes() const { return nodes_.capacity() * sizeof(Node) + runs_.bytes(); }

 private:
  ConeTree(const Mesh& mesh, const MeshFrame& frame, const TriangleClusters& clusters);
  void add_cones(const TriangleClusters& clusters, std::span<const glm::dvec4> planes,
                 double reach);

  std::size_t triangle_count_;
  std::vector<Node> nodes_;
  ClusterRuns runs_;
};

}  // namespace vislab::backface_culling
