// The planes of a view frustum in the frame of a mesh, so that vertices need no transform.
#pragma once

#include <array>
#include <span>

#include "common/geometry/frustum.h"

namespace vislab::frustum_culling {

/// n.p + d >= 0 inside, for points in the mesh's frame; the distance is that in the world (metres).
struct MeshPlane {
  glm::dvec3 normal{0.0};  // not of unit length if the object is scaled
  double d = 0.0;
  double error = 0.0;  // bound on the error of the distance for all points of the mesh's box
};

/// Planes of the frustum for one object: n.(A v + t) + d = (A^T n).v + (n.t + d).
class MeshPlanes {
 public:
  /// `bounds` is the mesh's box, `transform` takes the mesh to the world. Only the planes of `mask`
  /// (bit i for plane i) are taken.
  void set(const Frustum& frustum, unsigned mask, const glm::dmat4x3& transform,
           const Aabb& bounds);

  std::span<const MeshPlane> span() const { return std::span(planes_).first(count_); }

 private:
  std::array<MeshPlane, 6> planes_;
  std::size_t count_ = 0;
};

}  // namespace vislab::frustum_culling
