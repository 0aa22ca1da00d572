#include "common/scene/simplify.h"

#include <meshoptimizer.h>

namespace vislab {

Mesh simplified(const Mesh& mesh, std::uint32_t triangles) {
  if (mesh.triangles.size() <= triangles) return mesh;
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) indices.insert(indices.end(), {t.x, t.y, t.z});
  constexpr float any_error = 1.0F;  // relative to the mesh's extent: the count alone decides
  std::vector<std::uint32_t> left(indices.size());
  const std::size_t count = meshopt_simplify(
      left.data(), indices.data(), indices.size(), &mesh.positions[0].x, mesh.positions.size(),
      sizeof(glm::vec3), std::size_t{3} * triangles, any_error, 0, nullptr);
  left.resize(count);

  Mesh result;
  result.name = mesh.name;
  std::vector<std::uint32_t> renumbered(mesh.positions.size(), none_id);
  for (std::uint32_t& vertex : left) {
    if (renumbered[vertex] == none_id) {
      renumbered[vertex] = static_cast<std::uint32_t>(result.positions.size());
      result.positions.push_back(mesh.positions[vertex]);
    }
    vertex = renumbered[vertex];
  }
  for (std::size_t i = 0; i < left.size(); i += 3) {
    result.triangles.emplace_back(left[i], left[i + 1], left[i + 2]);
  }
  return result;
}

}  // namespace vislab
