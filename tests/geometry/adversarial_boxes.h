// Cameras and boxes that are hard for frustum tests: boxes that touch planes, edges and corners to
// the ulp, huge, tiny, thin and flat ones, far from the origin. The same for the same seed
// everywhere.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "common/geometry/bounds.h"
#include "common/geometry/camera.h"
#include "common/geometry/frustum.h"
#include "common/geometry/oriented_box.h"
#include "common/geometry/random.h"

namespace vislab::test {

/// Uniform in the exponent, for 0 < low < high.
inline double log_uniform(Random& random, double low, double high) {
  return std::exp(random.uniform(std::log(low), std::log(high)));
}

inline glm::dvec3 random_vector(Random& random, double reach) {
  const double x = random.uniform(-reach, reach);
  const double y = random.uniform(-reach, reach);
  return {x, y, random.uniform(-reach, reach)};
}

/// A random camera: perspective, off-centre, orthographic or without a far plane, narrow or wide,
/// with its eye at the origin or up to 1e8 m from it, and axes that are sometimes the world's.
inline Camera adversarial_camera(Random& random) {
  Camera camera;
  const glm::dvec3 eye =
      random.below(4) == 0 ? glm::dvec3(0.0) : random_vector(random, log_uniform(random, 1.0, 1e8));
  const glm::dvec3 view = random_vector(random, 1.0);
  const bool at_origin = random.below(4) == 0;
  if (at_origin) {
    camera.pose = look_at(eye + view, view * 0.1, random_vector(random, 1.0));
  } else if (random.below(8) == 0) {
    camera.pose.eye = eye;
  } else {
    // As far as the eye: what is near to it would leave no digits for the direction.
    const double reach = std::max({1.0, std::abs(eye.x), std::abs(eye.y), std::abs(eye.z)});
    const glm::dvec3 up = random.below(4) == 0 ? random_vector(random, 1.0) : glm::dvec3(0, 1, 0);
    camera.pose = look_at(eye, eye + view * reach, up);
  }
  const double near = log_uniform(random, 1e-3, 10.0);
  double far = near * log_uniform(random, 1.5, 1e6);
  if (at_origin) far = std::max(far, 2.0 * glm::length(camera.pose.eye));
  const double aspect = log_uniform(random, 0.3, 3.0);
  const double fov =
      random.below(4) == 0 ? log_uniform(random, 1e-3, 0.1) : random.uniform(0.1, 3.05);
  switch (random.below(5)) {
    case 0:
      camera.lens = orthographic_lens(log_uniform(random, 0.1, 1e4), aspect, near, far);
      break;
    case 1:
      camera.lens = orthographic_lens(log_uniform(random, 0.1, 1e4), aspect, -far, far);
      camera.lens.right *= random.uniform(-0.9, 3.0);
      camera.lens.bottom *= random.uniform(-0.9, 3.0);
      break;
    case 2:
      camera.lens = perspective_lens(fov, aspect, near, std::numeric_limits<double>::infinity());
      break;
    case 3:
      camera.lens = perspective_lens(fov, aspect, near, far);
      camera.lens.left *= random.uniform(-0.9, 2.0);
      camera.lens.top *= random.uniform(-0.9, 2.0);
      break;
    default:
      camera.lens = perspective_lens(fov, aspect, near, far);
  }
  // A plane through the middle of the view passes the origin: its d is a small rest of large terms.
  if (at_origin && random.below(2) == 0) camera.lens.left = 0.0;
  if (at_origin && random.below(2) == 0) camera.lens.bottom = 0.0;
  if (camera.lens.right <= camera.lens.left) camera.lens.right = camera.lens.left + near;
  if (camera.lens.top <= camera.lens.bottom) camera.lens.top = camera.lens.bottom + near;
  return camera;
}

/// A coordinate as float, at most a few ulp off; always finite.
inline float nudged(Random& random, double value) {
  constexpr double greatest = 1e38;
  auto result = static_cast<float>(std::clamp(value, -greatest, greatest));
  const std::uint64_t steps = random.below(4);
  const float to = random.below(2) == 0 ? -3e38F : 3e38F;
  for (std::uint64_t i = 0; i < steps; ++i) result = std::nextafter(result, to);
  return result;
}

/// A point of the frustum's boundary at the position (x, y) of the window, in [-1, 1]^2, and a
/// depth in metres.
inline glm::dvec3 frustum_point(const Camera& camera, double x, double y, double depth) {
  const Ray ray = camera.ray(glm::dvec2(x, y) * 0.5 + 0.5);
  return ray.origin + ray.direction * depth;
}

/// A random valid box that is hard for the frustum of this camera.
inline Aabb adversarial_box(Random& random, const Camera& camera) {
  const Lens& lens = camera.lens;
  const double far = std::isfinite(lens.far_m) ? lens.far_m : 1e6 * lens.near_m;
  // Where on the frustum: in the middle, on sides, edges and corners.
  const auto coordinate = [&] {
    const std::uint64_t choice = random.below(4);
    return choice == 0 ? -1.0 : choice == 1 ? 1.0 : random.uniform(-1.0, 1.0);
  };
  const double x = coordinate();
  const double y = coordinate();
  const std::uint64_t depth_choice = random.below(6);
  const double of_origin = camera.planar_depth(glm::dvec3(0.0));
  const double depth = depth_choice == 0   ? lens.near_m
                       : depth_choice == 1 ? far
                       : depth_choice == 2 && of_origin > lens.near_m && of_origin < far ? of_origin
                       : lens.near_m > 0.0 ? log_uniform(random, lens.near_m, far)
                                           : random.uniform(lens.near_m, far);
  glm::dvec3 anchor = frustum_point(camera, x, y, depth);

  const double scale = std::max(glm::distance(anchor, camera.pose.eye), 1e-3);
  double size = scale * log_uniform(random, 1e-3, 3.0);
  switch (random.below(12)) {
    case 0:
      size = scale * log_uniform(random, 3.0, 1e6);
      break;
    case 1:
      size = log_uniform(random, 1e4, 1e37);
      break;
    case 2:
      size = scale * log_uniform(random, 1e-12, 1e-3);
      break;
    default:
      break;
  }
  glm::dvec3 extent = glm::dvec3(size) * (1.0 + random_vector(random, 0.9));
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint64_t choice = random.below(10);
    if (choice == 0) extent[axis] = 0.0;
    if (choice == 1) extent[axis] *= log_uniform(random, 1e-8, 1e-1);
    if (choice == 2) extent[axis] *= log_uniform(random, 10.0, 1e4);
  }

  glm::dvec3 low = anchor;
  glm::dvec3 high = anchor;
  switch (random.below(8)) {
    case 0:  // anywhere near
      anchor += random_vector(random, 2.0 * size);
      low = anchor - extent * 0.5;
      high = anchor + extent * 0.5;
      break;
    case 1: {  // far from everything
      const glm::dvec3 away = random_vector(random, log_uniform(random, 1.0, 1e8));
      low = away - extent * 0.5;
      high = away + extent * 0.5;
      break;
    }
    case 2:
    case 3: {  // the p- or the n-vertex of a plane touches the frustum there
      const Frustum frustum = frustum_of(camera);
      const Plane& plane =
          frustum.planes[random.below(static_cast<std::uint64_t>(frustum.plane_count))];
      const double sign = random.below(3) == 0 ? -1.0 : 1.0;
      for (int axis = 0; axis < 3; ++axis) {
        (sign * plane.normal[axis] >= 0.0 ? low : high)[axis] +=
            sign * plane.normal[axis] >= 0.0 ? -extent[axis] : extent[axis];
      }
      break;
    }
    case 4:
    case 5: {  // one of the box's edges passes through the point
      const auto along = static_cast<int>(random.below(3));
      for (int axis = 0; axis < 3; ++axis) {
        if (axis == along) {
          const double share = random.uniform();
          low[axis] -= extent[axis] * share;
          high[axis] += extent[axis] * (1.0 - share);
        } else if (random.below(2) == 0) {
          low[axis] -= extent[axis];
        } else {
          high[axis] += extent[axis];
        }
      }
      break;
    }
    case 6: {  // one of the box's faces does
      const auto across = static_cast<int>(random.below(3));
      for (int axis = 0; axis < 3; ++axis) {
        const double share =
            axis == across ? static_cast<double>(random.below(2)) : random.uniform();
        low[axis] -= extent[axis] * share;
        high[axis] += extent[axis] * (1.0 - share);
      }
      break;
    }
    default:  // one of the box's corners does
      for (int axis = 0; axis < 3; ++axis) {
        if (random.below(2) == 0) {
          low[axis] -= extent[axis];
        } else {
          high[axis] += extent[axis];
        }
      }
  }
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    const float a = nudged(random, low[axis]);
    // Flat boxes stay flat.
    const float b = extent[axis] == 0.0 ? a : nudged(random, high[axis]);
    box.min[axis] = std::min(a, b);
    box.max[axis] = std::max(a, b);
  }
  return box;
}

/// The camera moved so that the box touches its frustum as nearly as double allows, from outside of
/// a plane, from inside or beyond an edge; unmoved where that is billions of metres away.
inline Camera touching_camera(Random& random, Camera camera, const Aabb& box) {
  const Pose& pose = camera.pose;
  const Lens& lens = camera.lens;
  const double far = std::isfinite(lens.far_m) ? lens.far_m : 1e6 * lens.near_m;
  const Frustum frustum = frustum_of(camera);
  const Plane& plane =
      frustum.planes[random.below(static_cast<std::uint64_t>(frustum.plane_count))];
  glm::dvec3 away = -plane.normal;  // from the frustum to the box
  double gap = 0.0;
  const std::uint64_t choice = random.below(3);
  if (choice == 0) {
    gap = -plane.signed_distance(p_vertex(plane, box));
  } else if (choice == 1) {
    gap = -plane.signed_distance(n_vertex(plane, box));
  } else {
    const double x = random.below(2) == 0 ? -1.0 : 1.0;
    const double y = random.below(2) == 0 ? -1.0 : 1.0;
    const std::array<glm::dvec3, 3> edges{
        pose.right, pose.up,
        frustum_point(camera, x, y, lens.near_m + 1.0) - frustum_point(camera, x, y, lens.near_m)};
    glm::dvec3 box_axis(0.0);
    box_axis[static_cast<int>(random.below(3))] = random.below(2) == 0 ? -1.0 : 1.0;
    const glm::dvec3 normal = glm::cross(box_axis, edges[random.below(3)]);
    if (glm::length(normal) < 1e-9) return camera;
    away = glm::normalize(normal);
    double reach = -std::numeric_limits<double>::infinity();
    for (const double corner_x : {-1.0, 1.0}) {
      for (const double corner_y : {-1.0, 1.0}) {
        for (const double depth : {lens.near_m, far}) {
          reach = std::max(reach, glm::dot(away, frustum_point(camera, corner_x, corner_y, depth)));
        }
      }
    }
    gap = glm::dot(away, n_vertex(Plane{away, 0.0}, box)) - reach;
  }
  if (!(std::abs(gap) < 1e9)) return camera;
  camera.pose.eye += away * gap;
  const auto axis = static_cast<int>(random.below(3));
  const double to = random.below(2) == 0 ? -1e300 : 1e300;
  for (std::uint64_t steps = random.below(3); steps > 0; --steps) {
    camera.pose.eye[axis] = std::nextafter(camera.pose.eye[axis], to);
  }
  return camera;
}

/// A box of any orientation, sometimes skewed, that touches one plane as nearly as double allows.
inline OrientedBox touching_box(Random& random, const Camera& camera, const Aabb& box) {
  const glm::dmat3 turn(look_at(glm::dvec3(0.0), random_vector(random, 1.0)).right,
                        random_vector(random, 1.0), random_vector(random, 1.0));
  OrientedBox result = oriented(box);
  const Frustum frustum = frustum_of(camera);
  const Plane& plane =
      frustum.planes[random.below(static_cast<std::uint64_t>(frustum.plane_count))];
  result.half_axes = turn * result.half_axes;
  double reach = 0.0;
  for (int i = 0; i < 3; ++i) reach += std::abs(glm::dot(plane.normal, result.half_axes[i]));
  const double distance = std::abs(plane.signed_distance(result.center));
  const double nudge = 1.0 + 4.0 * random.uniform(-1.0, 1.0) * 0x1p-52;
  if (reach > 0.0 && random.below(2) == 0) result.half_axes *= distance / reach * nudge;
  return result;
}

inline std::string digits_of(const glm::dvec3& v) {
  std::ostringstream text;
  text << std::hexfloat << '(' << v.x << ", " << v.y << ", " << v.z << ')';
  return text.str();
}

/// What it takes to repeat a finding.
inline std::string description_of(const Camera& camera, const Aabb& box) {
  const auto& [eye, right, up, back] = camera.pose;
  const Lens& lens = camera.lens;
  std::ostringstream text;
  text << std::hexfloat << (lens.projection == Projection::perspective ? "perspective" : "ortho")
       << " lens " << lens.left << ' ' << lens.right << ' ' << lens.bottom << ' ' << lens.top << ' '
       << lens.near_m << ' ' << lens.far_m << "\npose " << digits_of(eye) << ' ' << digits_of(right)
       << ' ' << digits_of(up) << ' ' << digits_of(back) << "\nbox " << digits_of(box.min) << ' '
       << digits_of(box.max);
  return text.str();
}

}  // namespace vislab::test
