// View frusta as planes that point inward, and the conservative box and sphere tests on one plane.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

/// Bound on the error of n.p + d in double for a point with float coordinates: the plane's own
/// rounding (normal and d each carry a few ulp from the camera) and seven operations. Each part of
/// the unit normal may be off by a few ulp of 1, however small it is itself: p counts in full.
inline double distance_error(const Plane& plane, const glm::dvec3& p) {
  const double magnitude =
      std::abs(p.x) + std::abs(p.y) + std::abs(p.z) + std::max(std::abs(plane.d), plane.magnitude);
  return 16.0 * std::numeric_limits<double>::epsilon() * magnitude;
}

/// The corner of the box that lies farthest along the normal; the greater coordinate where a part
/// of the normal is 0.
inline glm::dvec3 p_vertex(const Plane& plane, const Aabb& box) {
  return {plane.normal.x >= 0.0 ? box.max.x : box.min.x,
          plane.normal.y >= 0.0 ? box.max.y : box.min.y,
          plane.normal.z >= 0.0 ? box.max.z : box.min.z};
}

/// The corner opposite to the p-vertex.
inline glm::dvec3 n_vertex(const Plane& plane, const Aabb& box) {
  return {plane.normal.x >= 0.0 ? box.min.x : box.max.x,
          plane.normal.y >= 0.0 ? box.min.y : box.max.y,
          plane.normal.z >= 0.0 ? box.min.z : box.max.z};
}

/// True only if every point of the box lies outside the plane, even under rounding: the p-vertex is
/// behind the plane by more than the error of its distance. A box that is not valid is never
/// outside. The sign is asked first, so that most boxes that are kept cost one distance.
/// Source: Assarsson and Moeller 2000 (lecture slides 37-38, with normals that point inward, so
/// that "outside" asks the p-vertex).
inline bool surely_outside(const Plane& plane, const Aabb& box) {
  const glm::dvec3 p = p_vertex(plane, box);
  const double distance = plane.signed_distance(p);
  // Written so that NaN bounds answer false: nothing is concluded from a broken box.
  return distance < 0.0 && distance < -distance_error(plane, p) && box.valid();
}

/// True only if every point of the box lies inside the plane: the n-vertex decides.
inline bool surely_inside(const Plane& plane, const Aabb& box) {
  const glm::dvec3 n = n_vertex(plane, box);
  const double distance = plane.signed_distance(n);
  return distance > 0.0 && distance > distance_error(plane, n) && box.valid();
}

/// True only if the whole sphere lies outside (inside) the plane, even under rounding. A sphere
/// whose radius is negative or not a number is neither.
bool surely_outside(const Plane& plane, const Sphere& sphere);
bool surely_inside(const Plane& plane, const Sphere& sphere);

/// Planes through three corners each, as gluPerspective and gluLookAt suggest: the window's corners
/// at the distance f are eye + f view +- half height * up +- half width * right. Also for lenses
/// that are off-centre, orthographic or without a far plane. Equal to frustum_of but for rounding,
/// which is larger far from the origin and not bounded by "surely" below. Source: Zachmann,
/// Computer-Graphik 2, SS 2012, slide 34.
Frustum frustum_by_corners(const Camera& camera);

/// True if the box comes as near to the eye as the near plane's farthest corner does: the box may
/// then be cut by the near plane or hold the eye, and nothing may be concluded from its faces.
/// For an orthographic camera: the box reaches in front of the near plane.
bool touches_near_region(const Camera& camera, const Aabb& box);

}  // namespace vislab
