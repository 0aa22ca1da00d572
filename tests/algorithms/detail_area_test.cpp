// The areas that detail culling goes by, against areas that are counted: rays through a fine grid
// over the image plane.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "algorithms/detail/projected_area.h"
#include "common/geometry/random.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

using detail_culling::ProjectedArea;

constexpr Viewport image{400, 300};

Lens wide_lens() { return perspective_lens(degrees(120.0), image.aspect(), 0.05, 1000.0); }

/// Turned and moved anyhow: areas do not depend on where the world's axes are.
Pose tilted_pose() { return look_at({3.0, -2.0, 5.0}, {4.5, 0.5, -7.0}, {0.2, 1.0, 0.1}); }

glm::dvec3 in_world(const Pose& pose, const glm::dvec3& in_camera) {
  return pose.eye + in_camera.x * pose.right + in_camera.y * pose.up - in_camera.z * pose.back;
}

/// Pixels of the image plane beyond all borders whose rays fulfil `hit`, by a grid of n x n rays
/// through the rectangle low to high of the plane at depth 1. `hit` takes a point of that plane,
/// camera frame.
template <typename Hit>
double counted_px(const Lens& lens, const glm::dvec2& low, const glm::dvec2& high, int n, Hit hit) {
  std::size_t hits = 0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const glm::dvec2 at = low + (high - low) * glm::dvec2(i + 0.5, j + 0.5) / double(n);
      hits += hit(at) ? 1 : 0;
    }
  }
  const double scale_x = image.width * lens.near_m / (lens.right - lens.left);
  const double scale_y = image.height * lens.near_m / (lens.top - lens.bottom);
  const glm::dvec2 size = high - low;
  return static_cast<double>(hits) / n / n * size.x * size.y * scale_x * scale_y;
}

struct SeenSphere {
  double off_axis_deg, ratio;  // of the radius to the distance along the view
};

constexpr double depth_m = 10.0;

/// Beside the axis to the upper right.
Sphere sphere_of(const Pose& pose, const SeenSphere& seen) {
  const double aside = depth_m * std::tan(degrees(seen.off_axis_deg));
  const glm::dvec3 center = in_world(pose, {0.8 * aside, 0.6 * aside, depth_m});
  return {glm::vec3(center), static_cast<float>(seen.ratio * depth_m)};
}

constexpr std::array seen_spheres{
    SeenSphere{0.0, 0.01}, SeenSphere{0.0, 0.5},   SeenSphere{0.0, 0.9},  SeenSphere{30.0, 0.1},
    SeenSphere{30.0, 0.5}, SeenSphere{54.7, 0.01}, SeenSphere{54.7, 0.5}, SeenSphere{54.7, 0.9}};

TEST(ProjectedSphere, CoversWhatRaysCount) {
  for (const bool shifted : {false, true}) {
    Camera camera{tilted_pose(), wide_lens()};
    if (shifted) {
      camera.lens.left *= 0.3;
      camera.lens.right *= 1.2;
      camera.lens.top *= 0.6;
    }
    const ProjectedArea areas(camera, image);
    for (const SeenSphere& seen : seen_spheres) {
      const Sphere sphere = sphere_of(camera.pose, seen);
      const double aside = std::tan(degrees(seen.off_axis_deg));
      const glm::dvec3 c(0.8 * aside * depth_m, 0.6 * aside * depth_m, depth_m);
      const double r = seen.ratio * depth_m;
      // The cone's rim is nowhere farther from the axis than where it meets the plane that holds
      // both, which is off the axis by the angles' sum.
      const double widest =
          std::tan(degrees(seen.off_axis_deg) + std::asin(r / glm::length(c))) - aside;
      const glm::dvec2 middle(0.8 * aside, 0.6 * aside);
      const double counted = counted_px(
          camera.lens, middle - widest, middle + widest, 1000, [&](const glm::dvec2& at) {
            const glm::dvec3 way = glm::normalize(glm::dvec3(at, 1.0));
            const double along = glm::dot(way, c);
            return glm::dot(c, c) - along * along <= r * r;
          });
      EXPECT_NEAR(areas.of(sphere) / counted, 1.0, 4e-3)
          << seen.off_axis_deg << " degrees, r / d " << seen.ratio;
    }
  }
}

TEST(ProjectedSphere, IsLargerThanPrintedByTheAngleAndTheNearness) {
  const Camera camera{tilted_pose(), wide_lens()};
  const ProjectedArea areas(camera, image);
  const auto ratio = [&](double off_axis_deg, double r_by_d) {
    const Sphere sphere = sphere_of(camera.pose, {off_axis_deg, r_by_d});
    return areas.of(sphere) / (areas.printed_m2(sphere) * areas.pixels_of_near_m2());
  };
  EXPECT_NEAR(ratio(0.0, 0.001), 1.0, 1e-5);
  EXPECT_NEAR(ratio(0.0, 0.1), 1.0101, 1e-4);
  EXPECT_NEAR(ratio(0.0, 0.5), 1.3333, 1e-4);
  EXPECT_NEAR(ratio(0.0, 0.9), 5.263, 1e-3);
  EXPECT_NEAR(ratio(54.7356, 0.001), std::sqrt(3.0), 1e-4);
  EXPECT_GT(ratio(54.7356, 0.9), 17.0);
  for (double angle = 0.0; angle <= 55.0; angle += 5.0) EXPECT_GE(ratio(angle, 0.01), 1.0);
}

TEST(ProjectedSphere, OfAnOrthographicCameraIsADisc) {
  const Camera camera{tilted_pose(), orthographic_lens(30.0, image.aspect(), 0.1, 100.0)};
  const ProjectedArea areas(camera, image);
  for (const double x : {0.0, 40.0}) {
    const Sphere sphere{glm::vec3(in_world(camera.pose, {x, 3.0, 20.0})), 2.0F};
    EXPECT_NEAR(areas.of(sphere), std::numbers::pi * 4.0 * 100.0, 1e-3);
  }
}

TEST(ProjectedSphere, IsEndlessWhereTheNearPlaneOrTheEyeIsInIt) {
  const Camera camera{tilted_pose(), wide_lens()};
  const ProjectedArea areas(camera, image);
  const auto at_depth = [&](double depth, float radius) {
    return areas.of(Sphere{glm::vec3(in_world(camera.pose, {0.5, 0.0, depth})), radius});
  };
  EXPECT_TRUE(std::isinf(at_depth(0.0, 1.0F)));
  EXPECT_TRUE(std::isinf(at_depth(1.0, 1.0F)));
  EXPECT_TRUE(std::isinf(at_depth(1.0, 0.96F)));
  EXPECT_FALSE(std::isinf(at_depth(1.0, 0.94F)));
  EXPECT_TRUE(std::isinf(at_depth(5.0, -1.0F)));
  EXPECT_TRUE(std::isinf(at_depth(5.0, std::nanf(""))));
  EXPECT_EQ(at_depth(5.0, 0.0F), 0.0);
}

/// Does the ray from the eye through (at, 1) meet the box at depth `near_m` or beyond?
bool ray_meets(const Aabb& box, const Pose& pose, const glm::dvec2& at, double near_m) {
  const glm::dvec3 way = in_world(pose, glm::dvec3(at, 1.0)) - pose.eye;
  double enter = near_m;
  double leave = 1e30;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.min[axis] - pose.eye[axis]) / way[axis];
    const double b = (box.max[axis] - pose.eye[axis]) / way[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

TEST(ProjectedBox, CoversWhatRaysCountThoughTheNearPlaneCutsIt) {
  const double near_m = 0.5;
  const Camera camera{tilted_pose(),
                      perspective_lens(degrees(90.0), image.aspect(), near_m, 100.0)};
  const ProjectedArea areas(camera, image);
  Random random(11);
  int cut = 0;
  for (int i = 0; i < 30; ++i) {
    const double depth = random.uniform(0.3, 6.0);
    const glm::vec3 center(
        in_world(camera.pose, {random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), depth}));
    const glm::vec3 half(random.uniform(0.1, 0.5), random.uniform(0.1, 0.5),
                         i % 5 == 0 ? 0.0 : random.uniform(0.1, 0.5));
    const Aabb box{center - half, center + half};
    if (depth < near_m + 0.8) ++cut;
    const double reach = (0.57 + glm::length(half)) / std::max(near_m, depth - glm::length(half));
    const double counted =
        counted_px(camera.lens, glm::dvec2(-reach), glm::dvec2(reach), 500,
                   [&](const glm::dvec2& at) { return ray_meets(box, camera.pose, at, near_m); });
    EXPECT_NEAR(areas.of(box), counted, 0.008 * counted + 0.5) << i;
  }
  EXPECT_GT(cut, 3);
}

TEST(ProjectedBox, IsNothingBeforeTheNearPlaneAndEndlessIfItIsNoBox) {
  const Camera camera{Pose(), wide_lens()};
  const ProjectedArea areas(camera, image);
  EXPECT_EQ(areas.of(Aabb{{-1, -1, 1}, {1, 1, 3}}), 0.0);
  EXPECT_TRUE(std::isinf(areas.of(Aabb())));
  EXPECT_TRUE(std::isinf(areas.of(Aabb{{0, 0, std::nanf("")}, {1, 1, 1}})));
  // The eye within: all of the plane that the box's part behind the near plane covers.
  EXPECT_GT(areas.of(Aabb{{-1, -1, -1}, {1, 1, 1}}), 400.0 * 300.0);
}

TEST(ProjectedBox, OfAnOrthographicCameraIsItsShadow) {
  const Camera camera{Pose(), orthographic_lens(30.0, image.aspect(), 0.1, 100.0)};
  const ProjectedArea areas(camera, image);
  EXPECT_NEAR(areas.of(Aabb{{20, 1, -9}, {22, 4, -5}}), 6.0 * 100.0, 1e-6);
  EXPECT_NEAR(areas.of(Aabb{{20, 1, -9}, {22, 1, -5}}), 0.0, 1e-9);
  // Cut by the near plane: the shadow is the same.
  EXPECT_NEAR(areas.of(Aabb{{20, 1, -9}, {22, 4, 5}}), 6.0 * 100.0, 1e-6);
}

}  // namespace
}  // namespace vislab
