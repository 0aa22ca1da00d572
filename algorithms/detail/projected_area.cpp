#include "algorithms/detail/projected_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace vislab::detail_culling {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

/// Corner i of a box has the greater x, y or z where bit 0, 1 or 2 of i is set. Faces go round
/// counter-clockwise seen from outside.
constexpr std::array<std::array<int, 4>, 6> faces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

}  // namespace

ProjectedArea::ProjectedArea(const Camera& camera, const Viewport& viewport)
    : pose_(camera.pose),
      perspective_(camera.lens.projection == Projection::perspective),
      near_m_(camera.lens.near_m),
      scale_(viewport.width / (camera.lens.right - camera.lens.left),
             viewport.height / (camera.lens.top - camera.lens.bottom)) {
  if (perspective_) scale_ *= near_m_;
}

glm::dvec3 ProjectedArea::in_camera(const glm::dvec3& world) const {
  const glm::dvec3 p = world - pose_.eye;
  return {glm::dot(p, pose_.right), glm::dot(p, pose_.up), -glm::dot(p, pose_.back)};
}

// The cone around the sphere (centre c at depth z and distance l from the eye, radius r) is the set
// of p with dot(p, c) >= |p| sqrt(l^2 - r^2). In the plane at depth 1 that is a quadratic form in
// (x, y, 1) with the matrix c c^T - (l^2 - r^2) I; the area of an ellipse is pi |det| of the whole
// matrix by |det|^(3/2) of its upper left part: pi r^2 sqrt(l^2 - r^2) / (z^2 - r^2)^(3/2).
double ProjectedArea::of(const Sphere& sphere) const {
  const double r = sphere.radius;
  const glm::dvec3 c = in_camera(sphere.center);
  if (!(r >= 0.0) || !(c.z - r > near_m_)) return endless;
  const double disc = std::numbers::pi * r * r * scale_.x * scale_.y;
  if (!perspective_) return disc;
  const double before = (c.z - r) * (c.z + r);  // z^2 - r^2, without loss where both are alike
  const double outside = c.x * c.x + c.y * c.y + before;
  return disc * std::sqrt(outside / before) / before;
}

double ProjectedArea::of(const Aabb& box) const {
  if (!box.valid()) return endless;
  const glm::dvec3 extent = glm::dvec3(box.max) - glm::dvec3(box.min);
  const glm::dvec3 first = in_camera(box.min);
  glm::dvec3 edges[3];
  for (int axis = 0; axis < 3; ++axis) {
    edges[axis] = extent[axis] * glm::dvec3(pose_.right[axis], pose_.up[axis], -pose_.back[axis]);
  }
  glm::dvec3 corners[8];
  double nearest = endless;
  for (unsigned i = 0; i < 8; ++i) {
    corners[i] = first;
    for (unsigned axis = 0; axis < 3; ++axis) {
      if (((i >> axis) & 1U) != 0) corners[i] += edges[axis];
    }
    nearest = std::min(nearest, corners[i].z);
  }
  if (!(nearest > near_m_)) return of_cut_box(corners);
  glm::dvec2 image[8];
  for (int i = 0; i < 8; ++i) {
    image[i] = glm::dvec2(corners[i]);
    if (perspective_) image[i] /= corners[i].z;
  }
  // Twice the area of a quadrilateral is the cross product of its diagonals.
  double sum = 0.0;
  for (const auto& face : faces) {
    sum += std::abs(cross(image[face[2]] - image[face[0]], image[face[3]] - image[face[1]]));
  }
  return 0.25 * sum * scale_.x * scale_.y;
}

/// Faces are cut by the near plane. The face that closes the body there is not made: signed areas
/// of all faces of a closed body cancel out, so its area is the sum of the others'.
double ProjectedArea::of_cut_box(const glm::dvec3 (&corners)[8]) const {
  const auto in_image = [&](const glm::dvec3& p) {
    return perspective_ ? glm::dvec2(p) / p.z : glm::dvec2(p);
  };
  double sum = 0.0;
  double signed_sum = 0.0;
  for (const auto& face : faces) {
    std::array<glm::dvec2, 8> cut;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const glm::dvec3& p = corners[face[i]];
      const glm::dvec3& q = corners[face[(i + 1) % 4]];
      if (p.z >= near_m_) cut[count++] = in_image(p);
      if ((p.z >= near_m_) != (q.z >= near_m_)) {
        const double share = (near_m_ - p.z) / (q.z - p.z);
        const glm::dvec2 place = glm::dvec2(p) + share * (glm::dvec2(q) - glm::dvec2(p));
        cut[count++] = in_image({place, near_m_});
      }
    }
    double doubled = 0.0;
    for (std::size_t i = 2; i < count; ++i) {
      doubled += cross(cut[i - 1] - cut[0], cut[i] - cut[0]);
    }
    sum += std::abs(doubled);
    signed_sum += doubled;
  }
  return 0.25 * (sum + std::abs(signed_sum)) * scale_.x * scale_.y;
}

double ProjectedArea::printed_m2(const Sphere& sphere) const {
  const double r = sphere.radius;
  if (!perspective_) return std::numbers::pi * r * r;
  const double d = in_camera(sphere.center).z;
  if (!(d > 0.0) || !(r >= 0.0)) return endless;
  const double projected = r * near_m_ / d;
  return std::numbers::pi * projected * projected;
}

double ProjectedArea::pixels_of_near_m2() const {
  const double pixels = scale_.x * scale_.y;
  return perspective_ ? pixels / (near_m_ * near_m_) : pixels;
}

}  // namespace vislab::detail_culling
