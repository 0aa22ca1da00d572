#include "common/geometry/frustum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "common/geometry/random.h"

namespace vislab {
namespace {

using Exact = __float128;

Lens off_centre_lens() {
  Lens lens = perspective_lens(1.0, 16.0 / 9.0, 0.3, 80.0);
  lens.left *= 0.25;
  lens.top *= 1.75;
  return lens;
}

std::vector<Lens> all_lenses() {
  Lens off_centre_box = orthographic_lens(10.0, 1.5, -2.0, 40.0);
  off_centre_box.right += 3.0;
  return {perspective_lens(1.0, 16.0 / 9.0, 0.3, 80.0), off_centre_lens(),
          orthographic_lens(10.0, 1.5, 0.1, 40.0), off_centre_box,
          perspective_lens(1.2, 1.0, 0.1, std::numeric_limits<double>::infinity())};
}

glm::dvec3 random_point(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach),
          random.uniform(-reach, reach)};
}

Pose random_pose(Random& random) {
  return look_at(random_point(random, 50.0), random_point(random, 50.0));
}

TEST(Frustum, FromTheCameraEqualsTheOneFromItsMatrix) {
  Random random(21);
  for (const Lens& lens : all_lenses()) {
    for (int i = 0; i < 50; ++i) {
      const Camera camera{random_pose(random), lens};
      const Frustum built = frustum_of(camera);
      const Frustum extracted = frustum_from_matrix(camera.view_projection());
      ASSERT_EQ(built.plane_count, extracted.plane_count);
      for (std::size_t p = 0; p < built.span().size(); ++p) {
        ASSERT_LT(glm::distance(built.planes[p].normal, extracted.planes[p].normal), 1e-9);
        ASSERT_NEAR(built.planes[p].d, extracted.planes[p].d, 1e-7);
      }
    }
  }
}

TEST(Frustum, HasNoFarPlaneIfTheFarDistanceIsInfinite) {
  const Camera camera{Pose(),
                      perspective_lens(1.0, 1.0, 0.1, std::numeric_limits<double>::infinity())};
  EXPECT_EQ(frustum_of(camera).plane_count, 5);
}

TEST(Frustum, HoldsThePointsThatClipSpaceHolds) {
  Random random(22);
  for (const Lens& lens : all_lenses()) {
    const Camera camera{random_pose(random), lens};
    const Frustum frustum = frustum_of(camera);
    int inside_count = 0;
    for (int i = 0; i < 5000; ++i) {
      const glm::dvec3 point = camera.pose.eye + random_point(random, 30.0);
      double nearest_plane = std::numeric_limits<double>::infinity();
      for (const Plane& plane : frustum.span()) {
        nearest_plane = std::min(nearest_plane, plane.signed_distance(point));
      }
      if (std::abs(nearest_plane) < 1e-6) continue;
      const glm::dvec4 clip = camera.view_projection() * glm::dvec4(point, 1.0);
      const bool inside =
          std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w && std::abs(clip.z) <= clip.w;
      ASSERT_EQ(inside, nearest_plane > 0.0);
      inside_count += inside ? 1 : 0;
    }
    EXPECT_GT(inside_count, 20);
  }
}

/// n.p + d of the corner of `box` that lies farthest along (or, with `sign` -1, against) the
/// normal.
Exact extreme_distance(const Plane& plane, const Aabb& box, double sign) {
  Exact distance = plane.d;
  for (int axis = 0; axis < 3; ++axis) {
    const bool high = sign * plane.normal[axis] >= 0.0;
    distance += static_cast<Exact>(plane.normal[axis]) *
                static_cast<Exact>(high ? box.max[axis] : box.min[axis]);
  }
  return distance;
}

/// Boxes that touch a plane as nearly as double allows, on both sides, and far from the origin.
template <typename Check>
void for_touching_boxes(Check check) {
  Random random(23);
  for (int i = 0; i < 20'000; ++i) {
    Aabb box;
    const glm::dvec3 center = random_point(random, i % 2 == 0 ? 10.0 : 1e5);
    box.extend(glm::vec3(center + random_point(random, 1.0)));
    box.extend(glm::vec3(center + random_point(random, 1.0)));
    Plane plane{glm::normalize(random_point(random, 1.0)), 0.0};
    const double sign = random.uniform() < 0.5 ? 1.0 : -1.0;
    plane.d = -static_cast<double>(extreme_distance(plane, box, sign));
    for (std::uint64_t steps = random.below(4); steps > 0; --steps) {
      plane.d = std::nextafter(plane.d, random.uniform() < 0.5 ? -1e300 : 1e300);
    }
    check(plane, box);
  }
}

TEST(BoxAgainstPlane, IsNeverCalledOutsideWhileACornerIsInside) {
  for_touching_boxes([](const Plane& plane, const Aabb& box) {
    if (surely_outside(plane, box)) {
      ASSERT_TRUE(extreme_distance(plane, box, 1.0) < 0);
    }
  });
}

TEST(BoxAgainstPlane, IsNeverCalledInsideWhileACornerIsOutside) {
  for_touching_boxes([](const Plane& plane, const Aabb& box) {
    if (surely_inside(plane, box)) {
      ASSERT_TRUE(extreme_distance(plane, box, -1.0) >= 0);
    }
  });
}

TEST(BoxAgainstPlane, IsDecidedWhereItIsClear) {
  const Plane plane{{0.0, 1.0, 0.0}, -2.0};  // inside above y = 2
  const Aabb below{{-1.0F, 0.0F, -1.0F}, {1.0F, 1.9999F, 1.0F}};
  const Aabb above{{-1.0F, 2.0001F, -1.0F}, {1.0F, 3.0F, 1.0F}};
  const Aabb across{{-1.0F, 1.0F, -1.0F}, {1.0F, 3.0F, 1.0F}};
  EXPECT_TRUE(surely_outside(plane, below));
  EXPECT_FALSE(surely_inside(plane, below));
  EXPECT_TRUE(surely_inside(plane, above));
  EXPECT_FALSE(surely_outside(plane, above));
  EXPECT_FALSE(surely_outside(plane, across));
  EXPECT_FALSE(surely_inside(plane, across));
}

TEST(BoxAgainstPlane, NothingIsConcludedFromABrokenBox) {
  const Plane plane{{1.0, 0.0, 0.0}, -1e30};
  const float not_a_number = std::numeric_limits<float>::quiet_NaN();
  for (const Aabb& box : {Aabb(), Aabb{glm::vec3(not_a_number), glm::vec3(1.0F)},
                          Aabb{glm::vec3(-1.0F), glm::vec3(not_a_number)}}) {
    EXPECT_FALSE(surely_outside(plane, box));
    EXPECT_FALSE(surely_inside(plane, box));
  }
}

TEST(SphereAgainstPlane, IsNeverCalledOutsideWhileItReachesIn) {
  Random random(24);
  for (int i = 0; i < 20'000; ++i) {
    Sphere sphere{glm::vec3(random_point(random, 1e4)),
                  static_cast<float>(random.uniform(0.01, 10.0))};
    Plane plane{glm::normalize(random_point(random, 1.0)), 0.0};
    Aabb point;
    point.extend(sphere.center);
    const Exact radius = static_cast<Exact>(sphere.radius);
    plane.d = -static_cast<double>(extreme_distance(plane, point, 1.0) + radius);
    plane.d = std::nextafter(plane.d, random.uniform() < 0.5 ? -1e300 : 1e300);
    if (surely_outside(plane, sphere)) {
      ASSERT_TRUE(extreme_distance(plane, point, 1.0) + radius < 0);
    }
    plane.d -= 1.0;
    ASSERT_TRUE(surely_outside(plane, sphere));
  }
}

/// Exact distance of a point from the plane through eye + way with the given normal (of any
/// length), times that length.
Exact exact_distance(const Camera& camera, int index, const glm::dvec3& point) {
  const auto& [eye, right, up, back] = camera.pose;
  const Lens& lens = camera.lens;
  const Exact near = lens.near_m;
  Exact distance = 0;
  for (int i = 0; i < 3; ++i) {
    const Exact x = right[i], y = up[i], forward = -static_cast<Exact>(back[i]);
    const Exact from_eye = static_cast<Exact>(point[i]) - static_cast<Exact>(eye[i]);
    const bool ortho = lens.projection == Projection::orthographic;
    switch (index) {
      case Frustum::left:
        distance +=
            ortho ? x * (from_eye - x * lens.left) : (x * near - forward * lens.left) * from_eye;
        break;
      case Frustum::right:
        distance +=
            ortho ? -x * (from_eye - x * lens.right) : (forward * lens.right - x * near) * from_eye;
        break;
      case Frustum::bottom:
        distance += ortho ? y * (from_eye - y * lens.bottom)
                          : (y * near - forward * lens.bottom) * from_eye;
        break;
      case Frustum::top:
        distance +=
            ortho ? -y * (from_eye - y * lens.top) : (forward * lens.top - y * near) * from_eye;
        break;
      case Frustum::near:
        distance += forward * (from_eye - forward * near);
        break;
      default:
        distance -= forward * (from_eye - forward * static_cast<Exact>(lens.far_m));
    }
  }
  return distance;
}

/// A camera up to 1e5 m from the origin, and a point near the origin that one of its planes passes
/// as nearly as double allows: d is then a small rest of large terms.
template <typename Check>
void for_grazing_cameras(Check check) {
  Random random(25);
  for (int i = 0; i < 20'000; ++i) {
    const double reach = std::pow(10.0, random.uniform(0.0, 5.0));
    // Whole multiples of 2^-27, which float holds: GCC 12 leaves conversions to float and back out.
    const glm::dvec3 point = glm::floor(random_point(random, 1e6)) * std::ldexp(1.0, -27);
    Camera camera{look_at(random_point(random, reach), point, random_point(random, 1.0)), Lens()};
    Pose& pose = camera.pose;
    const double distance = glm::distance(pose.eye, point);
    const double window = random.uniform(-2.0, 2.0) * distance;
    switch (i % 4) {
      case 0: {  // the left plane: the view is turned until the point lies at the image's edge
        camera.lens = perspective_lens(random.uniform(0.5, 2.0), 1.3, 0.1, 1e6);
        const double angle = std::atan2(camera.lens.left, camera.lens.near_m);
        const glm::dvec3 right = pose.right, back = pose.back;
        pose.right = right * std::cos(angle) - back * std::sin(angle);
        pose.back = right * std::sin(angle) + back * std::cos(angle);
        break;
      }
      case 1:  // the left plane of an orthographic camera
        camera.lens = orthographic_lens(10.0, 1.0, 0.1, 1e6);
        pose.eye -= pose.right * window;
        camera.lens.left = window;
        camera.lens.right = window + 10.0;
        break;
      case 2:  // the near plane
        camera.lens = perspective_lens(1.0, 1.3, distance, 1e6);
        break;
      default:  // the far plane
        camera.lens = perspective_lens(1.0, 1.3, 0.1, distance);
    }
    check(camera, point);
  }
}

TEST(PlaneOfAFarCamera, IsSureOnlyOfWhatIsTrueInExactArithmetic) {
  int sure = 0;
  for_grazing_cameras([&](const Camera& camera, const glm::dvec3& point) {
    const Frustum frustum = frustum_of(camera);
    Aabb box;
    box.extend(glm::vec3(point));
    for (int index = 0; index < frustum.plane_count; ++index) {
      const Plane& plane = frustum.planes[static_cast<std::size_t>(index)];
      const Exact distance = exact_distance(camera, index, point);
      const bool outside = surely_outside(plane, box);
      const bool inside = surely_inside(plane, box);
      if (outside || surely_outside(plane, Sphere{glm::vec3(point), 0.0F})) {
        ASSERT_TRUE(distance < 0) << "plane " << index;
      }
      if (inside) {
        ASSERT_TRUE(distance > 0) << "plane " << index;
      }
      sure += outside || inside ? 1 : 0;
      // A ten-thousandth of a millimetre is enough to tell, even at 100 km.
      Plane moved = plane;
      moved.d += 1e-7 + std::abs(plane.signed_distance(point));
      ASSERT_TRUE(surely_inside(moved, box));
    }
  });
  EXPECT_GT(sure, 50'000);  // the planes that the point is not near to
}

TEST(NearRegion, IsTouchedByBoxesThatTheNearPlaneMayCut) {
  const Camera camera{Pose(), perspective_lens(1.0, 1.0, 1.0, 100.0)};
  EXPECT_TRUE(touches_near_region(camera, {glm::vec3(-5.0F), glm::vec3(5.0F)}));
  EXPECT_TRUE(touches_near_region(camera, {{-0.1F, -0.1F, -1.01F}, {0.1F, 0.1F, -0.9F}}));
  EXPECT_FALSE(touches_near_region(camera, {{-0.1F, -0.1F, -3.0F}, {0.1F, 0.1F, -2.0F}}));
  EXPECT_TRUE(touches_near_region(camera, Aabb()));
}

}  // namespace
}  // namespace vislab
