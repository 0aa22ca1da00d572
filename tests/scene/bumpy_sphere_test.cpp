#include <gtest/gtest.h>

#include <cmath>

#include "common/scene/generators/generators.h"

namespace vislab {
namespace {

Scene finished(const BumpySphereParameters& parameters) {
  Scene scene = make_bumpy_sphere(parameters);
  scene.finish();
  return scene;
}

BumpySphereParameters sphere_of(std::uint32_t subdivisions, Bumps bumps = Bumps::none) {
  BumpySphereParameters parameters;
  parameters.subdivisions = subdivisions;
  parameters.bumps = bumps;
  return parameters;
}

TEST(BumpySphere, IsASolidOfTwelveTrianglesASquare) {
  for (const Bumps bumps : {Bumps::none, Bumps::low, Bumps::high}) {
    for (const std::uint32_t n : {1U, 2U, 7U, 40U}) {
      const Scene scene = finished(sphere_of(n, bumps));
      const Mesh& mesh = scene.meshes[0];
      EXPECT_EQ(mesh.triangles.size(), 12 * n * n);
      EXPECT_EQ(mesh.positions.size(), 6 * n * n + 2);
      EXPECT_TRUE(mesh.closed);
      EXPECT_TRUE(mesh.solid);
      EXPECT_EQ(scene.report.zero_area_triangles, 0U);
    }
  }
}

TEST(BumpySphere, HasAMillionTrianglesInTheSizeOfThePublishedFigures) {
#ifdef __SANITIZE_ADDRESS__
  // Looking for self-intersections takes ten times as long then.
  EXPECT_EQ(bumpy_sphere_mesh(sphere_of(289, Bumps::high)).triangles.size(), 1'002'252U);
#else
  const Scene scene = finished(sphere_of(289, Bumps::high));
  EXPECT_EQ(scene.triangle_count(), 1'002'252U);
  EXPECT_TRUE(scene.meshes[0].solid);
#endif
}

TEST(BumpySphere, HasTheRadiiOfItsFormula) {
  const auto low = [](const glm::dvec3& p) {
    const double wide = std::sin(9.0 * p.x) * std::sin(8.0 * p.y + 1.0) * std::sin(7.0 * p.z + 2.0);
    return 1.0 + 0.05 * (wide + 0.4 * std::sin(23.0 * p.x + 3.0) * std::sin(21.0 * p.y));
  };
  const auto high = [](const glm::dvec3& p) {
    return 1.0 +
           0.02 * std::sin(60.0 * p.x) * std::sin(60.0 * p.y + 1.0) * std::sin(60.0 * p.z + 2.0);
  };
  const Mesh smooth_mesh = bumpy_sphere_mesh(sphere_of(24));
  const Mesh low_mesh = bumpy_sphere_mesh(sphere_of(24, Bumps::low));
  const Mesh high_mesh = bumpy_sphere_mesh(sphere_of(24, Bumps::high));
  for (std::size_t v = 0; v < smooth_mesh.positions.size(); ++v) {
    const glm::dvec3 unit(smooth_mesh.positions[v]);
    EXPECT_NEAR(glm::length(unit), 1.0, 1e-7);
    EXPECT_NEAR(glm::length(glm::dvec3(low_mesh.positions[v])), low(unit), 1e-5);
    EXPECT_NEAR(glm::length(glm::dvec3(high_mesh.positions[v])), high(unit), 1e-5);
  }
  EXPECT_EQ(low_mesh.triangles, smooth_mesh.triangles);
  // By hand: at (0, 1, 0) the low bumps are 0.05 (0 + 0.4 sin 3 sin 21).
  for (std::size_t v = 0; v < smooth_mesh.positions.size(); ++v) {
    if (smooth_mesh.positions[v] == glm::vec3(0.0F, 1.0F, 0.0F)) {
      EXPECT_NEAR(low_mesh.positions[v].y, 1.0 + 0.05 * 0.4 * 0.1411200081 * 0.8366556385, 1e-7);
    }
  }
}

TEST(BumpySphere, IsTheSameEveryTime) {
  const std::string hash = finished(sphere_of(20, Bumps::low)).content_hash();
  EXPECT_EQ(finished(sphere_of(20, Bumps::low)).content_hash(), hash);
  EXPECT_NE(finished(sphere_of(20, Bumps::high)).content_hash(), hash);
}

TEST(BumpySphere, GoesThroughTheSquaresOfASideInRows) {
  const Mesh mesh = bumpy_sphere_mesh(sphere_of(16));
  for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 2) {
    if (t % 32 == 30) continue;  // the end of a row
    const glm::uvec3 here = mesh.triangles[t];
    const glm::uvec3 next = mesh.triangles[t + 2];
    EXPECT_EQ(mesh.triangles[t + 1].x, here.x);
    EXPECT_EQ(mesh.triangles[t + 1].z, next.x);  // the next square is beside it
  }
}

TEST(BumpySphere, AHoleHasItsShareOfTheSurface) {
  double whole = 0.0;
  for (const double hole : {0.0, 0.001, 0.01, 0.1, 0.3, 0.5, 0.9}) {
    BumpySphereParameters parameters = sphere_of(64);
    parameters.hole = hole;
    const Scene scene = finished(parameters);
    const Mesh& mesh = scene.meshes[0];
    double area = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 a(mesh.positions[t.x]);
      area += 0.5 * glm::length(glm::cross(glm::dvec3(mesh.positions[t.y]) - a,
                                           glm::dvec3(mesh.positions[t.z]) - a));
    }
    if (hole == 0.0) whole = area;
    EXPECT_NEAR(1.0 - area / whole, hole, 0.02 * hole + 2e-4) << hole;
    EXPECT_EQ(mesh.closed, hole == 0.0);
    EXPECT_FALSE(mesh.solid && hole > 0.0);
    // The cap is about +x, and nothing is left over that no triangle uses.
    EXPECT_LE(mesh.bounds.max.x, std::max(1.0 - 2.0 * hole, 0.0) + 0.06);
    EXPECT_EQ(mesh.bounds.min, bounds_of(mesh.positions).min);
    EXPECT_EQ(mesh.bounds.max, bounds_of(mesh.positions).max);
  }
}

TEST(BumpySphere, AnOffsetOfTheMeshLeavesItWhereItIsInTheWorld) {
  for (const double offset : {1.0, 100.0, 10'000.0}) {
    BumpySphereParameters parameters = sphere_of(16, Bumps::low);
    const Scene plain = finished(parameters);
    parameters.mesh_offset = {offset, -0.5 * offset, 0.25 * offset};
    const Scene moved = finished(parameters);
    EXPECT_NEAR(moved.meshes[0].bounds.center().x, offset, 0.1 + 1e-6 * offset);
    EXPECT_TRUE(moved.meshes[0].solid) << offset;
    for (std::uint32_t t = 0; t < plain.triangle_count(); t += 7) {
      const auto here = world_triangle(plain.meshes[0], plain.objects[0].transform, t);
      const auto there = world_triangle(moved.meshes[0], moved.objects[0].transform, t);
      for (std::size_t corner = 0; corner < 3; ++corner) {
        EXPECT_LE(glm::length(here[corner] - there[corner]), 2e-7 + 1.1e-7 * offset);
      }
    }
  }
}

}  // namespace
}  // namespace vislab
