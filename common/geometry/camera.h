// Cameras: a pose in the world and a lens. World frame: right-handed, y up, metres.
// The camera looks along the negative z axis of its own frame. Everything is double, because eye
// positions are subtracted from world positions before anything is rounded to float.
#pragma once

#include <glm/glm.hpp>

namespace vislab {

/// Size of the image in pixels. Pixel (0, 0) is the lower left one, as in OpenGL; the centre of
/// pixel (x, y) is at window position (x + 0.5, y + 0.5).
struct Viewport {
  int width = 512;
  int height = 512;

  double aspect() const { return static_cast<double>(width) / height; }
  friend bool operator==(const Viewport&, const Viewport&) = default;
};

/// Position and orthonormal axes of a camera, world frame. The camera looks along -back.
struct Pose {
  glm::dvec3 eye{0.0, 0.0, 0.0};
  glm::dvec3 right{1.0, 0.0, 0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  glm::dvec3 back{0.0, 0.0, 1.0};

  friend bool operator==(const Pose&, const Pose&) = default;
};

/// Pose at `eye` that looks at `target`, with `up` as near to the image's vertical as it can be.
/// `target` must differ from `eye`; an `up` along the view is replaced by another axis.
Pose look_at(const glm::dvec3& eye, const glm::dvec3& target,
             const glm::dvec3& up = {0.0, 1.0, 0.0});

enum class Projection { perspective, orthographic };

/// The image window and the depth range, in the camera's frame. left, right, bottom and top are
/// metres on the near plane; a window that is not centred gives an off-centre frustum.
/// Distances are planar (along the view), near_m < far_m. A perspective lens has near_m > 0 and
/// may have far_m = infinity.
struct Lens {
  Projection projection = Projection::perspective;
  double left = -1.0, right = 1.0, bottom = -1.0, top = 1.0;
  double near_m = 0.1, far_m = 1000.0;

  friend bool operator==(const Lens&, const Lens&) = default;
};

/// Centred perspective lens; `fov_y_rad` is the full vertical angle in radians, in (0, pi).
Lens perspective_lens(double fov_y_rad, double aspect, double near_m, double far_m);

/// Centred orthographic lens whose image is `height_m` high.
Lens orthographic_lens(double height_m, double aspect, double near_m, double far_m);

/// Ray in the world frame. `direction` has length 1 along the view, so that the parameter t of a
/// point origin + t * direction is its planar depth: the near plane is at t = near_m everywhere.
struct Ray {
  glm::dvec3 origin;
  glm::dvec3 direction;
};

struct Camera {
  Pose pose;
  Lens lens;

  /// World to camera frame.
  glm::dmat4 view() const;
  /// Camera frame to OpenGL clip space (-w <= z <= w).
  glm::dmat4 projection() const;
  glm::dmat4 view_projection() const { return projection() * view(); }

  /// Ray through window position `window` in [0, 1]^2; (0, 0) is the lower left corner of the
  /// image.
  Ray ray(const glm::dvec2& window) const;

  /// Planar depth of a world point: its distance from the eye along the view.
  double planar_depth(const glm::dvec3& world) const {
    return glm::dot(pose.eye - world, pose.back);
  }

  friend bool operator==(const Camera&, const Camera&) = default;
};

}  // namespace vislab
