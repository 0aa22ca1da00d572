// Every test of a volume against a frustum, held to exact arithmetic on boxes made to break it.
#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <string>

#include "common/geometry/bounding_spheres.h"
#include "common/geometry/frustum_side.h"
#include "tests/geometry/adversarial_boxes.h"
#include "tests/geometry/exact_judge.h"

namespace vislab {
namespace {

using test::adversarial_box;
using test::adversarial_camera;
using test::description_of;
using test::ExactJudge;
using test::touching_box;
using test::touching_camera;

#ifdef __SANITIZE_ADDRESS__
constexpr int camera_count = 400;  // the sanitizers take ten times as long
constexpr int touching_count = 2'000;
#else
constexpr int camera_count = 4'100;
constexpr int touching_count = 20'000;
#endif
constexpr int clear_camera_count = 400;
constexpr int boxes_per_camera = 250;

std::string name_of(Side side) {
  return side == Side::outside ? "outside" : side == Side::inside ? "inside" : "intersecting";
}

/// A billionth of everything that a distance of the box is made of, metres.
double margin_of(const Camera& camera, const Aabb& box) {
  const Lens& lens = camera.lens;
  const bool perspective = lens.projection == Projection::perspective;
  const glm::dvec3 reach = glm::max(glm::abs(glm::dvec3(box.min)), glm::abs(glm::dvec3(box.max)));
  const glm::dvec3 eye = glm::abs(camera.pose.eye);
  const double size = reach.x + reach.y + reach.z + eye.x + eye.y + eye.z;
  const double window = std::max(std::abs(lens.left), std::abs(lens.right)) +
                        std::max(std::abs(lens.bottom), std::abs(lens.top));
  const double slope = perspective ? 1.0 + window / lens.near_m : 1.0;
  return 1e-9 * (slope * (size + std::abs(lens.near_m)) + window +
                 (std::isfinite(lens.far_m) ? lens.far_m : 0.0));
}

/// A sphere around the box's centre that touches one plane as nearly as float allows.
Sphere touching_sphere(Random& random, const Camera& camera, const Aabb& box) {
  Sphere sphere = circumscribed(box);
  const Frustum frustum = frustum_of(camera);
  const Plane& plane =
      frustum.planes[random.below(static_cast<std::uint64_t>(frustum.plane_count))];
  const double distance = std::abs(plane.signed_distance(glm::dvec3(sphere.center)));
  if (random.below(2) == 0) sphere.radius = std::abs(test::nudged(random, distance));
  return sphere;
}

class FrustumExactness : public testing::Test {
 protected:
  struct Counts {
    std::uint64_t outside = 0;
    std::uint64_t inside = 0;
  };

  /// Calls check(judge, camera, exact test, box, random) for all cameras and boxes, and for each
  /// box that a camera was moved to.
  template <typename Check>
  void for_all(std::uint64_t seed, int cameras, int touching, Check check) {
    Random random(seed);
    std::uint64_t boxes = 0;
    for (int i = 0; i < cameras && !HasFailure(); ++i) {
      const Camera camera = adversarial_camera(random);
      const ExactJudge judge(camera);
      const ExactFrustum exact(camera);
      for (int j = 0; j < boxes_per_camera; ++j) {
        const Aabb box = adversarial_box(random, camera);
        ASSERT_TRUE(box.valid());
        ++boxes;
        check(judge, camera, exact, box, random);
        if (HasFailure()) break;
      }
    }
    for (int i = 0; i < touching && !HasFailure(); ++i) {
      const Camera before = adversarial_camera(random);
      const Aabb box = adversarial_box(random, before);
      const Camera camera = touching_camera(random, before, box);
      check(ExactJudge(camera), camera, ExactFrustum(camera), box, random);
    }
    std::cout << boxes << " boxes before " << cameras << " cameras, " << touching
              << " cameras moved to a box\n";
  }

  /// `outside` and `inside` must be true by the judge.
  template <typename Volume>
  void expect_true(Side side, const char* test, const ExactJudge& judge, const Camera& camera,
                   const Aabb& box, const Volume& volume, Counts& counts) {
    counts.outside += side == Side::outside ? 1 : 0;
    counts.inside += side == Side::inside ? 1 : 0;
    const bool is_true = side == Side::outside  ? judge.outside_of_a_plane(volume)
                         : side == Side::inside ? judge.inside(volume)
                                                : true;
    EXPECT_TRUE(is_true) << test << " says " << name_of(side) << "\n"
                         << description_of(camera, box);
  }

  static void print(const char* test, const Counts& counts) {
    std::cout << test << ": " << counts.outside << " outside, " << counts.inside << " inside\n";
    EXPECT_GT(counts.outside, 0U) << test;
    EXPECT_GT(counts.inside, 0U) << test;
  }
};

TEST_F(FrustumExactness, TestsSayOutsideAndInsideOnlyWhereItIsTrueInExactArithmetic) {
  Counts by_corners, by_vertices, by_sphere, by_oriented_box, by_exact_test;
  std::uint64_t beyond_planes = 0;  // outside, but not of a plane
  for_all(1, camera_count, touching_count,
          [&](const ExactJudge& judge, const Camera& camera, const ExactFrustum& exact,
              const Aabb& box, Random& random) {
            const Frustum& frustum = exact.planes();
            const Side corners = side_by_corners(frustum, box);
            const Side vertices = side_by_vertices(frustum, box);
            expect_true(vertices, "the n-/p-vertex test", judge, camera, box, box, by_vertices);
            expect_true(corners, "the test of corners", judge, camera, box, box, by_corners);
            const Sphere sphere = touching_sphere(random, camera, box);
            expect_true(side_of(frustum, sphere), "the test of spheres", judge, camera, box, sphere,
                        by_sphere);
            const OrientedBox any = touching_box(random, camera, box);
            expect_true(side_of(frustum, any), "the test of oriented boxes", judge, camera, box,
                        any, by_oriented_box);

            const Side side = exact.side(box);
            by_exact_test.outside += side == Side::outside ? 1 : 0;
            by_exact_test.inside += side == Side::inside ? 1 : 0;
            if (side == Side::outside) {
              EXPECT_TRUE(judge.disjoint(box)) << "the exact test says outside\n"
                                               << description_of(camera, box);
            }
            beyond_planes += side == Side::outside && vertices != Side::outside ? 1 : 0;
            // What the planes are sure of the exact test is sure of too.
            EXPECT_EQ(side == Side::inside, vertices == Side::inside);
            EXPECT_TRUE(vertices != Side::outside || side == Side::outside);
            EXPECT_TRUE(corners == Side::intersecting || corners == vertices);
          });
  print("corners", by_corners);
  print("vertices", by_vertices);
  print("sphere", by_sphere);
  print("oriented box", by_oriented_box);
  print("exact", by_exact_test);
  std::cout << "outside of no single plane: " << beyond_planes << "\n";
  EXPECT_GT(beyond_planes, 0U);
}

TEST_F(FrustumExactness, TestsDecideWhateverIsClear) {
  std::uint64_t disjoint = 0;
  for_all(2, clear_camera_count, 0,
          [&](const ExactJudge& judge, const Camera& camera, const ExactFrustum& exact,
              const Aabb& box, Random&) {
            const double margin = margin_of(camera, box);
            const Side vertices = side_by_vertices(exact.planes(), box);
            const Side corners = side_by_corners(exact.planes(), box);
            if (judge.clearly_outside_of_a_plane(box, margin)) {
              EXPECT_EQ(vertices, Side::outside) << description_of(camera, box);
            }
            if (judge.clearly_inside(box, margin)) {
              EXPECT_EQ(vertices, Side::inside) << description_of(camera, box);
              EXPECT_EQ(corners, Side::inside) << description_of(camera, box);
            }
            if (judge.clearly_disjoint(box, margin)) {
              ++disjoint;
              EXPECT_EQ(exact.side(box), Side::outside) << description_of(camera, box);
            }
          });
  std::cout << disjoint << " boxes are clear of the frustum\n";
  EXPECT_GT(disjoint, 0U);
}

TEST_F(FrustumExactness, SpheresAndOrientedBoxesAroundABoxExcludeItOnlyIfItIsOutside) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Camera camera = adversarial_camera(random);
    const ExactJudge judge(camera);
    const Frustum frustum = frustum_of(camera);
    for (int j = 0; j < 100; ++j) {
      const Aabb box = adversarial_box(random, camera);
      if (side_of(frustum, circumscribed(box)) == Side::outside ||
          side_of(frustum, oriented(box)) == Side::outside) {
        ASSERT_TRUE(judge.outside_of_a_plane(box)) << description_of(camera, box);
      }
    }
  }
}

TEST(ExactJudge, KnowsTouchingFromBeingApart) {
  Camera camera;
  camera.lens = perspective_lens(1.0, 1.0, 1.0, 10.0);
  camera.lens.left = -1.0;  // the right and left planes are x = +-z
  camera.lens.right = 1.0;
  const ExactJudge judge(camera);
  const float beside = std::nextafter(2.0F, 3.0F);
  const Aabb touching{{2.0F, 0.0F, -2.0F}, {3.0F, 0.0F, -2.0F}};
  const Aabb apart{{beside, 0.0F, -2.0F}, {3.0F, 0.0F, -2.0F}};
  EXPECT_FALSE(judge.outside_of_a_plane(touching));
  EXPECT_FALSE(judge.disjoint(touching));
  EXPECT_TRUE(judge.outside_of_a_plane(apart));
  EXPECT_TRUE(judge.disjoint(apart));
  const Aabb in_it{{-2.0F, 0.0F, -2.0F}, {2.0F, 0.0F, -2.0F}};
  EXPECT_TRUE(judge.inside(in_it));
  EXPECT_FALSE(judge.inside(Aabb{in_it.min, {beside, 0.0F, -2.0F}}));
  // Beyond an edge: outside of no plane, and still apart.
  const Aabb beyond{{9.0F, -1.0F, -12.0F}, {30.0F, 1.0F, 9.0F}};
  EXPECT_FALSE(judge.disjoint(beyond));
}

}  // namespace
}  // namespace vislab
