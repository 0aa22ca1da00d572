// All ways to make the planes of a view frustum, against each other; the thesis's, right and wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/geometry/frustum.h"
#include "common/geometry/random.h"
#include "common/geometry/thesis_frustum.h"

namespace vislab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

glm::dvec3 random_point(Random& random, double reach) {
  const double x = random.uniform(-reach, reach);
  const double y = random.uniform(-reach, reach);
  return {x, y, random.uniform(-reach, reach)};
}

Lens off_centre(Lens lens) {
  lens.left *= 0.25;
  lens.top *= 1.75;
  lens.bottom *= -0.5;
  return lens;
}

std::vector<Lens> all_lenses() {
  return {perspective_lens(1.0, 16.0 / 9.0, 0.3, 80.0),
          off_centre(perspective_lens(1.0, 16.0 / 9.0, 0.3, 80.0)),
          orthographic_lens(10.0, 1.5, 0.1, 40.0),
          orthographic_lens(10.0, 1.5, -20.0, 40.0),
          off_centre(orthographic_lens(10.0, 1.5, -2.0, 40.0)),
          perspective_lens(1.2, 1.0, 0.1, infinity),
          off_centre(perspective_lens(1.2, 1.0, 0.1, infinity)),
          perspective_lens(0.01, 1.0, 0.1, 1000.0),
          perspective_lens(3.0, 2.0, 0.1, 1000.0)};
}

void expect_equal(const Frustum& a, const Frustum& b, double tolerance) {
  ASSERT_EQ(a.plane_count, b.plane_count);
  for (std::size_t i = 0; i < a.span().size(); ++i) {
    EXPECT_LT(glm::distance(a.planes[i].normal, b.planes[i].normal), tolerance) << "plane " << i;
    const double size = std::max({1.0, std::abs(a.planes[i].d), a.planes[i].magnitude});
    EXPECT_NEAR(a.planes[i].d, b.planes[i].d, tolerance * size) << "plane " << i;
  }
}

TEST(FrustumConstruction, CornersMatrixAndPoseGiveTheSamePlanes) {
  Random random(31);
  for (const Lens& lens : all_lenses()) {
    for (int i = 0; i < 50; ++i) {
      const Camera camera{look_at(random_point(random, 50.0), random_point(random, 50.0)), lens};
      const Frustum of_pose = frustum_of(camera);
      expect_equal(of_pose, frustum_by_corners(camera), 1e-11);
      expect_equal(of_pose, frustum_from_matrix(camera.view_projection()), 1e-9);
    }
  }
}

TEST(FrustumConstruction, TheCorrectedEquationsOfTheThesisGiveTheSamePlanes) {
  Random random(32);
  for (int i = 0; i < 200; ++i) {
    ThesisCamera camera;
    camera.eye = random_point(random, 50.0);
    camera.reference = random_point(random, 50.0);
    camera.angle_deg = random.uniform(5.0, 170.0);
    camera.aspect = random.uniform(0.3, 3.0);
    camera.near_m = random.uniform(0.1, 1.0);
    camera.far_m = random.uniform(2.0, 100.0);
    const Camera same{look_at(camera.eye, camera.reference, camera.up),
                      perspective_lens(glm::radians(camera.angle_deg), camera.aspect, camera.near_m,
                                       camera.far_m)};
    const ThesisFrustum thesis = thesis_frustum(camera);
    expect_equal(frustum_of(same), thesis.frustum, 1e-11);
    const Ray top_left = same.ray({0.0, 1.0});
    EXPECT_LT(glm::distance(thesis.corners[ThesisFrustum::far_top_left],
                            top_left.origin + top_left.direction * camera.far_m),
              1e-11 * camera.far_m * glm::length(top_left.direction) + 1e-12);
  }
}

TEST(ThesisFrustum, IsTheOneOfItsFigureWhenTheAngleIsRight) {
  const ThesisFrustum thesis = thesis_frustum(ThesisCamera());
  const glm::dvec3 corner = thesis.corners[ThesisFrustum::far_bottom_left];
  EXPECT_NEAR(corner.x, -4.142, 5e-4);
  EXPECT_NEAR(corner.y, -4.142, 5e-4);
  EXPECT_NEAR(corner.z, -5.0, 1e-12);
}

TEST(ThesisFrustum, ReproducesTheFigurePrintedWithDegreesTakenForRadians) {
  const ThesisErrors errors{.angle_in_degrees = true};
  ThesisCamera camera;
  const glm::dvec3 left = thesis_frustum(camera, errors).corners[ThesisFrustum::far_bottom_left];
  const glm::dvec3 right = thesis_frustum(camera, errors).corners[ThesisFrustum::far_bottom_right];
  EXPECT_NEAR(left.x, -5.5785, 1e-4);
  EXPECT_NEAR(left.y, -5.5785, 1e-4);
  EXPECT_NEAR(left.z, -5.0, 1e-12);
  EXPECT_NEAR(right.x - left.x, 11.157, 5e-4);
  // The figure goes on with the camera moved to (5, 0, 0).
  camera.eye = {5.0, 0.0, 0.0};
  const glm::dvec3 moved = thesis_frustum(camera, errors).corners[ThesisFrustum::far_bottom_left];
  EXPECT_NEAR(moved.x, -5.0, 1e-12);
  EXPECT_NEAR(moved.y, -5.5785, 1e-4);
  EXPECT_NEAR(moved.z, 5.5785, 1e-4);
}

TEST(ThesisFrustum, IsTurnedUpsideDownForAnglesWhoseTangentInDegreesIsNegative) {
  const ThesisErrors errors{.angle_in_degrees = true};
  ThesisCamera camera;
  for (const auto& [angle_deg, tangent] : {std::pair(60.0, -6.4053), std::pair(30.0, -0.8560)}) {
    camera.angle_deg = angle_deg;
    const ThesisFrustum thesis = thesis_frustum(camera, errors);
    const glm::dvec3 corner = thesis.corners[ThesisFrustum::far_top_right];
    EXPECT_NEAR(corner.x, 10.0 * tangent, 1e-3);
    EXPECT_NEAR(corner.y, 10.0 * tangent, 1e-3);
    // Left and right, bottom and top have changed places, and all still point inward.
    for (const Plane& plane : thesis.frustum.span()) {
      EXPECT_GT(plane.signed_distance(camera.reference), 0.0);
    }
    EXPECT_LT(thesis.frustum.planes[Frustum::left].normal.x, 0.0);
  }
}

TEST(ThesisFrustum, ReachesTooFarIfTheViewIsNotMadeAUnitVector) {
  const ThesisErrors errors{.direction_not_normalised = true};
  const ThesisFrustum thesis = thesis_frustum(ThesisCamera(), errors);
  // The reference is 5 m away, so that the far plane is at 50 m instead of 10 m.
  EXPECT_NEAR(thesis.corners[ThesisFrustum::far_top_left].z, 5.0 - 50.0, 1e-12);
  EXPECT_NEAR(thesis.frustum.planes[Frustum::far].signed_distance({0.0, 0.0, 5.0}), 50.0, 1e-12);
}

TEST(ThesisFrustum, IsSkewedIfUpIsTakenAsGiven) {
  ThesisCamera camera;
  camera.eye = {0.0, 5.0, 5.0};  // looks down at 45 degrees
  const ThesisErrors errors{.up_as_given = true};
  const ThesisFrustum right = thesis_frustum(camera);
  const ThesisFrustum wrong = thesis_frustum(camera, errors);
  // As wide as up x (eye - reference) is long: 5 times too wide here.
  const auto width = [](const ThesisFrustum& frustum) {
    return glm::distance(frustum.corners[ThesisFrustum::far_top_left],
                         frustum.corners[ThesisFrustum::far_top_right]);
  };
  EXPECT_NEAR(width(wrong), 5.0 * width(right), 1e-9);
  // The far window stands upright instead of across the view.
  const glm::dvec3 forward = glm::normalize(camera.reference - camera.eye);
  const auto lean = [&](const ThesisFrustum& frustum) {
    return std::abs(glm::dot(forward, frustum.corners[ThesisFrustum::far_top_left] -
                                          frustum.corners[ThesisFrustum::far_bottom_left]));
  };
  EXPECT_LT(lean(right), 1e-12);
  EXPECT_GT(lean(wrong), 5.0);
  // It leaves out what is in view: near the lower edge, 19 degrees below the middle of 22.5.
  const glm::dvec3 below = glm::normalize(right.corners[ThesisFrustum::far_bottom_left] -
                                          right.corners[ThesisFrustum::far_top_left]);
  const glm::dvec3 seen = camera.eye + 5.0 * (forward + std::tan(glm::radians(19.0)) * below);
  for (const Plane& plane : right.frustum.span()) EXPECT_GT(plane.signed_distance(seen), 0.0);
  EXPECT_LT(wrong.frustum.planes[Frustum::bottom].signed_distance(seen), -0.1);
}

}  // namespace
}  // namespace vislab
