#include "common/judge/window_triangle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vislab {
namespace {

/// Cuts a polygon at the plane where sign * depth = sign * limit, keeping what lies beyond it
/// (Sutherland and Hodgman 1974). Depth is -z. Returns the number of corners left.
int cut(const std::array<glm::dvec3, 5>& in, int count, double sign, double limit,
        std::array<glm::dvec3, 5>& out) {
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3& a = in[i];
    const glm::dvec3& b = in[(i + 1) % count];
    const double inside_a = sign * (-a.z - limit);
    const double inside_b = sign * (-b.z - limit);
    if (inside_a >= 0.0) out[kept++] = a;
    if ((inside_a < 0.0) != (inside_b < 0.0)) {
      out[kept++] = a + (b - a) * (inside_a / (inside_a - inside_b));
    }
  }
  return kept;
}

double segment_distance_squared(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 ab = b - a;
  const glm::dvec2 ap = p - a;
  const double length_squared = glm::dot(ab, ab);
  const double t =
      length_squared > 0.0 ? std::clamp(glm::dot(ap, ab) / length_squared, 0.0, 1.0) : 0.0;
  const glm::dvec2 d = ap - ab * t;
  return glm::dot(d, d);
}

}  // namespace

WindowTriangle::WindowTriangle(const Camera& camera, const Viewport& viewport,
                               const std::array<glm::dvec3, 3>& world)
    : lens_(camera.lens),
      pixel_m_((lens_.right - lens_.left) / viewport.width,
               (lens_.top - lens_.bottom) / viewport.height),
      min_(std::numeric_limits<double>::infinity()),
      max_(-std::numeric_limits<double>::infinity()) {
  const auto& [eye, right, up, back] = camera.pose;
  std::array<glm::dvec3, 5> corners;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 p = world[i] - eye;
    corners[i] = {glm::dot(p, right), glm::dot(p, up), glm::dot(p, back)};
  }
  normal_ = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  point_ = corners[0];
  const double nearest = -std::max({corners[0].z, corners[1].z, corners[2].z});
  const double farthest = -std::min({corners[0].z, corners[1].z, corners[2].z});
  count_ = 3;
  std::array<glm::dvec3, 5> scratch;
  if (nearest < lens_.near_m) {
    count_ = cut(corners, count_, 1.0, lens_.near_m, scratch);
    corners = scratch;
  }
  if (farthest > lens_.far_m) {
    count_ = cut(corners, count_, -1.0, lens_.far_m, scratch);
    corners = scratch;
  }
  for (int i = 0; i < count_; ++i) {
    const double scale =
        lens_.projection == Projection::orthographic ? 1.0 : -lens_.near_m / corners[i].z;
    corners_[i] =
        (glm::dvec2(corners[i]) * scale - glm::dvec2(lens_.left, lens_.bottom)) / pixel_m_;
    min_ = glm::min(min_, corners_[i]);
    max_ = glm::max(max_, corners_[i]);
  }
}

double WindowTriangle::edge_distance(const glm::dvec2& window_px) const {
  double squared = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count_; ++i) {
    squared = std::min(
        squared, segment_distance_squared(window_px, corners_[i], corners_[(i + 1) % count_]));
  }
  return std::sqrt(squared);
}

bool WindowTriangle::contains(const glm::dvec2& window_px) const {
  bool left = true;
  bool right = true;
  for (int i = 0; i < count_; ++i) {
    const glm::dvec2 edge = corners_[(i + 1) % count_] - corners_[i];
    const glm::dvec2 p = window_px - corners_[i];
    const double side = edge.x * p.y - edge.y * p.x;
    left = left && side >= 0.0;
    right = right && side <= 0.0;
  }
  return count_ > 0 && (left || right);
}

double WindowTriangle::depth(const glm::dvec2& window_px) const {
  const glm::dvec2 near_plane = glm::dvec2(lens_.left, lens_.bottom) + window_px * pixel_m_;
  if (lens_.projection == Projection::orthographic) {
    return glm::dot(normal_, point_ - glm::dvec3(near_plane, 0.0)) / -normal_.z;
  }
  return glm::dot(normal_, point_) / glm::dot(normal_, glm::dvec3(near_plane / lens_.near_m, -1.0));
}

}  // namespace vislab
