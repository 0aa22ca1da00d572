#include "algorithms/frustum/motion_coherence.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace vislab::frustum_culling {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
/// Share of its distance from the eye by which a box must have been outside to be remembered. A
/// camera that is off the ideal rotation by angle_tolerance moves it ten times less.
constexpr double comfortable = 1e-9;
constexpr double angle_tolerance = 1e-10;
/// How far the axes may be off those of a pure rotation.
constexpr double axis_tolerance = 1e-11;
constexpr double limit_margin = 1e-6;

/// Sum of the largest absolute coordinates of a box, seen from `origin`.
double reach(const Aabb& box, const glm::dvec3& origin) {
  return absolute_sum(
      glm::max(glm::abs(glm::dvec3(box.min) - origin), glm::abs(glm::dvec3(box.max) - origin)));
}

bool same_axes(const Pose& a, const Pose& b) {
  return a.right == b.right && a.up == b.up && a.back == b.back;
}

bool near(const glm::dvec3& a, const glm::dvec3& b) { return absolute_sum(a - b) < axis_tolerance; }

}  // namespace

void MotionCoherence::resize(std::size_t slots) {
  if (slots > memory_.size()) memory_.resize(slots);
}

void MotionCoherence::forget() { started_ = false; }

void MotionCoherence::restart_translation(const Camera& camera) {
  translating_since_ = now_;
  translation_reference_ = camera.pose.eye;
  travel_ = 0.0;
}

void MotionCoherence::restart(Rotation& rotation, const Camera& camera) {
  rotation.since = now_;
  rotation.reference = camera.pose;
  rotation.angle = 0.0;
  const Lens& lens = camera.lens;
  const bool is_yaw = &rotation == &yaw_;
  const double low = is_yaw ? lens.left : lens.bottom;
  const double high = is_yaw ? lens.right : lens.top;
  const double fov = std::atan2(high, lens.near_m) - std::atan2(low, lens.near_m);
  rotation.limit =
      (premise_ == Premise::sound ? std::numbers::pi - fov : std::numbers::pi) - limit_margin;
  // An orthographic camera has no wedge to turn in.
  if (lens.projection == Projection::orthographic) rotation.limit = 0.0;
}

bool MotionCoherence::continues_yaw(const Pose& now) {
  const Pose& before = camera_.pose;
  yaw_.angle += std::atan2(glm::dot(now.back, before.right), glm::dot(now.back, before.back));
  const Pose& start = yaw_.reference;
  const double c = std::cos(yaw_.angle);
  const double s = std::sin(yaw_.angle);
  return near(now.up, start.up) && near(now.back, start.back * c + start.right * s) &&
         near(now.right, start.right * c - start.back * s);
}

bool MotionCoherence::continues_pitch(const Pose& now) {
  const Pose& before = camera_.pose;
  pitch_.angle += std::atan2(-glm::dot(now.back, before.up), glm::dot(now.back, before.back));
  const Pose& start = pitch_.reference;
  const double c = std::cos(pitch_.angle);
  const double s = std::sin(pitch_.angle);
  return near(now.right, start.right) && near(now.back, start.back * c - start.up * s) &&
         near(now.up, start.up * c + start.back * s);
}

void MotionCoherence::start(const Camera& camera, const Frustum& frustum) {
  ++now_;
  const bool known = started_ && camera.lens == camera_.lens;
  const bool stays = known && camera.pose.eye == camera_.pose.eye;
  const bool keeps_axes = known && same_axes(camera.pose, camera_.pose);
  const bool turns = stays && !keeps_axes;
  if (!keeps_axes) restart_translation(camera);
  if (!(stays && keeps_axes)) {
    if (!turns || !continues_yaw(camera.pose)) restart(yaw_, camera);
    if (!turns || !continues_pitch(camera.pose)) restart(pitch_, camera);
  }
  started_ = true;
  camera_ = camera;
  frustum_ = frustum;
  const glm::dvec3 way = camera.pose.eye - translation_reference_;
  travel_ = std::max(travel_, absolute_sum(way));
  for (std::size_t i = 0; i < shift_.size(); ++i) {
    shift_[i] = glm::dot(frustum.planes[i].normal, way);
  }
}

bool MotionCoherence::still_outside(std::uint32_t slot) const {
  const Memory& memory = memory_[slot];
  if (memory.tested_at == 0) return false;
  if (memory.tested_at >= translating_since_ &&
      memory.translated < shift_[memory.plane] - 64.0 * epsilon * travel_) {
    return true;
  }
  const auto away = [&](const Rotation& rotation, double sign) {
    const double angle = sign * (rotation.angle - memory.angle);
    return memory.tested_at >= rotation.since && angle > -angle_tolerance && angle < rotation.limit;
  };
  switch (memory.plane) {
    case Frustum::left:
      return away(yaw_, -1.0);
    case Frustum::right:
      return away(yaw_, 1.0);
    case Frustum::bottom:
      return away(pitch_, 1.0);
    case Frustum::top:
      return away(pitch_, -1.0);
    default:
      return false;
  }
}

void MotionCoherence::remember(std::uint32_t slot, int plane, double distance, const Aabb& box) {
  Memory& memory = memory_[slot];
  const Plane& p = frustum_.planes[static_cast<std::size_t>(plane)];
  const double margin =
      comfortable * reach(box, camera_.pose.eye) +
      64.0 * epsilon * (reach(box, glm::dvec3(0.0)) + std::max(std::abs(p.d), p.magnitude));
  if (!(distance < -margin)) {
    memory.tested_at = 0;
    return;
  }
  memory.tested_at = now_;
  memory.plane = static_cast<std::uint8_t>(plane);
  memory.translated = distance + margin + shift_[memory.plane];
  const bool side = plane == Frustum::left || plane == Frustum::right;
  memory.angle = side ? yaw_.angle : pitch_.angle;
}

}  // namespace vislab::frustum_culling
