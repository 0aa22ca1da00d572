#include "algorithms/frustum/meta_volumes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vislab::frustum_culling {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

}  // namespace

MetaVolumes::MetaVolumes(const Camera& camera) {
  const auto& [eye, right, up, back] = camera.pose;
  const Lens& lens = camera.lens;
  if (!std::isfinite(lens.far_m)) return;
  bounded_ = true;
  const bool perspective = lens.projection == Projection::perspective;
  // Corners of the windows on the near and the far plane, from the eye: near 0 to 3, far 4 to 7.
  std::array<glm::dvec3, 8> ways;
  double magnitude = absolute_sum(eye);
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const double distance = i < 4 ? lens.near_m : lens.far_m;
    const double scale = perspective ? distance / lens.near_m : 1.0;
    const double x = scale * ((i & 1U) != 0 ? lens.right : lens.left);
    const double y = scale * ((i & 2U) != 0 ? lens.top : lens.bottom);
    ways[i] = right * x + up * y - back * distance;
    magnitude =
        std::max(magnitude, absolute_sum(eye) + std::abs(x) + std::abs(y) + std::abs(distance));
  }
  const double error = 64.0 * epsilon * magnitude;

  low_ = high_ = ways[0];
  for (const glm::dvec3& way : ways) {
    low_ = glm::min(low_, way);
    high_ = glm::max(high_, way);
  }
  low_ += eye - error;
  high_ += eye + error;

  // The centre on the line between the windows' centres, from which the farthest corners of both
  // windows are equally far; at most on the far window (wide lenses).
  const glm::dvec3 near_center = (ways[0] + ways[3]) * 0.5;
  const glm::dvec3 far_center = (ways[4] + ways[7]) * 0.5;
  const double near_half = glm::length(ways[3] - near_center);
  const double far_half = glm::length(ways[7] - far_center);
  const double length = glm::length(far_center - near_center);
  const double share =
      0.5 + (far_half * far_half - near_half * near_half) / (2.0 * length * length);
  const glm::dvec3 center = near_center + (far_center - near_center) * std::clamp(share, 0.0, 1.0);
  double radius = 0.0;
  for (const glm::dvec3& way : ways) radius = std::max(radius, glm::length(way - center));
  center_ = eye + center;
  radius = (radius + error) * (1.0 + 1e-12);
  radius_squared_ = radius * radius;
}

}  // namespace vislab::frustum_culling
