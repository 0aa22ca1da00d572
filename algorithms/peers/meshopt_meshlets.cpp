#include "algorithms/peers/meshopt_meshlets.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <stdexcept>

namespace vislab::peers {
namespace {

/// A triangle by its corners, and where it is from: the mesh's triangle, or the meshlet.
struct Entry {
  std::array<std::uint32_t, 3> corners;
  std::uint32_t from;

  auto operator<=>(const Entry&) const = default;
};

}  // namespace

MeshoptMeshlets meshopt_meshlets(const Mesh& mesh, std::size_t max_vertices,
                                 std::size_t max_triangles, float cone_weight) {
  const std::size_t index_count = 3 * mesh.triangles.size();
  const unsigned* indices = &mesh.triangles[0].x;
  const float* positions = &mesh.positions[0].x;
  const std::size_t most = meshopt_buildMeshletsBound(index_count, max_vertices, max_triangles);
  std::vector<meshopt_Meshlet> meshlets(most);
  std::vector<unsigned> vertices(most * max_vertices);
  std::vector<unsigned char> corners(most * max_triangles * 3);
  meshlets.resize(meshopt_buildMeshlets(
      meshlets.data(), vertices.data(), corners.data(), indices, index_count, positions,
      mesh.positions.size(), sizeof(glm::vec3), max_vertices, max_triangles, cone_weight));
  MeshoptMeshlets result;
  // Meshlets do not say which triangles they took; the corners tell.
  std::vector<Entry> taken;
  taken.reserve(mesh.triangles.size());
  for (std::uint32_t m = 0; m < meshlets.size(); ++m) {
    const meshopt_Meshlet& meshlet = meshlets[m];
    const unsigned* of_meshlet = vertices.data() + meshlet.vertex_offset;
    const unsigned char* local = corners.data() + meshlet.triangle_offset;
    const meshopt_Bounds bounds =
        meshopt_computeMeshletBounds(of_meshlet, local, meshlet.triangle_count, positions,
                                     mesh.positions.size(), sizeof(glm::vec3));
    result.cones.push_back({{bounds.cone_apex[0], bounds.cone_apex[1], bounds.cone_apex[2]},
                            {bounds.cone_axis[0], bounds.cone_axis[1], bounds.cone_axis[2]},
                            bounds.cone_cutoff});
    for (std::size_t t = 0; t < meshlet.triangle_count; ++t, local += 3) {
      taken.push_back({{of_meshlet[local[0]], of_meshlet[local[1]], of_meshlet[local[2]]}, m});
    }
  }
  std::vector<Entry> known;
  known.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& of_mesh = mesh.triangles[t];
    known.push_back({{of_mesh.x, of_mesh.y, of_mesh.z}, t});
  }
  std::ranges::sort(taken);
  std::ranges::sort(known);
  if (taken.size() != known.size()) throw std::logic_error("meshlets hold other triangles");
  std::vector<std::uint32_t> meshlet_of(mesh.triangles.size());
  result.first.assign(meshlets.size() + 1, 0);
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (taken[i].corners != known[i].corners) {
      throw std::logic_error("meshlets hold other triangles");
    }
    meshlet_of[known[i].from] = taken[i].from;
    ++result.first[taken[i].from + 1];
  }
  for (std::size_t m = 0; m < meshlets.size(); ++m) result.first[m + 1] += result.first[m];
  std::vector<std::uint32_t> next(result.first.begin(), result.first.end() - 1);
  result.triangles.resize(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    result.triangles[next[meshlet_of[t]]++] = t;
  }
  return result;
}

}  // namespace vislab::peers
