// Spheres and oriented boxes around points: that they enclose, and how far they are from the
// smallest.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "common/geometry/bounding_spheres.h"
#include "common/geometry/oriented_box.h"
#include "common/geometry/random.h"
#include "common/geometry/reference_volumes.h"
#include "common/geometry/symmetric_eigen.h"
#include "common/scene/error.h"
#include "common/scene/library.h"
#include "tests/geometry/exact_containment.h"
#include "tests/scene/repository_data.h"

namespace vislab {
namespace {

using test::exactly_contains;
using test::exactly_contains_image;
using Points = std::vector<glm::vec3>;

glm::dvec3 random_vector(Random& random, double reach = 1.0) {
  const double x = random.uniform(-reach, reach);
  const double y = random.uniform(-reach, reach);
  return {x, y, random.uniform(-reach, reach)};
}

glm::dvec3 on_sphere(Random& random) {
  const double z = random.uniform(-1.0, 1.0);
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double radius = std::sqrt(1.0 - z * z);
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

glm::dmat3 random_turn(Random& random) {
  const Pose pose = look_at(glm::dvec3(0.0), on_sphere(random), on_sphere(random));
  return {pose.right, pose.up, pose.back};
}

/// A kind of point sets: one more point of it.
struct Kind {
  std::string name;
  std::function<glm::dvec3(Random&)> point;
  bool cubic = false;  // a hull that spreads alike in all directions has arbitrary axes
};

std::vector<Kind> kinds() {
  return {{"cube", [](Random& r) { return random_vector(r); }, true},
          {"sphere", [](Random& r) { return on_sphere(r); }},
          {"ball", [](Random& r) { return on_sphere(r) * std::cbrt(r.uniform()); }},
          {"corners of a cube", [](Random& r) { return glm::sign(random_vector(r)) * 0.5; }, true},
          {"half a sphere",
           [](Random& r) {
             glm::dvec3 p = on_sphere(r);
             p.z = std::abs(p.z);
             return p;
           }},
          {"needle", [](Random& r) { return random_vector(r) * glm::dvec3(1.0, 0.05, 0.02); }},
          {"disc", [](Random& r) { return on_sphere(r) * glm::dvec3(1.0, 1.0, 0.02); }},
          {"lump and outliers",
           [](Random& r) {
             return r.below(10) == 0 ? random_vector(r) : random_vector(r, 0.1) + glm::dvec3(0.4);
           },
           true}};
}

Points points_of(Random& random, const Kind& kind, std::size_t count, double size,
                 const glm::dvec3& offset) {
  const glm::dmat3 turn = random_turn(random);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    points.emplace_back(turn * kind.point(random) * size + offset);
  }
  return points;
}

template <typename Volume>
bool contains_all(const Volume& volume, const Points& points) {
  return std::all_of(points.begin(), points.end(),
                     [&](const glm::vec3& p) { return exactly_contains(volume, glm::dvec3(p)); });
}

/// Point sets that leave little or no room.
std::vector<std::pair<std::string, Points>> degenerate_sets() {
  Random random(61);
  std::vector<std::pair<std::string, Points>> sets;
  sets.emplace_back("one point", Points{{1.1F, -2.2F, 3.3F}});
  sets.emplace_back("copies of a point", Points(20, {1e7F, 0.1F, -3e-3F}));
  sets.emplace_back("two points", Points{{1.0F, 2.0F, 3.0F}, {1.0F, 2.0F, 3.0000002F}});
  const auto add = [&](const std::string& name, double size, auto point) {
    Points points;
    for (int i = 0; i < 50; ++i) points.push_back(glm::vec3(point() * size));
    for (int i = 0; i < 10; ++i) points.push_back(points[random.below(50)]);
    sets.emplace_back(name, points);
  };
  for (const double size : {1.0, 1e-40, 1e-20, 1e15, 1e37}) {
    const std::string by = " of size " + std::to_string(std::log10(size));
    add("a line along an axis" + by, size, [&] { return glm::dvec3(random.uniform(), 0.5, 0.25); });
    add("a skew line" + by, size, [&] {
      return glm::floor(glm::dvec3(random.uniform() * 1024.0)) * glm::dvec3(1.0, 2.0, -0.5) /
             1024.0;
    });
    add("a plane across an axis" + by, size,
        [&] { return random_vector(random) * glm::dvec3(1.0, 0.0, 1.0) + glm::dvec3(0, 0.3, 0); });
    add("a skew plane" + by, size, [&] {
      const glm::dvec3 p = glm::floor(random_vector(random) * 512.0) / 1024.0;
      return glm::dvec3(p.x, p.y, p.x - 0.5 * p.y);
    });
    add("a flat cloud" + by, size,
        [&] { return random_vector(random) * glm::dvec3(1.0, 1e-7, 1.0); });
    add("a cloud" + by, size, [&] { return random_vector(random); });
  }
  add("a cloud far away", 1.0, [&] { return random_vector(random) + glm::dvec3(1e8, -1e8, 3e7); });
  return sets;
}

TEST(BoundingVolumes, EncloseTheirPointsInExactArithmetic) {
  Random random(62);
  for (int i = 0; i < 100; ++i) {
    for (const Kind& kind : kinds()) {
      const double size = std::pow(10.0, random.uniform(-6.0, 6.0));
      const glm::dvec3 offset = random_vector(random, random.below(2) == 0 ? 0.0 : 1e3 * size);
      const Points points = points_of(random, kind, 1 + random.below(60), size, offset);
      ASSERT_TRUE(contains_all(farthest_point_sphere(points), points)) << kind.name;
      ASSERT_TRUE(contains_all(ritter_sphere(points), points)) << kind.name;
      ASSERT_TRUE(contains_all(covariance_box(points), points)) << kind.name;
      ASSERT_TRUE(contains_all(box_along(random_turn(random), points), points)) << kind.name;
      const Aabb box = bounds_of(points);
      ASSERT_TRUE(contains_all(oriented(box), points)) << kind.name;
    }
  }
}

TEST(BoundingVolumes, EncloseDegenerateSetsInExactArithmetic) {
  for (const auto& [name, points] : degenerate_sets()) {
    EXPECT_TRUE(contains_all(farthest_point_sphere(points), points)) << name;
    EXPECT_TRUE(contains_all(ritter_sphere(points), points)) << name;
    EXPECT_TRUE(contains_all(covariance_box(points), points)) << name;
    EXPECT_TRUE(contains_all(smallest_box(points), points)) << name;
    EXPECT_TRUE(contains_all(oriented(bounds_of(points)), points)) << name;
    EXPECT_GE(ritter_sphere(points).radius * (1.0 + 1e-6), smallest_sphere_radius(points)) << name;
  }
}

TEST(BoundingVolumes, OfOnePointAreThatPoint) {
  const Points points(3, {1.1F, -2.2F, 3.3F});
  EXPECT_EQ(ritter_sphere(points).radius, 0.0F);
  EXPECT_EQ(farthest_point_sphere(points).radius, 0.0F);
  EXPECT_EQ(smallest_sphere_radius(points), 0.0);
  EXPECT_EQ(covariance_box(points).volume(), 0.0);
  EXPECT_EQ(covariance_box(points).center, glm::dvec3(points[0]));
}

TEST(BoundingVolumes, OfNothingContainNothing) {
  EXPECT_LT(ritter_sphere({}).radius, 0.0F);
  EXPECT_LT(farthest_point_sphere({}).radius, 0.0F);
  EXPECT_TRUE(std::isnan(covariance_box({}).center.x));
  EXPECT_THROW(convex_hull({}), std::logic_error);
}

TEST(OrientedBox, OfPlanarAndCollinearPointsIsFlat) {
  for (const auto& [name, points] : degenerate_sets()) {
    if (name.find("line") == std::string::npos && name.find("plane") == std::string::npos) continue;
    const OrientedBox box = covariance_box(points);
    glm::dvec3 lengths;
    for (int i = 0; i < 3; ++i) lengths[i] = glm::length(box.half_axes[i]);
    const double longest = std::max({lengths.x, lengths.y, lengths.z});
    EXPECT_LT(std::min({lengths.x, lengths.y, lengths.z}), 1e-6 * longest + 1e-44) << name;
  }
}

TEST(OrientedBox, FindsTheAxesOfATurnedBox) {
  Random random(63);
  for (int i = 0; i < 20; ++i) {
    const glm::dmat3 turn = random_turn(random);
    const glm::dvec3 half(3.0, 2.0, 1.0);
    Points points;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const glm::dvec3 sign((corner & 1U) != 0 ? 1 : -1, (corner & 2U) != 0 ? 1 : -1,
                            (corner & 4U) != 0 ? 1 : -1);
      points.emplace_back(turn * (half * sign));
    }
    // Dense vertices on one side do not pull the axes: the hull's surface counts.
    for (int j = 0; j < 200; ++j) {
      points.emplace_back(turn * (half * glm::dvec3(0.99, random.uniform(), random.uniform())));
    }
    EXPECT_NEAR(covariance_box(points).volume(), 48.0, 1e-3);
    EXPECT_NEAR(smallest_box(points).volume(), 48.0, 0.1);
  }
}

TEST(TransformedVolumes, EncloseTheImageInExactArithmetic) {
  Random random(64);
  for (int i = 0; i < 2'000; ++i) {
    glm::dmat4x3 transform(random_turn(random));
    if (i % 3 == 1) transform = glm::dmat4x3(random_turn(random) * std::pow(10.0, i % 7 - 3));
    if (i % 3 == 2) {
      transform = glm::dmat4x3(
          glm::dmat3(random_vector(random), random_vector(random), random_vector(random)));
    }
    if (i % 50 == 2) transform[1] = transform[0] * 2.0;  // squeezed flat
    transform[3] = random_vector(random, std::pow(10.0, i % 9));
    OrientedBox box{random_vector(random, std::pow(10.0, i % 5)), random_turn(random)};
    for (int axis = 0; axis < 3; ++axis)
      box.half_axes[axis] *= std::pow(10.0, random.uniform(-9, 3));
    if (i % 11 == 0) box.half_axes[static_cast<int>(random.below(3))] *= 0.0;
    const OrientedBox image = transformed(box, transform);
    const Sphere sphere{glm::vec3(random_vector(random, 1e3)),
                        static_cast<float>(random.uniform(0.0, 10.0))};
    const Sphere ball = transformed(sphere, transform);
    for (int j = 0; j < 8; ++j) {
      const glm::dvec3 t = j < 4 ? glm::sign(random_vector(random)) : random_vector(random);
      ASSERT_TRUE(exactly_contains_image(image, box, t, transform)) << i;
      ASSERT_TRUE(
          exactly_contains_image(ball, sphere, on_sphere(random) * (1.0 - 1e-15), transform))
          << i;
    }
    // The direction that is stretched most is filled.
    const SymmetricEigen eigen =
        symmetric_eigen(glm::transpose(glm::dmat3(transform)) * glm::dmat3(transform));
    const double reach = sphere.radius * std::sqrt(eigen.values[0]);
    EXPECT_NEAR(ball.radius, reach, 1e-5 * (reach + glm::length(glm::dvec3(ball.center)))) << i;
  }
}

TEST(TransformedVolumes, OfARigidMotionKeepTheirSize) {
  Random random(65);
  for (int i = 0; i < 100; ++i) {
    glm::dmat4x3 transform(random_turn(random));
    transform[3] = random_vector(random, 100.0);
    OrientedBox box{random_vector(random), random_turn(random)};
    box.half_axes[2] *= 0.01;
    EXPECT_NEAR(transformed(box, transform).volume() / box.volume(), 1.0, 1e-9);
    const Sphere sphere{glm::vec3(random_vector(random)), 1.0F};
    EXPECT_NEAR(transformed(sphere, transform).radius, 1.0, 1e-4);
  }
}

TEST(SymmetricEigen, RebuildsTheMatrix) {
  Random random(66);
  for (int i = 0; i < 500; ++i) {
    const glm::dmat3 turn = random_turn(random);
    glm::dmat3 diagonal(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      diagonal[axis][axis] = i % 3 == 0 ? 1.0 + static_cast<double>(random.below(2))  // repeated
                                        : random.uniform(-1.0, 1.0);
    }
    const SymmetricEigen eigen = symmetric_eigen(turn * diagonal * glm::transpose(turn));
    EXPECT_GE(eigen.values[0], eigen.values[1]);
    EXPECT_GE(eigen.values[1], eigen.values[2]);
    EXPECT_NEAR(glm::determinant(eigen.vectors), 1.0, 1e-14);
    glm::dmat3 values(0.0);
    for (int axis = 0; axis < 3; ++axis) values[axis][axis] = eigen.values[axis];
    const glm::dmat3 rebuilt = eigen.vectors * values * glm::transpose(eigen.vectors);
    const glm::dmat3 wanted = turn * diagonal * glm::transpose(turn);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LT(glm::distance(rebuilt[axis], wanted[axis]), 1e-14);
    }
  }
}

TEST(ConvexHull, HoldsAllPointsAndFacesOutward) {
  Random random(67);
  const Points points = points_of(random, kinds()[0], 500, 1.0, glm::dvec3(3.0));
  const Hull hull = convex_hull(points);
  EXPECT_EQ(hull.triangles.size(), 2 * hull.points.size() - 4);  // Euler
  for (const glm::uvec3& t : hull.triangles) {
    const Plane outward = plane_through(hull.points[t.x], hull.points[t.y], hull.points[t.z]);
    for (const glm::vec3& p : points) {
      ASSERT_LT(outward.signed_distance(glm::dvec3(p)), 1e-12);
    }
  }
}

TEST(ConvexHull, OfAPlaneIsItsPolygonInOrder) {
  const Points points{{0, 5, 0}, {2, 5, 0}, {1, 5, 1}, {0, 5, 2}, {2, 5, 2}, {1, 5, 0}, {2, 5, 2}};
  const Hull hull = convex_hull(points);
  EXPECT_TRUE(hull.triangles.empty());
  ASSERT_EQ(hull.points.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(glm::distance(hull.points[i], hull.points[(i + 1) % 4]), 2.0);
  }
}

/// Ratios of a volume to the smallest, collected and printed.
class Ratios {
 public:
  void add(double ratio) {
    sum_ += ratio;
    greatest_ = std::max(greatest_, ratio);
    ++count_;
  }
  double mean() const { return sum_ / count_; }
  double greatest() const { return greatest_; }
  void print(const std::string& name) const {
    std::cout << name << ": mean " << mean() << ", greatest " << greatest_ << " of " << count_
              << "\n";
  }

 private:
  double sum_ = 0.0;
  double greatest_ = 0.0;
  int count_ = 0;
};

TEST(RitterSphere, IsAtMostAFifthLargerThanTheSmallest) {
  Random random(68);
  Ratios all, two_passes, farthest;
  for (const Kind& kind : kinds()) {
    Ratios ratios;
    for (int i = 0; i < 1'000; ++i) {
      const std::size_t count = 2 + random.below(i % 2 == 0 ? 20 : 500);
      const Points points = points_of(random, kind, count, 10.0, random_vector(random, 100.0));
      const double smallest = smallest_sphere_radius(points);
      const double radius = ritter_sphere(points).radius;
      ASSERT_GE(radius, smallest * (1.0 - 1e-9));
      if (smallest == 0.0) continue;
      ratios.add(radius / smallest);
      all.add(radius / smallest);
      two_passes.add(ritter_sphere(points, 0).radius / smallest);
      farthest.add(farthest_point_sphere(points).radius / smallest);
    }
    ratios.print("Ritter, " + kind.name);
    EXPECT_LE(ratios.greatest(), 1.2) << kind.name;
  }
  all.print("Ritter, all");
  two_passes.print("Ritter's two passes alone, all");
  farthest.print("farthest point, all");
  EXPECT_LT(all.mean(), 1.02);
  EXPECT_LT(two_passes.mean(), 1.05);
  EXPECT_LT(two_passes.greatest(), 1.3);
}

#ifdef __SANITIZE_ADDRESS__
// CGAL takes seconds for a smallest box under the sanitizers.
constexpr int boxes_of_a_kind = 1;
constexpr std::array measured_meshes{"cow", "man"};
#else
constexpr int boxes_of_a_kind = 8;
constexpr std::array measured_meshes{"dragon", "bunny", "cow", "hare", "man", "elephant"};
#endif

TEST(CovarianceBox, IsNotMuchLargerThanTheSmallest) {
  Random random(69);
  for (const Kind& kind : kinds()) {
    Ratios ratios;
    for (int i = 0; i < boxes_of_a_kind; ++i) {
      const Points points = points_of(random, kind, 200, 10.0, random_vector(random, 100.0));
      const double smallest = smallest_box(points).volume();
      ratios.add(covariance_box(points).volume() / smallest);
    }
    ratios.print("covariance box, " + kind.name);
    // Around a cube an arbitrary box is at most the cube of the root of 3 as large.
    EXPECT_LE(ratios.greatest(), kind.cubic ? 5.2 : 1.5) << kind.name;
    EXPECT_GE(ratios.mean(), 1.0 - 1e-3) << kind.name;
  }
}

TEST(BoundingVolumes, OfRealMeshesAreNearTheSmallest) {
  Ratios spheres;
  Ratios boxes;
  std::size_t missing = 0;
  for (const std::string name : measured_meshes) {
    Points points;
    try {
      const Scene scene = load_scene(name, test::repository_data()).scene;
      points.assign(scene.meshes[0].positions.begin(), scene.meshes[0].positions.end());
    } catch (const InputError& error) {
      std::cout << "without " << name << ": " << error.what() << "\n";
      ++missing;
      continue;
    }
    const Sphere sphere = ritter_sphere(points);
    const OrientedBox box = covariance_box(points);
    for (const glm::dvec3& corner : convex_hull(points).points) {  // and with them all points
      ASSERT_TRUE(exactly_contains(sphere, corner)) << name;
      ASSERT_TRUE(exactly_contains(box, corner)) << name;
    }
    const double sphere_ratio = sphere.radius / smallest_sphere_radius(points);
    const double smallest = smallest_box(points).volume();
    const double box_ratio = box.volume() / smallest;
    std::cout << name << ": Ritter " << sphere_ratio << ", covariance box " << box_ratio
              << ", box along the axes " << oriented(bounds_of(points)).volume() / smallest << "\n";
    spheres.add(sphere_ratio);
    boxes.add(box_ratio);
    EXPECT_LE(sphere_ratio, 1.2) << name;
    EXPECT_LE(box_ratio, 2.0) << name;
  }
  if (missing == measured_meshes.size()) GTEST_SKIP() << "no mesh has been fetched";
  spheres.print("Ritter, meshes");
  boxes.print("covariance box, meshes");
}

}  // namespace
}  // namespace vislab
