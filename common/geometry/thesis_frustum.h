// The view frustum by the equations of the thesis, right and as printed.
#pragma once

#include <array>

#include "common/geometry/frustum.h"

namespace vislab {

/// A camera as the thesis describes it, world frame, metres.
struct ThesisCamera {
  glm::dvec3 eye{0.0, 0.0, 5.0};
  glm::dvec3 reference{0.0};  // the point that is looked at
  glm::dvec3 up{0.0, 1.0, 0.0};
  double angle_deg = 45.0;  // full vertical angle of view, degrees
  double aspect = 1.0;      // width by height
  double near_m = 0.1;
  double far_m = 10.0;
};

/// What the printed equations and figures get wrong. Each alone.
struct ThesisErrors {
  /// The tangent is taken of the number of degrees as if it were radians: the printed half width at
  /// a distance of 10 for 45 degrees is 5.579 instead of 4.142; for 60 degrees it is negative.
  bool angle_in_degrees = false;
  /// Equation 4.1 multiplies reference - eye by the distance without making it a unit vector.
  bool direction_not_normalised = false;
  /// Equation 4.4 does not normalise right = up x (eye - reference), and equation 4.3 takes up as
  /// it is given, which skews the frustum of a camera that looks up or down.
  bool up_as_given = false;
};

struct ThesisFrustum {
  enum Corner {
    near_top_left,
    near_top_right,
    near_bottom_left,
    near_bottom_right,
    far_top_left,
    far_top_right,
    far_bottom_left,
    far_bottom_right
  };

  std::array<glm::dvec3, 8> corners;
  Frustum frustum;
};

/// Corners by the equations 4.1 to 4.4; near and far planes by 4.5 and 4.6; side planes through the
/// eye and two far corners each, by algorithm 1. Without errors equal to frustum_of() but for
/// rounding. The frustum is "sure" in the sense of frustum.h for the planes that came out only, not
/// for the camera.
/// `up` must not be along the view.
/// Source: Kowalka 2016, 4.2.1.
ThesisFrustum thesis_frustum(const ThesisCamera& camera, const ThesisErrors& errors = {});

}  // namespace vislab
