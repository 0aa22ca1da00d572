#include "common/raster/window_transform.h"

namespace vislab {

WindowTransform::WindowTransform(const Camera& camera, const Viewport& viewport)
    : camera_(camera),
      viewport_(viewport),
      axes_{camera.pose.right, camera.pose.up, camera.pose.back},
      scale_x_(viewport.width / (camera.lens.right - camera.lens.left)),
      scale_y_(viewport.height / (camera.lens.top - camera.lens.bottom)) {
  const Lens& lens = camera.lens;
  constexpr double steps = 32.0 / 16'777'216.0;
  device_margin_ =
      steps * (perspective() ? 1.0 / lens.near_m - 1.0 / lens.far_m : lens.far_m - lens.near_m);
  world_ = mesh(glm::dmat4x3(1.0));
}

WindowRows WindowTransform::mesh(const glm::dmat4x3& transform) const {
  const Lens& lens = camera_.lens;
  const glm::dvec3 offset = transform[3] - camera_.pose.eye;
  // By column: the camera's frame, then the window's. Plain arrays, which compilers vectorise.
  std::array<std::array<double, 4>, 3> columns, camera;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<int>(axis);
    columns[axis] = {transform[0][at], transform[1][at], transform[2][at], offset[at]};
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const glm::dvec3& to = axes_[axis];
    for (std::size_t i = 0; i < 4; ++i) {
      camera[axis][i] = (to.x * columns[0][i] + to.y * columns[1][i]) + to.z * columns[2][i];
    }
  }
  constexpr std::array<double, 4> constant{0.0, 0.0, 0.0, 1.0};
  WindowRows result;
  const bool has_eye = perspective();
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = camera[0][i], y = camera[1][i], z = camera[2][i];
    if (has_eye) {
      result.x[i] = scale_x_ * (lens.near_m * x + lens.left * z);
      result.y[i] = scale_y_ * (lens.near_m * y + lens.bottom * z);
    } else {
      result.x[i] = scale_x_ * (x - lens.left * constant[i]);
      result.y[i] = scale_y_ * (y - lens.bottom * constant[i]);
    }
    result.depth[i] = -z;
  }
  return result;
}

}  // namespace vislab
