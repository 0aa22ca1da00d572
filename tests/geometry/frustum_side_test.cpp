#include "common/geometry/frustum_side.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>
#include <vector>

#include "common/geometry/bounding_spheres.h"
#include "common/geometry/random.h"
#include "tests/geometry/adversarial_boxes.h"

namespace vislab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Camera camera_at(const Pose& pose) {
  return {pose, perspective_lens(std::numbers::pi / 9.0, 1.0, 0.1, 100.0)};  // 20 degrees
}

Aabb cube_at(const glm::dvec3& center, double edge) {
  return {glm::vec3(center - 0.5 * edge), glm::vec3(center + 0.5 * edge)};
}

/// Cubes that are outside of no plane and still outside of the frustum, by those that are not, for
/// centres uniform over all places where no plane excludes the cube. `pose` gives one pose a cube.
template <typename NextPose>
double over_inclusion(double edge, NextPose pose) {
  Random random(71);
  const double reach = std::sqrt(0.75) * edge;  // of a cube along any direction
  const double half_angle = std::numbers::pi / 18.0;
  const double width = (100.0 + reach) * std::tan(half_angle) + reach / std::cos(half_angle);
  int kept = 0;
  int extra = 0;
  while (kept < 40'000) {
    const Camera camera = camera_at(pose(random));
    const double x = random.uniform(-width, width);
    const double y = random.uniform(-width, width);
    const double depth = random.uniform(-reach, 100.0 + reach);
    const glm::dvec3 center = camera.pose.right * x + camera.pose.up * y - camera.pose.back * depth;
    const Aabb cube = cube_at(camera.pose.eye + center, edge);
    const ExactFrustum exact(camera);
    if (side_by_vertices(exact.planes(), cube) == Side::outside) continue;
    (exact.side(cube) == Side::outside ? extra : kept) += 1;
  }
  std::cout << "edge " << edge << ": " << static_cast<double>(extra) / kept << "\n";
  return static_cast<double>(extra) / kept;
}

TEST(SixPlanes, KeepAsMuchTooMuchOfTurnedCubesAsPredicted) {
  const auto turned = [](Random& random) {
    // Uniform over all turns: a uniform direction of view and a uniform turn around it.
    const double z = random.uniform(-1.0, 1.0);
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double roll = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double radius = std::sqrt(1.0 - z * z);
    Pose pose = look_at(glm::dvec3(0.0), {radius * std::cos(angle), radius * std::sin(angle), z});
    const glm::dvec3 right = pose.right;
    pose.right = right * std::cos(roll) + pose.up * std::sin(roll);
    pose.up = glm::cross(pose.back, pose.right);
    return pose;
  };
  EXPECT_NEAR(over_inclusion(8.0, turned), 0.08, 0.04);
  EXPECT_NEAR(over_inclusion(32.0, turned), 0.40, 0.04);
  EXPECT_NEAR(over_inclusion(100.0, turned), 0.96, 0.04);
}

TEST(SixPlanes, KeepAsMuchTooMuchOfAlignedCubesAsPredicted) {
  const auto aligned = [](Random&) { return Pose(); };
  EXPECT_NEAR(over_inclusion(8.0, aligned), 0.01, 0.04);
  EXPECT_NEAR(over_inclusion(32.0, aligned), 0.06, 0.04);
  EXPECT_NEAR(over_inclusion(100.0, aligned), 0.16, 0.04);
}

TEST(ExactFrustum, ExcludesABigBoxBeyondAnEdgeThatNoPlaneExcludes) {
  const Camera camera = camera_at(look_at({0.0, 0.0, 0.0}, {1.0, 0.0, -1.0}));
  const ExactFrustum exact(camera);
  std::uint64_t axes = 0;
  // In front of the near plane and behind no side, but beside the eye.
  const Aabb big{{-60.0F, -2.0F, -50.0F}, {-1.0F, 2.0F, 60.0F}};
  EXPECT_EQ(exact.side(big, &axes), Side::outside);
  const Camera ahead = camera_at(Pose());
  Random random(72);
  int found = 0;
  for (int i = 0; i < 2'000; ++i) {
    const Aabb cube = cube_at(test::random_vector(random, 150.0), 100.0);
    const Side by_planes = side_by_vertices(frustum_of(ahead), cube);
    found += by_planes != Side::outside && ExactFrustum(ahead).side(cube) == Side::outside ? 1 : 0;
  }
  EXPECT_GT(found, 0);
}

TEST(ExactFrustum, LeavesBrokenBoxesUndecided) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float far_away = 1e4F;
  const Camera camera = camera_at(Pose());
  const ExactFrustum exact(camera);
  const glm::vec3 corner(far_away);
  for (const Aabb& box :
       {Aabb(), Aabb{corner, {nan, far_away, far_away}}, Aabb{{far_away, nan, far_away}, corner},
        Aabb{corner, glm::vec3(static_cast<float>(infinity))}, Aabb{corner + 1.0F, corner},
        Aabb{glm::vec3(-3e38F), glm::vec3(3e38F)}}) {
    EXPECT_EQ(exact.side(box), Side::intersecting);
    EXPECT_EQ(side_by_vertices(exact.planes(), box), Side::intersecting);
    EXPECT_EQ(side_by_corners(exact.planes(), box), Side::intersecting);
    EXPECT_EQ(side_of(exact.planes(), oriented(box)), Side::intersecting);
    EXPECT_EQ(side_of(exact.planes(), circumscribed(box)), Side::intersecting);
  }
  EXPECT_EQ(side_of(exact.planes(), Sphere{corner, nan}), Side::intersecting);
  EXPECT_EQ(side_of(exact.planes(), Sphere{corner, -1.0F}), Side::intersecting);
  EXPECT_EQ(side_of(exact.planes(), Sphere{{nan, 0.0F, 0.0F}, 1.0F}), Side::intersecting);
}

TEST(FrustumSide, CountsThePlanesAndAxesThatWereLookedAt) {
  const Camera camera = camera_at(Pose());
  const ExactFrustum exact(camera);
  const Aabb inside = cube_at({0.0, 0.0, -50.0}, 1.0);
  const Aabb left = cube_at({-500.0, 0.0, -50.0}, 1.0);
  std::uint64_t count = 0;
  EXPECT_EQ(side_by_vertices(exact.planes(), inside, &count), Side::inside);
  EXPECT_EQ(count, 6U);
  EXPECT_EQ(side_by_vertices(exact.planes(), left, &count), Side::outside);
  EXPECT_EQ(count, 7U);  // the left plane comes first
  EXPECT_EQ(side_by_corners(exact.planes(), left, &count), Side::outside);
  EXPECT_EQ(count, 8U);
  EXPECT_EQ(side_of(exact.planes(), circumscribed(left), &count), Side::outside);
  EXPECT_EQ(count, 9U);
  EXPECT_EQ(side_of(exact.planes(), oriented(left), &count), Side::outside);
  EXPECT_EQ(count, 10U);
  EXPECT_EQ(exact.side(inside, &count), Side::inside);
  EXPECT_EQ(count, 16U);
}

TEST(FrustumSide, KnowsABoxThatHoldsTheWholeFrustum) {
  const ExactFrustum exact(camera_at(Pose()));
  const Aabb everything = cube_at(glm::dvec3(0.0), 1e6);
  EXPECT_EQ(exact.side(everything), Side::intersecting);
  EXPECT_EQ(side_by_vertices(exact.planes(), everything), Side::intersecting);
  EXPECT_EQ(side_by_corners(exact.planes(), everything), Side::intersecting);
}

TEST(FrustumSide, AgreesAmongTestsWhereItIsClear) {
  Random random(73);
  int outside = 0;
  int inside = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Camera camera =
        camera_at(look_at(test::random_vector(random, 50.0), test::random_vector(random, 50.0)));
    const Frustum frustum = frustum_of(camera);
    const Aabb box = cube_at(test::random_vector(random, 100.0), random.uniform(0.01, 20.0));
    const Side side = side_by_vertices(frustum, box);
    ASSERT_EQ(side_by_corners(frustum, box), side);
    ASSERT_EQ(side_of(frustum, oriented(box)), side);
    // A sphere is looser: what it decides is right, and it leaves more undecided.
    const Side by_sphere = side_of(frustum, circumscribed(box));
    ASSERT_TRUE(by_sphere == side || by_sphere == Side::intersecting);
    outside += side == Side::outside ? 1 : 0;
    inside += side == Side::inside ? 1 : 0;
  }
  EXPECT_GT(outside, 1'000);
  EXPECT_GT(inside, 10);
}

}  // namespace
}  // namespace vislab
