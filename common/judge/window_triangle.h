// A triangle as it appears in the window: what the rules on disputed samples are made of.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>

#include "common/geometry/camera.h"

namespace vislab {

/// A triangle cut off at the near and the far plane and projected to the window; up to five
/// corners. Everything is double. Both sides count alike.
class WindowTriangle {
 public:
  /// `world` are the corners in the world frame.
  WindowTriangle(const Camera& camera, const Viewport& viewport,
                 const std::array<glm::dvec3, 3>& world);

  /// Nothing of it lies between the near and the far plane.
  bool empty() const { return count_ == 0; }
  /// Distance in pixels from the nearest edge of what is left of the triangle; infinite if empty.
  double edge_distance(const glm::dvec2& window_px) const;
  /// True if the position lies in what is left of the triangle.
  bool contains(const glm::dvec2& window_px) const;
  /// Planar depth, metres, of the triangle's plane there; not finite if it is seen edge-on.
  double depth(const glm::dvec2& window_px) const;

  /// The corners of what is left, window position in pixels, in order round it either way.
  std::span<const glm::dvec2> corners() const {
    return {corners_.data(), static_cast<std::size_t>(count_)};
  }
  /// Box around it in the window, pixels; min > max if empty.
  glm::dvec2 min() const { return min_; }
  glm::dvec2 max() const { return max_; }

 private:
  Lens lens_;
  glm::dvec2 pixel_m_;  // metres on the near plane
  glm::dvec3 normal_;   // of the plane, camera frame, any length
  glm::dvec3 point_;    // in the plane
  std::array<glm::dvec2, 5> corners_;
  int count_ = 0;
  glm::dvec2 min_;
  glm::dvec2 max_;
};

}  // namespace vislab
