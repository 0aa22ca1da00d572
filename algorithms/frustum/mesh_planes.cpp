#include "algorithms/frustum/mesh_planes.h"

namespace vislab::frustum_culling {
void MeshPlanes::set(const Frustum& frustum, unsigned mask, const glm::dmat4x3& transform,
                     const Aabb& bounds) {
  const glm::dvec3 reach =
      glm::max(glm::abs(glm::dvec3(bounds.min)), glm::abs(glm::dvec3(bounds.max)));
  double size = absolute_sum(transform[3]);
  for (int axis = 0; axis < 3; ++axis) size += reach[axis] * absolute_sum(transform[axis]);
  count_ = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(frustum.plane_count); ++i) {
    if ((mask >> i & 1U) == 0) continue;
    const Plane& plane = frustum.planes[i];
    MeshPlane& local = planes_[count_++];
    for (int axis = 0; axis < 3; ++axis) {
      local.normal[axis] = glm::dot(plane.normal, transform[axis]);
    }
    local.d = glm::dot(plane.normal, transform[3]) + plane.d;
    // Twice the error of a point in the world (distance_error): as many roundings again.
    local.error = 32.0 * std::numeric_limits<double>::epsilon() *
                  (size + std::max(std::abs(plane.d), plane.magnitude));
  }
}

}  // namespace vislab::frustum_culling
