// From the world, or an object's mesh, to the window of a frame, for software rasterisers.
//
// Nearness is what is linear in the window along a plane, so what rasterisers interpolate and
// compare: 1 / planar depth for perspective cameras, in 1/m, and -planar depth for orthographic
// ones, in m. Greater is nearer.
//
// Everything is double, relative to the eye: the eye is subtracted before anything is rounded.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>

#include "common/geometry/camera.h"

namespace vislab {

/// A point before the division by w, which is the depth for perspective cameras and 1 for
/// orthographic ones: the window position is (x / w, y / w) pixels.
struct WindowPoint {
  double x = 0.0;
  double y = 0.0;
  double depth = 0.0;  // planar, metres
};

/// What takes points of a frame of reference to the window: three rows over (x, y, z, 1), to be
/// summed as ((a x + b y) + c z) + d, so that everyone gets the same bits.
struct WindowRows {
  std::array<double, 4> x;
  std::array<double, 4> y;
  std::array<double, 4> depth;

  WindowPoint operator()(const glm::dvec3& p) const {
    const auto row = [&](const std::array<double, 4>& r) {
      return ((r[0] * p.x + r[1] * p.y) + r[2] * p.z) + r[3];
    };
    return {row(x), row(y), row(depth)};
  }
};

class WindowTransform {
 public:
  WindowTransform(const Camera& camera, const Viewport& viewport);

  /// From world positions.
  const WindowRows& world() const { return world_; }
  /// From the mesh's positions of an object with this transform.
  WindowRows mesh(const glm::dmat4x3& transform) const;

  const Camera& camera() const { return camera_; }
  const Viewport& viewport() const { return viewport_; }
  bool perspective() const { return camera_.lens.projection == Projection::perspective; }
  /// Of a planar depth; greater than 0 for perspective cameras.
  double nearness(double depth) const { return perspective() ? 1.0 / depth : -depth; }
  /// The other way.
  double depth(double nearness) const { return perspective() ? 1.0 / nearness : -nearness; }
  /// By how much the nearness of what a graphics device draws may differ from exact arithmetic's:
  /// 32 steps of 2^-24 of the device's depth range, which is linear in nearness.
  double device_margin() const { return device_margin_; }

 private:
  Camera camera_;
  Viewport viewport_;
  std::array<glm::dvec3, 3> axes_;  // of the camera: right, up, back
  double scale_x_, scale_y_;        // pixels by metre on the near plane
  double device_margin_ = 0.0;
  WindowRows world_;
};

}  // namespace vislab
