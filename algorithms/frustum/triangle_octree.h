// An octree over the triangles of one mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/scene/scene.h"

namespace vislab::frustum_culling {

/// Every triangle is in one leaf, that of its middle; the boxes of nodes are made around the whole
/// triangles, so they overlap a little and miss nothing. Immutable. Deterministic.
/// Source: Kowalka 2016, 3.3.2 (there a triangle is in every leaf that it touches).
class TriangleOctree {
 public:
  struct Node {
    Aabb box;  // mesh frame, around all triangles at and below the node
    std::uint32_t first_child = 0;
    std::uint32_t child_count = 0;  // 0: a leaf
    std::uint32_t first_run = 0;    // all triangles at and below the node
    std::uint32_t run_count = 0;
  };
  /// Consecutive triangles of the mesh.
  struct Run {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  /// Halves the cells of a cube around the mesh until no more than `leaf_size` triangles are left
  /// or `depth` is reached. O(triangles log).
  TriangleOctree(const Mesh& mesh, int depth, std::size_t leaf_size);

  std::span<const Node> nodes() const { return nodes_; }  // nodes()[0] is the root
  std::span<const Run> runs_below(const Node& node) const {
    return std::span(runs_).subspan(node.first_run, node.run_count);
  }
  std::size_t bytes() const {
    return nodes_.capacity() * sizeof(Node) + runs_.capacity() * sizeof(Run);
  }

 private:
  struct Builder;
  std::vector<Node> nodes_;
  std::vector<Run> runs_;
};

}  // namespace vislab::frustum_culling
