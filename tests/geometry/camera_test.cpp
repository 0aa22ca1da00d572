#include "common/geometry/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace vislab {
namespace {

constexpr double right_angle = std::numbers::pi / 2.0;

void expect_orthonormal(const Pose& pose) {
  EXPECT_NEAR(glm::length(pose.right), 1.0, 1e-14);
  EXPECT_NEAR(glm::length(pose.up), 1.0, 1e-14);
  EXPECT_NEAR(glm::length(pose.back), 1.0, 1e-14);
  EXPECT_LT(glm::distance(glm::cross(pose.right, pose.up), pose.back), 1e-14);
}

TEST(Camera, LooksAtItsTargetWithOrthonormalAxes) {
  const Pose pose = look_at({1.0, 2.0, 3.0}, {4.0, -1.0, 0.5});
  expect_orthonormal(pose);
  const glm::dvec3 forward = glm::normalize(glm::dvec3(3.0, -3.0, -2.5));
  EXPECT_LT(glm::distance(-pose.back, forward), 1e-14);
  EXPECT_GT(pose.up.y, 0.0);
}

TEST(Camera, FindsAnotherVerticalWhenItLooksAlongItsOwn) {
  expect_orthonormal(look_at({0.0, 5.0, 0.0}, {0.0, 0.0, 0.0}));
  expect_orthonormal(look_at({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}));
}

TEST(Camera, MapsItsDepthRangeToClipSpace) {
  const Camera camera{look_at({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0}),
                      perspective_lens(right_angle, 1.0, 1.0, 9.0)};
  const glm::dvec4 near_point = camera.view_projection() * glm::dvec4(0.0, 0.0, 4.0, 1.0);
  const glm::dvec4 far_point = camera.view_projection() * glm::dvec4(9.0, -9.0, -4.0, 1.0);
  EXPECT_NEAR(near_point.z / near_point.w, -1.0, 1e-14);
  EXPECT_NEAR(far_point.z / far_point.w, 1.0, 1e-14);
  EXPECT_NEAR(far_point.x / far_point.w, 1.0, 1e-14);
  EXPECT_NEAR(far_point.y / far_point.w, -1.0, 1e-14);
}

TEST(Camera, RaysMeetTheWindowPositionTheyAreAimedAt) {
  Lens skew = perspective_lens(1.0, 1.5, 0.5, 50.0);
  skew.left -= 0.2;
  skew.top += 0.3;
  for (const Lens& lens :
       {perspective_lens(1.0, 1.5, 0.5, 50.0), skew, orthographic_lens(4.0, 1.5, 0.5, 50.0)}) {
    const Camera camera{look_at({1.0, 2.0, 3.0}, {-3.0, 0.5, -2.0}), lens};
    for (const glm::dvec2 window : {glm::dvec2(0.0, 0.0), glm::dvec2(0.25, 0.75)}) {
      const Ray ray = camera.ray(window);
      const glm::dvec3 point = ray.origin + ray.direction * 7.0;
      const glm::dvec4 clip = camera.view_projection() * glm::dvec4(point, 1.0);
      EXPECT_NEAR(clip.x / clip.w, 2.0 * window.x - 1.0, 1e-12);
      EXPECT_NEAR(clip.y / clip.w, 2.0 * window.y - 1.0, 1e-12);
      EXPECT_NEAR(camera.planar_depth(point), 7.0, 1e-12);
    }
  }
}

TEST(Camera, AnInfiniteFarPlaneKeepsDepthsWithinClipSpace) {
  const Camera camera{Pose(),
                      perspective_lens(1.0, 1.0, 0.5, std::numeric_limits<double>::infinity())};
  const glm::dvec4 near_point = camera.projection() * glm::dvec4(0.0, 0.0, -0.5, 1.0);
  const glm::dvec4 remote = camera.projection() * glm::dvec4(0.0, 0.0, -1e9, 1.0);
  EXPECT_NEAR(near_point.z / near_point.w, -1.0, 1e-14);
  EXPECT_NEAR(remote.z / remote.w, 1.0, 1e-8);
  EXPECT_LE(remote.z, remote.w);
}

}  // namespace
}  // namespace vislab
