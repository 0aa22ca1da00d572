// Meshes that tests make from others.
#pragma once

#include <utility>

#include "common/scene/scene.h"

namespace vislab {

/// Every triangle wound the other way round.
inline Mesh inverted(Mesh mesh) {
  for (glm::uvec3& triangle : mesh.triangles) std::swap(triangle.x, triangle.y);
  return mesh;
}

/// Adds a mesh to another, in the same mesh, scaled and then moved.
inline void append(Mesh& mesh, const Mesh& other, const glm::vec3& offset, float scale = 1.0F) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  for (const glm::vec3& p : other.positions) mesh.positions.push_back(p * scale + offset);
  for (const glm::uvec3& t : other.triangles) mesh.triangles.push_back(t + base);
}

/// The same surface with three vertices of its own for each triangle.
inline Mesh with_split_vertices(const Mesh& mesh) {
  Mesh split;
  for (const glm::uvec3& triangle : mesh.triangles) {
    const auto base = static_cast<std::uint32_t>(split.positions.size());
    for (int i = 0; i < 3; ++i) split.positions.push_back(mesh.positions[triangle[i]]);
    split.triangles.emplace_back(base, base + 1, base + 2);
  }
  return split;
}

}  // namespace vislab
