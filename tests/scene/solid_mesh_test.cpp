#include "common/scene/solid_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/scene/generators/generators.h"
#include "tests/scene/repository_data.h"
#include "tests/scene/test_meshes.h"

namespace vislab {
namespace {

/// The mesh as a scene holds it: finish() fills what it knows of it.
Mesh finished(Mesh mesh) {
  Scene scene;
  scene.meshes = {std::move(mesh)};
  scene.objects = {Object{}};
  scene.finish();
  return scene.meshes[0];
}

bool solid(const Mesh& mesh) { return finished(mesh).solid; }

/// Two cubes from -1 to 1, the second one moved.
Mesh two_cubes(const glm::vec3& offset) {
  Mesh mesh = cube_mesh();
  append(mesh, cube_mesh(), offset);
  return mesh;
}

/// A sphere of radius 1 in `rings` bands of twice as many sectors.
Mesh sphere(int rings) {
  Mesh mesh;
  const int sectors = 2 * rings;
  for (int ring = 1; ring < rings; ++ring) {
    const double polar = std::numbers::pi * ring / rings;
    for (int sector = 0; sector < sectors; ++sector) {
      const double around = std::numbers::pi * sector / rings;
      mesh.positions.emplace_back(std::sin(polar) * std::cos(around), std::cos(polar),
                                  -std::sin(polar) * std::sin(around));
    }
  }
  const auto top = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.emplace_back(0.0F, 1.0F, 0.0F);
  mesh.positions.emplace_back(0.0F, -1.0F, 0.0F);
  const auto at = [&](int ring, int sector) {
    return static_cast<std::uint32_t>((ring - 1) * sectors + sector % sectors);
  };
  for (int sector = 0; sector < sectors; ++sector) {
    mesh.triangles.emplace_back(top, at(1, sector), at(1, sector + 1));
    mesh.triangles.emplace_back(top + 1, at(rings - 1, sector + 1), at(rings - 1, sector));
    for (int ring = 1; ring + 1 < rings; ++ring) {
      const std::uint32_t a = at(ring, sector), b = at(ring + 1, sector);
      const std::uint32_t c = at(ring + 1, sector + 1), d = at(ring, sector + 1);
      mesh.triangles.emplace_back(a, b, c);
      mesh.triangles.emplace_back(a, c, d);
    }
  }
  return mesh;
}

TEST(SolidMesh, ACubeAndASphereAreSolid) {
  EXPECT_TRUE(solid(cube_mesh()));
  EXPECT_TRUE(solid(sphere(12)));
}

TEST(SolidMesh, OpenAndInvertedMeshesAreNotSolid) {
  Mesh open = cube_mesh();
  open.triangles.pop_back();
  EXPECT_FALSE(solid(open));
  EXPECT_FALSE(solid(inverted(cube_mesh())));
}

TEST(SolidMesh, SaysWhatIsClosedAndOutwardAsExactArithmeticDoes) {
  const Mesh ball = sphere(8);
  Mesh open = ball;
  open.triangles.pop_back();
  Mesh one_turned = two_cubes({5.0F, 0.0F, 0.0F});
  append(one_turned, inverted(ball), {-5.0F, 0.0F, 0.0F});
  Mesh hollow = ball;
  append(hollow, inverted(ball), glm::vec3(0.0F), 0.5F);
  Mesh thin;
  append(thin, ball, glm::vec3(0.0F));
  for (glm::vec3& p : thin.positions) p.y *= 1e-20F;
  const std::pair<const Mesh*, bool> expected[] = {
      {&ball, true}, {&open, false}, {&one_turned, false}, {&hollow, false}, {&thin, true}};
  for (const auto& [mesh, is_expected] : expected) {
    EXPECT_EQ(is_closed_outward(*mesh), is_expected);
    EXPECT_EQ(is_solid(*mesh), is_expected);
  }
  EXPECT_FALSE(is_solid(inverted(thin)));
  Mesh nothing = ball;
  nothing.triangles = {{0, 0, 1}};
  EXPECT_FALSE(is_solid(nothing));
}

TEST(SolidMesh, SeparateAndNestedCubesAreSolid) {
  EXPECT_TRUE(solid(two_cubes({5.0F, 0.0F, 0.0F})));
  EXPECT_TRUE(solid(two_cubes({std::nextafter(2.0F, 3.0F), 0.0F, 0.0F})));  // the next float
  Mesh nested = cube_mesh();
  append(nested, cube_mesh(), glm::vec3(0.0F), 0.5F);
  EXPECT_TRUE(solid(nested));
}

TEST(SolidMesh, OverlappingCubesAreClosedButNotSolid) {
  const Mesh mesh = finished(two_cubes({0.5F, 0.25F, 0.125F}));
  EXPECT_TRUE(mesh.closed);
  EXPECT_FALSE(mesh.solid);
}

TEST(SolidMesh, CubesThatTouchAreNotSolid) {
  EXPECT_FALSE(solid(two_cubes({2.0F, 0.25F, 0.125F})));  // parts of two sides
  EXPECT_FALSE(solid(two_cubes({2.0F, 2.0F, 0.5F})));     // parts of two edges
  EXPECT_FALSE(solid(two_cubes({2.0F, 0.0F, 0.0F})));     // a whole side
  EXPECT_FALSE(solid(two_cubes({2.0F, 2.0F, 0.0F})));     // a whole edge
}

TEST(SolidMesh, CubesThatTouchInACornerAreNotSolid) {
  const Mesh corners = finished(two_cubes({2.0F, 2.0F, 2.0F}));
  EXPECT_TRUE(corners.closed);
  EXPECT_FALSE(corners.solid);
  Mesh mixed = corners;  // in another order, so that both cubes are there before one is closed
  std::stable_partition(mixed.triangles.begin(), mixed.triangles.end(),
                        [](const glm::uvec3& triangle) { return triangle.x % 3 == 0; });
  EXPECT_FALSE(solid(mixed));
}

TEST(SolidMesh, ADentThatGoesThroughTheOtherSideIsFound) {
  for (const float depth : {0.5F, 1.0F, 1.5F}) {
    Mesh mesh = sphere(12);
    // The top vertex is pushed down the axis: 0.5 leaves a dent, the bottom is at -1.
    glm::vec3& top = mesh.positions[mesh.positions.size() - 2];
    top.y -= 2.0F * depth;
    const Mesh dented = finished(mesh);
    EXPECT_TRUE(dented.closed) << depth;
    EXPECT_EQ(dented.solid, depth < 1.0F) << depth;
  }
}

TEST(SolidMesh, TakesVerticesAtEqualPositionsAsOne) {
  EXPECT_TRUE(solid(with_split_vertices(cube_mesh())));
}

TEST(SolidMesh, PassesOverTrianglesThatAreCollapsed) {
  Mesh mesh = cube_mesh();
  mesh.triangles.emplace_back(0, 0, 1);
  EXPECT_TRUE(solid(mesh));
}

TEST(SolidMesh, ATriangleAlongALineThatTheSurfaceNeedsIsNotSolid) {
  // The triangle on one side of an edge is cut in two at the edge's middle, the other is not; a
  // triangle without area closes the gap.
  Mesh mesh = cube_mesh();
  const glm::uvec3 cut = mesh.triangles[0];
  const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back((mesh.positions[cut.x] + mesh.positions[cut.y]) * 0.5F);
  mesh.triangles[0] = {cut.x, middle, cut.z};
  mesh.triangles.emplace_back(middle, cut.y, cut.z);
  mesh.triangles.emplace_back(cut.x, cut.y, middle);
  const Mesh closed = finished(mesh);
  EXPECT_TRUE(closed.closed);
  EXPECT_FALSE(closed.solid);
  mesh.triangles.emplace_back(cut.x, middle, cut.y);  // one too many on the line
  EXPECT_FALSE(solid(mesh));
}

TEST(SolidMesh, IsTrueAtAnySizeAndFarFromTheOrigin) {
  for (const float scale : {1e-30F, 1e-6F, 1e6F, 1e30F}) {
    Mesh mesh;
    append(mesh, sphere(6), glm::vec3(0.0F), scale);
    EXPECT_TRUE(is_solid(mesh)) << scale;
    append(mesh, cube_mesh(), glm::vec3(0.0F), 0.9F * scale);
    EXPECT_FALSE(is_solid(mesh)) << scale;
  }
  Mesh mesh;
  append(mesh, cube_mesh(), glm::vec3(65536.0F));
  EXPECT_TRUE(solid(mesh));
}

TEST(SolidMesh, ASceneCountsMeshesThatIntersectThemselves) {
  Scene scene;
  scene.meshes = {cube_mesh(), two_cubes({0.5F, 0.5F, 0.5F}), cube_mesh()};
  scene.meshes[2].triangles.pop_back();
  scene.objects = {Object{}};
  scene.finish();
  EXPECT_EQ(scene.report.self_intersecting_meshes, 1U);
  EXPECT_EQ(scene.report.open_meshes, 1U);
}

TEST(SolidMesh, OfTheRealMeshesCowAndManIntersectThemselves) {
  const std::pair<std::string, bool> expected[] = {
      {"bunny", true}, {"elephant", true}, {"elephant_refined", true},
      {"hare", true},  {"cow", false},     {"man", false}};
  for (const auto& [name, is_solid] : expected) {
    const Scene scene = load_scene(name, test::repository_data()).scene;
    EXPECT_TRUE(scene.meshes[0].closed) << name;
    EXPECT_EQ(scene.meshes[0].solid, is_solid) << name;
    EXPECT_EQ(scene.report.self_intersecting_meshes, is_solid ? 0U : 1U) << name;
  }
}

}  // namespace
}  // namespace vislab
