#include "algorithms/portal/closing_objects.h"

#include <algorithm>
#include <array>

namespace vislab::portal_culling {
namespace {

/// How far before a cell's boundary what closes it may lie: coordinates are rounded.
constexpr double boundary_slack_m = 1e-3;
/// Cosine of an angle with the boundary that counts as facing away.
constexpr double facing_away = -1e-3;

using Corners = std::array<glm::dvec3, 3>;

bool closes(const Corners& corners, bool both_sides, const ConvexRegion& region) {
  const glm::dvec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  return std::ranges::any_of(region.planes, [&](const Plane& plane) {
    const bool behind = std::ranges::all_of(corners, [&](const glm::dvec3& corner) {
      return plane.signed_distance(corner) <= boundary_slack_m;
    });
    return behind &&
           (both_sides || glm::dot(across, plane.normal) >= facing_away * glm::length(across));
  });
}

bool closes(const Scene& scene, ObjectId object, const Cell& cell) {
  const Mesh& mesh = scene.mesh_of(object);
  const glm::dmat4x3& transform = scene.objects[object].transform;
  return std::ranges::any_of(mesh.triangles, [&](const auto& triangle) {
    Corners corners;
    for (int k = 0; k < 3; ++k) {
      corners[k] = transform * glm::dvec4(glm::dvec3(mesh.positions[triangle[k]]), 1.0);
    }
    if (glm::determinant(glm::dmat3(transform)) < 0.0) std::swap(corners[1], corners[2]);
    return std::ranges::any_of(cell.regions, [&](const ConvexRegion& region) {
      return closes(corners, !mesh.closed, region);
    });
  });
}

}  // namespace

std::vector<std::uint8_t> find_closing_objects(const Scene& scene) {
  std::vector<std::uint8_t> closing(scene.object_count(), 0);
  for (const Cell& cell : scene.cells) {
    for (const ObjectId object : cell.objects) {
      if (closing[object] == 0 && closes(scene, object, cell)) closing[object] = 1;
    }
  }
  return closing;
}

}  // namespace vislab::portal_culling
