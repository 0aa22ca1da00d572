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
  // By coordinate, so that compilers make vectors of the columns.
  std::array<double, 4> column_x, column_y, column_z, x, y, z;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto at = static_cast<int>(i);
    column_x[i] = transform[at].x;
    column_y[i] = transform[at].y;
    column_z[i] = transform[at].z;
  }
  column_x[3] -= camera_.pose.eye.x;
  column_y[3] -= camera_.pose.eye.y;
  column_z[3] -= camera_.pose.eye.z;
  const auto along = [&](const glm::dvec3& axis, std::array<double, 4>& out) {
    for (std::size_t i = 0; i < 4; ++i) {
      out[i] = (axis.x * column_x[i] + axis.y * column_y[i]) + axis.z * column_z[i];
    }
  };
  along(axes_[0], x);
  along(axes_[1], y);
  along(axes_[2], z);
  WindowRows result;
  if (perspective()) {
    for (std::size_t i = 0; i < 4; ++i) {
      result.x[i] = scale_x_ * (lens.near_m * x[i] + lens.left * z[i]);
      result.y[i] = scale_y_ * (lens.near_m * y[i] + lens.bottom * z[i]);
    }
  } else {
    for (std::size_t i = 0; i < 4; ++i) {
      const double constant = i < 3 ? 0.0 : 1.0;
      result.x[i] = scale_x_ * (x[i] - lens.left * constant);
      result.y[i] = scale_y_ * (y[i] - lens.bottom * constant);
    }
  }
  for (std::size_t i = 0; i < 4; ++i) result.depth[i] = -z[i];
  return result;
}

}  // namespace vislab
