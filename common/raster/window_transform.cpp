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
  const bool has_eye = perspective();
  WindowRows result;
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 column = i < 3 ? transform[i] : transform[3] - camera_.pose.eye;
    const auto along = [&](const glm::dvec3& axis) {
      return (axis.x * column.x + axis.y * column.y) + axis.z * column.z;
    };
    const double x = along(axes_[0]), y = along(axes_[1]), z = along(axes_[2]);
    const auto at = static_cast<std::size_t>(i);
    if (has_eye) {
      result.x[at] = scale_x_ * (lens.near_m * x + lens.left * z);
      result.y[at] = scale_y_ * (lens.near_m * y + lens.bottom * z);
    } else {
      const double constant = i < 3 ? 0.0 : 1.0;
      result.x[at] = scale_x_ * (x - lens.left * constant);
      result.y[at] = scale_y_ * (y - lens.bottom * constant);
    }
    result.depth[at] = -z;
  }
  return result;
}

}  // namespace vislab
