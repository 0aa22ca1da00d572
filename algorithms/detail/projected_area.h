// How much of the image plane a sphere or a box covers, in pixels.
//
// Idea: seen in perspective a sphere is an ellipse whose area has a closed form. A convex body's
//   surface is met twice by each line of sight that meets it, so the body covers half of what its
//   faces cover in sum.
// Guarantee: exact but for rounding (some 1e-12 of the area, for what is not thousands of times
//   its own size from the world's origin). The area is that of the whole body in the endless plane
//   of the image, not cut by the image's borders. It is then never less than what any part of the
//   body covers of the image, and does not jump where a body enters or leaves the image.
// Cost: about 20 operations for a sphere, about 150 for a box; more for one that the near plane
//   cuts.
// Limits: what the near plane cuts of a sphere has no simple form; such a sphere counts as endless.
// Sources: of the ellipse: own derivation from the tangent cone, see projected_area.cpp; the
//   lecture's estimate is Zachmann, Computer-Graphik 2, SS 2012, slide 91.
#pragma once

#include "common/geometry/bounds.h"
#include "common/geometry/camera.h"

namespace vislab::detail_culling {

/// A camera with its image, made ready for areas. Made once a frame.
class ProjectedArea {
 public:
  ProjectedArea(const Camera& camera, const Viewport& viewport);

  /// Pixels; infinity if the sphere reaches through the near plane, or holds the eye, or has a
  /// radius that is negative or not a number.
  double of(const Sphere& sphere) const;

  /// Pixels, of the part of the box that lies behind the near plane as seen from the eye; 0 if
  /// there is none. Infinity if the box is not valid.
  double of(const Aabb& box) const;

  /// The lecture's estimate, pi (r n / d)^2, in square metres on the near plane; n is the near
  /// plane's distance, d that of the sphere's centre along the view. Infinity where d <= 0. For
  /// perspective only: of an orthographic camera pi r^2.
  double printed_m2(const Sphere& sphere) const;

  /// Pixels in a square metre of the near plane.
  double pixels_of_near_m2() const;

 private:
  glm::dvec3 in_camera(const glm::dvec3& world) const;  // x right, y up, z along the view
  double of_cut_box(const glm::dvec3 (&corners)[8]) const;

  Pose pose_;
  bool perspective_;
  double near_m_;
  glm::dvec2 scale_;  // pixels of a metre at depth 1, or anywhere if orthographic
};

}  // namespace vislab::detail_culling
