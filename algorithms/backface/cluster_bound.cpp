#include "algorithms/backface/cluster_bound.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "algorithms/backface/magnitudes.h"
#include "algorithms/backface/triangle_clusters.h"
#include "common/geometry/rounding.h"

namespace vislab::backface_culling {
namespace {

constexpr double float_epsilon = std::numeric_limits<float>::epsilon();

/// What floats can tell of, in units of the mesh: far from where sums would overflow.
constexpr double farthest = 1e30;

/// Bound on the error of n.p + d, where p is at most as far from the mesh's middle as `reach` along
/// each axis: of the plane, and of the three products and sums in double.
double value_error(const MeshFrame& frame, double reach) {
  return 1.01 * plane_error * (frame.size + 3.0 * reach);
}

/// Least n_i.(p_i - c).
double least_offset(std::span<const glm::dvec4> planes, const glm::dvec3& c) {
  double least = std::numeric_limits<double>::infinity();
  for (const glm::dvec4& plane : planes) {
    least = std::min(least, -(glm::dot(glm::dvec3(plane), c) + plane.w));
  }
  return least;
}

glm::vec3 best_origin(std::span<const glm::dvec4> planes, const Aabb& box, double unit) {
  glm::vec3 best(box.center() / unit);
  double greatest = least_offset(planes, glm::dvec3(best) * unit);
  for (unsigned corner = 0; corner < 8; ++corner) {
    const glm::dvec3 place((corner & 1U) != 0 ? box.max.x : box.min.x,
                           (corner & 2U) != 0 ? box.max.y : box.min.y,
                           (corner & 4U) != 0 ? box.max.z : box.min.z);
    const glm::vec3 c(place / unit);
    const double offset = least_offset(planes, glm::dvec3(c) * unit);
    if (offset > greatest) {
      greatest = offset;
      best = c;
    }
  }
  return best;
}

}  // namespace

ClusterBound bound_of(std::span<const glm::dvec4> planes, const Aabb& box, const MeshFrame& frame,
                      Origin origin) {
  ClusterBound bound;
  if (planes.empty()) return bound;
  const double unit = frame.unit();
  switch (origin) {
    case Origin::mesh:
      bound.origin = glm::vec3(-frame.middle / unit);
      break;
    case Origin::centre:
      bound.origin = glm::vec3(box.center() / unit);
      break;
    case Origin::best:
      bound.origin = best_origin(planes, box, unit);
      break;
  }
  if (!(largest(glm::dvec3(bound.origin)) < farthest)) return {};
  const glm::dvec3 c = glm::dvec3(bound.origin) * unit;
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high = -low;
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  for (const glm::dvec4& plane : planes) {
    const glm::dvec3 normal(plane);
    low = glm::min(low, normal);
    high = glm::max(high, normal);
    const double offset = -(glm::dot(normal, c) + plane.w);
    least = std::min(least, offset);
    greatest = std::max(greatest, offset);
  }
  for (int axis = 0; axis < 3; ++axis) {
    bound.low[axis] = round_down(low[axis] - plane_error);
    bound.high[axis] = round_up(high[axis] + plane_error);
  }
  const double error = value_error(frame, largest(c));
  bound.back = round_down((least - error) / unit);
  bound.front = round_up((greatest + error) / unit);
  return bound;
}

ClusterEye cluster_eye(const MeshEye& eye, const MeshFrame& frame, double reach) {
  ClusterEye result;
  result.perspective = eye.position.w != 0.0;
  // Of a direction only its signs and ratios matter.
  const double unit = result.perspective ? frame.unit() : power_of_two_from(eye.magnitude());
  const double magnitude = eye.magnitude() / unit;
  const double error = eye.error / unit;
  // With X = |eye| + |c|: e - c is off by at most an epsilon times X and the eye's own error, along
  // each of three axes, of which a unit normal sees 1.74; three products, three sums and d take at
  // most 5.5 X + |d| half epsilons more, and |d| is below 2 (size + |c|).
  const double distance = magnitude + (result.perspective ? reach + frame.size / unit : 0.0);
  if (!(distance < farthest) || !(error < farthest)) {
    result.limit = std::numeric_limits<float>::infinity();
    return result;
  }
  result.position = glm::vec3(glm::dvec3(eye.position) / unit);
  // What falls below the smallest float is far less than the limit.
  result.limit = static_cast<float>((12.0 * float_epsilon * distance + 2.0 * error) * (1.0 + 1e-6));
  return result;
}

ClusterFacing facing_of(const ClusterBound& bound, const ClusterEye& eye) {
  const glm::vec3 way = eye.perspective ? eye.position - bound.origin : eye.position;
  const glm::vec3 most(way.x > 0.0F ? bound.high.x : bound.low.x,
                       way.y > 0.0F ? bound.high.y : bound.low.y,
                       way.z > 0.0F ? bound.high.z : bound.low.z);
  const glm::vec3 least(way.x > 0.0F ? bound.low.x : bound.high.x,
                        way.y > 0.0F ? bound.low.y : bound.high.y,
                        way.z > 0.0F ? bound.low.z : bound.high.z);
  float most_value = (most.x * way.x + most.y * way.y) + most.z * way.z;
  float least_value = (least.x * way.x + least.y * way.y) + least.z * way.z;
  if (eye.perspective) {
    most_value -= bound.back;
    least_value -= bound.front;
  }
  if (most_value < -eye.limit) return ClusterFacing::back;
  if (least_value > eye.limit) return ClusterFacing::front;
  return ClusterFacing::mixed;
}

}  // namespace vislab::backface_culling
