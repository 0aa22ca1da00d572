// meshoptimizer's meshlets and their cones behind a small interface, so that its header stays in
// one file.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/scene/scene.h"

namespace vislab::peers {

/// A mesh as meshopt_buildMeshlets divides it.
struct MeshoptMeshlets {
  /// What meshopt_computeMeshletBounds says of a meshlet: 28 bytes, in the mesh's frame.
  struct Cone {
    std::array<float, 3> apex;
    std::array<float, 3> axis;
    float cutoff = 1.0F;
  };

  std::vector<Cone> cones;               // of each meshlet
  std::vector<std::uint32_t> triangles;  // of the mesh, meshlet by meshlet, ascending within each
  std::vector<std::uint32_t> first;      // of each meshlet in `triangles`, and the end
};

/// Meshlets of at most `max_vertices` (3 to 255) vertices and `max_triangles` (4 to 512, a multiple
/// of 4) triangles; `cone_weight` from 0 to 1. O(n log n).
MeshoptMeshlets meshopt_meshlets(const Mesh& mesh, std::size_t max_vertices,
                                 std::size_t max_triangles, float cone_weight);

}  // namespace vislab::peers
