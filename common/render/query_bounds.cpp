#include "common/render/query_bounds.h"

#include <algorithm>
#include <cmath>

namespace vislab {
namespace {

constexpr double margin_pixels = 1.0 / 32.0;
constexpr double margin_depth = 32.0 * 0x1p-24;

float outward(double value, float direction) {
  const float rounded = static_cast<float>(value);
  return std::nextafter(rounded, direction);
}

}  // namespace

Aabb enlarged_for_query(const Camera& camera, const Viewport& viewport, const Aabb& box) {
  if (!box.valid()) return box;
  const auto& [eye, right, up, back] = camera.pose;
  const Lens& lens = camera.lens;

  // The planar depth is linear, so its largest value is at the corner farthest along the view.
  double farthest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    farthest += std::max(back[axis] * (eye[axis] - box.min[axis]),
                         back[axis] * (eye[axis] - box.max[axis]));
  }
  farthest = std::clamp(farthest, lens.near_m, lens.far_m);

  double pixel = std::max((lens.right - lens.left) / viewport.width,
                          (lens.top - lens.bottom) / viewport.height);
  if (lens.projection == Projection::perspective) pixel *= farthest / lens.near_m;
  const double sideways = margin_pixels * pixel;
  glm::dvec3 low = glm::dvec3(box.min) - sideways;
  glm::dvec3 high = glm::dvec3(box.max) + sideways;

  if (lens.projection == Projection::perspective) {
    // depth = far (z - near) / (z (far - near)): its derivative is near / z^2 times far / (far -
    // near).
    const double range = std::isinf(lens.far_m) ? 1.0 : (lens.far_m - lens.near_m) / lens.far_m;
    const double fraction = std::min(1.0, margin_depth * farthest * range / lens.near_m);
    low -= glm::max(low - eye, 0.0) * fraction;
    high += glm::max(eye - high, 0.0) * fraction;
  } else {
    const glm::dvec3 nearer = back * (margin_depth * (lens.far_m - lens.near_m));
    low += glm::min(nearer, 0.0);
    high += glm::max(nearer, 0.0);
  }

  Aabb result;
  for (int axis = 0; axis < 3; ++axis) {
    result.min[axis] = outward(low[axis], -std::numeric_limits<float>::infinity());
    result.max[axis] = outward(high[axis], std::numeric_limits<float>::infinity());
  }
  return result;
}

}  // namespace vislab
