#include "common/scene/used_positions.h"

namespace vislab {

std::vector<glm::vec3> used_positions(const Mesh& mesh) {
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  for (const glm::uvec3& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) used[triangle[corner]] = 1;
  }
  std::vector<glm::vec3> points;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] != 0) points.push_back(mesh.positions[i]);
  }
  return points;
}

}  // namespace vislab
