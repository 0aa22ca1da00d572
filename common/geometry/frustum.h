// View frusta as planes that point inward, and the conservative box and sphere tests on one plane.
#pragma once

#include <array>
#include <span>

#include "common/geometry/bounds.h"
#include "common/geometry/camera.h"

namespace vislab {

/// The region a camera sees, world frame. Unit normals point inward. With an infinite far distance
/// there is no far plane, and `plane_count` is 5.
struct Frustum {
  enum PlaneIndex { left, right, bottom, top, near, far };

  std::array<Plane, 6> planes;
  int plane_count = 6;

  std::span<const Plane> span() const {
    return {planes.data(), static_cast<std::size_t>(plane_count)};
  }
};

/// Frustum of a camera, from its pose and lens.
Frustum frustum_of(const Camera& camera);

/// Frustum from a clip matrix (world to OpenGL clip space), after Gribb and Hartmann (2001). A far
/// plane at infinity is recognised by its vanishing normal and left out. The matrix is taken as
/// exact: what was rounded when it was made (a far eye's coordinates cancel in its last column) is
/// not known here, so "surely" below is sure only for planes of frustum_of.
Frustum frustum_from_matrix(const glm::dmat4& clip);

/// True only if every point of the box lies outside the plane, even under rounding: the p-vertex
/// (the corner farthest along the normal) is behind the plane by more than the error of its
/// distance. A box that is not valid is never outside.
/// Source: Assarsson and Moeller 2000 (lecture slides 37-38, with normals that point inward, so
/// that "outside" asks the p-vertex).
bool surely_outside(const Plane& plane, const Aabb& box);

/// True only if every point of the box lies inside the plane: the n-vertex decides.
bool surely_inside(const Plane& plane, const Aabb& box);

/// True only if the whole sphere lies outside the plane, even under rounding.
bool surely_outside(const Plane& plane, const Sphere& sphere);

/// True if the box comes as near to the eye as the near plane's farthest corner does: the box may
/// then be cut by the near plane or hold the eye, and nothing may be concluded from its faces.
/// For an orthographic camera: the box reaches in front of the near plane.
bool touches_near_region(const Camera& camera, const Aabb& box);

}  // namespace vislab
