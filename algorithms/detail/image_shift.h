// How far the camera's own motion moves a point in the image, from one frame to the next: what
// "speed of the camera" means for a thing that is looked at. Turning moves all of the image alike,
// walking moves what is near more than what is far.
#pragma once

#include <optional>

#include "common/geometry/camera.h"

namespace vislab::detail_culling {

/// The two latest frames of a path. Frames are told apart by their index.
class ImageShift {
 public:
  void forget();
  /// To be called once a frame.
  void advance(const Camera& camera, const Viewport& viewport);

  /// Has the camera moved at all? False if there was no frame before.
  bool moving() const;
  /// Pixels in the latest frame's image, of a point at rest; 0 if the camera stands still, infinity
  /// if the point lies before either near plane.
  double of(const glm::dvec3& world) const;

 private:
  std::optional<Camera> before_, now_;
  Viewport viewport_;
};

}  // namespace vislab::detail_culling
