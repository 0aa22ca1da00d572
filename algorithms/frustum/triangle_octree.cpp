#include "algorithms/frustum/triangle_octree.h"

#include <algorithm>
#include <array>

namespace vislab::frustum_culling {

struct TriangleOctree::Builder {
  TriangleOctree& tree;
  const Mesh& mesh;
  std::size_t leaf_size;
  std::vector<glm::dvec3> middles;  // by triangle

  /// `triangles` are ascending. The node exists; its subtree is appended.
  void build(std::uint32_t index, const std::vector<std::uint32_t>& triangles,
             const glm::dvec3& center, double half, int depth_left) {
    tree.nodes_[index].first_run = static_cast<std::uint32_t>(tree.runs_.size());
    if (triangles.size() <= leaf_size || depth_left == 0) {
      fill_leaf(index, triangles);
    } else {
      split(index, triangles, center, half, depth_left);
    }
    Node& node = tree.nodes_[index];
    node.run_count = static_cast<std::uint32_t>(tree.runs_.size()) - node.first_run;
  }

  void fill_leaf(std::uint32_t index, const std::vector<std::uint32_t>& triangles) {
    Aabb box;
    const std::size_t first = tree.runs_.size();
    for (const std::uint32_t triangle : triangles) {
      for (int corner = 0; corner < 3; ++corner) {
        box.extend(mesh.positions[mesh.triangles[triangle][corner]]);
      }
      const bool follows = tree.runs_.size() > first &&
                           tree.runs_.back().first + tree.runs_.back().count == triangle;
      if (follows) {
        ++tree.runs_.back().count;
      } else {
        tree.runs_.push_back({triangle, 1});
      }
    }
    tree.nodes_[index].box = box;
  }

  void split(std::uint32_t index, const std::vector<std::uint32_t>& triangles,
             const glm::dvec3& center, double half, int depth_left) {
    std::array<std::vector<std::uint32_t>, 8> parts;
    for (const std::uint32_t triangle : triangles) {
      const glm::dvec3& middle = middles[triangle];
      const unsigned octant = (middle.x > center.x ? 1U : 0U) | (middle.y > center.y ? 2U : 0U) |
                              (middle.z > center.z ? 4U : 0U);
      parts[octant].push_back(triangle);
    }
    const auto first_child = static_cast<std::uint32_t>(tree.nodes_.size());
    const auto child_count = static_cast<std::uint32_t>(
        std::ranges::count_if(parts, [](const auto& part) { return !part.empty(); }));
    tree.nodes_[index].first_child = first_child;
    tree.nodes_[index].child_count = child_count;
    tree.nodes_.resize(tree.nodes_.size() + child_count);
    std::uint32_t child = first_child;
    Aabb box;
    for (unsigned octant = 0; octant < 8; ++octant) {
      if (parts[octant].empty()) continue;
      const glm::dvec3 way((octant & 1U) != 0 ? half : -half, (octant & 2U) != 0 ? half : -half,
                           (octant & 4U) != 0 ? half : -half);
      build(child, parts[octant], center + 0.5 * way, 0.5 * half, depth_left - 1);
      box.extend(tree.nodes_[child].box);
      ++child;
    }
    tree.nodes_[index].box = box;
  }
};

TriangleOctree::TriangleOctree(const Mesh& mesh, int depth, std::size_t leaf_size) {
  Builder builder{*this, mesh, leaf_size, {}};
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& triangle = mesh.triangles[i];
    all.push_back(i);
    builder.middles.push_back((glm::dvec3(mesh.positions[triangle.x]) +
                               glm::dvec3(mesh.positions[triangle.y]) +
                               glm::dvec3(mesh.positions[triangle.z])) /
                              3.0);
  }
  const glm::dvec3 half = mesh.bounds.half_size();
  nodes_.resize(1);
  builder.build(0, all, mesh.bounds.center(), std::max({half.x, half.y, half.z}), depth);
  nodes_.shrink_to_fit();
  runs_.shrink_to_fit();
}

}  // namespace vislab::frustum_culling
