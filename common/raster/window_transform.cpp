#include "common/raster/window_transform.h"

namespace vislab {

WindowTransform::WindowTransform(const Camera& camera, const Viewport& viewport)
    : camera_(camera), viewport_(viewport) {
  const Lens& lens = camera.lens;
  constexpr double steps = 32.0 / 16'777'216.0;
  device_margin_ =
      steps * (perspective() ? 1.0 / lens.near_m - 1.0 / lens.far_m : lens.far_m - lens.near_m);
  world_ = mesh(glm::dmat4x3(1.0));
}

WindowRows WindowTransform::mesh(const glm::dmat4x3& transform) const {
  const Pose& pose = camera_.pose;
  const glm::dmat3 to_camera = glm::transpose(glm::dmat3(pose.right, pose.up, pose.back));
  return rows(to_camera * glm::dmat3(transform), to_camera * (transform[3] - pose.eye));
}

WindowRows WindowTransform::rows(const glm::dmat3& linear, const glm::dvec3& offset) const {
  const Lens& lens = camera_.lens;
  const double scale_x = viewport_.width / (lens.right - lens.left);
  const double scale_y = viewport_.height / (lens.top - lens.bottom);
  WindowRows result;
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 column = i < 3 ? linear[i] : offset;
    const double constant = i < 3 ? 0.0 : 1.0;
    const auto at = static_cast<std::size_t>(i);
    if (perspective()) {
      result.x[at] = scale_x * (lens.near_m * column.x + lens.left * column.z);
      result.y[at] = scale_y * (lens.near_m * column.y + lens.bottom * column.z);
    } else {
      result.x[at] = scale_x * (column.x - lens.left * constant);
      result.y[at] = scale_y * (column.y - lens.bottom * constant);
    }
    result.depth[at] = -column.z;
  }
  return result;
}

}  // namespace vislab
