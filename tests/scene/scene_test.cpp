#include "common/scene/scene.h"

#include <gtest/gtest.h>

#include <limits>

#include "common/scene/generators/generators.h"
#include "tests/input_error.h"

namespace vislab {
namespace {

Scene cubes(std::uint32_t count) {
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  for (std::uint32_t i = 0; i < count; ++i) {
    scene.objects.push_back({0, box_transform({10.0 * i, 0.0, 0.0}, glm::dvec3(1.0)), none_id});
  }
  return scene;
}

std::string finish_error(Scene scene) {
  return input_error([&]() { scene.finish(); });
}

TEST(Scene, CountsTrianglesWithInstancesEach) {
  Scene scene = cubes(3);
  scene.finish();
  EXPECT_EQ(scene.object_count(), 3U);
  EXPECT_EQ(scene.triangle_count(), 36U);
  EXPECT_EQ(scene.first_triangle(2), 24U);
  EXPECT_EQ(scene.triangle_count(ObjectId{1}), 12U);
}

TEST(Scene, KnowsTheObjectOfEveryTriangle) {
  Scene scene = cubes(3);
  scene.finish();
  for (TriangleId t = 0; t < scene.triangle_count(); ++t) EXPECT_EQ(scene.object_of(t), t / 12);
}

TEST(Scene, BoundsEveryObjectWhereItStands) {
  Scene scene = cubes(3);
  scene.finish();
  EXPECT_TRUE(scene.bounds().contains({-1.0, -1.0, -1.0}));
  EXPECT_TRUE(scene.bounds().contains({21.0, 1.0, 1.0}));
  EXPECT_FALSE(scene.bounds().contains({21.1, 0.0, 0.0}));
}

TEST(Scene, KeepsTheWorldsOriginUnlessItLiesFarAway) {
  Scene near = cubes(2);
  near.finish();
  EXPECT_EQ(near.origin(), glm::dvec3(0.0));
  Scene remote = cubes(2);
  for (Object& object : remote.objects) object.transform[3] += glm::dvec3(1e7, 0.0, 0.0);
  remote.finish();
  EXPECT_EQ(remote.origin(), remote.bounds().center());
}

TEST(Scene, GivesTheCornersOfATriangleInTheWorld) {
  Scene scene = cubes(2);
  scene.finish();
  const auto corners = world_triangle(scene.meshes[0], scene.objects[1].transform, 0);
  EXPECT_EQ(corners[0], glm::dvec3(9.0, -1.0, -1.0));
}

TEST(Scene, HashesContentAndNotNames) {
  Scene first = cubes(2);
  first.finish();
  Scene renamed = cubes(2);
  renamed.name = "another";
  renamed.meshes[0].name = "another";
  renamed.finish();
  EXPECT_EQ(first.content_hash(), renamed.content_hash());
  EXPECT_EQ(first.content_hash().size(), 32U);

  Scene moved = cubes(2);
  moved.objects[1].transform[3].x += 1e-9;
  moved.finish();
  EXPECT_NE(first.content_hash(), moved.content_hash());
  Scene turned = cubes(2);
  std::swap(turned.meshes[0].triangles[0].x, turned.meshes[0].triangles[0].y);
  turned.finish();
  EXPECT_NE(first.content_hash(), turned.content_hash());
}

TEST(Scene, RefusesToBeEmpty) {
  EXPECT_TRUE(says(finish_error(Scene()), "no object"));
  Scene scene = cubes(1);
  scene.meshes[0].triangles.clear();
  EXPECT_TRUE(says(finish_error(scene), "no triangle"));
}

TEST(Scene, RefusesUsedVerticesThatAreNotFinite) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Scene scene = cubes(1);
    scene.meshes[0].positions[5].y = bad;
    EXPECT_TRUE(says(finish_error(scene), "vertex 5 is NaN or infinite"));
  }
}

TEST(Scene, RemovesAndCountsUnusedVerticesThatAreNotFinite) {
  Scene plain = cubes(1);
  plain.finish();
  Scene scene = cubes(1);
  Mesh& mesh = scene.meshes[0];
  mesh.positions.insert(mesh.positions.begin() + 3,
                        glm::vec3(std::numeric_limits<float>::quiet_NaN()));
  for (glm::uvec3& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) triangle[i] += triangle[i] >= 3 ? 1 : 0;
  }
  scene.finish();
  EXPECT_EQ(scene.report.unused_bad_vertices, 1U);
  EXPECT_EQ(scene.content_hash(), plain.content_hash());
}

TEST(Scene, KeepsAndCountsTrianglesWithoutArea) {
  Scene scene = cubes(1);
  Mesh& mesh = scene.meshes[0];
  mesh.positions.emplace_back(0.0F, -1.0F, -1.0F);
  mesh.triangles.emplace_back(0, 0, 1);
  mesh.triangles.emplace_back(0, 8, 1);  // in one line
  scene.finish();
  EXPECT_EQ(scene.report.zero_area_triangles, 2U);
  EXPECT_EQ(scene.triangle_count(), 14U);
}

TEST(Scene, RefusesScalesThatFloatCannotHandle) {
  const auto scaled = [](double at, double size) {
    Scene scene = cubes(1);
    scene.objects[0].transform = box_transform({at, 0.0, 0.0}, glm::dvec3(size));
    return scene;
  };
  EXPECT_TRUE(says(finish_error(scaled(1e13, 1.0)), "reaches to 1e+13 m"));
  EXPECT_TRUE(says(finish_error(scaled(-2e11, 1.0)), "at most 1e+11 m is allowed"));
  EXPECT_TRUE(says(finish_error(scaled(0.0, 1.1e11)), "at most 1e+11 m is allowed"));
  EXPECT_TRUE(says(finish_error(scaled(0.0, 1e-16)), "the scene is only 2e-16 m large"));
  EXPECT_TRUE(says(finish_error(scaled(0.0, 1e-12)), "at least 1e-11 m is needed"));
  for (Scene scene : {scaled(9e10, 1.0), scaled(0.0, 9e10), scaled(0.0, 1e-11)}) {
    EXPECT_NO_THROW(scene.finish());
  }
}

TEST(Scene, CountsMeshesThatAreNotClosed) {
  Scene scene = cubes(1);
  scene.meshes.push_back(cube_mesh());
  scene.meshes[1].triangles.pop_back();
  scene.objects.push_back({1, glm::dmat4x3(1.0), none_id});
  scene.finish();
  EXPECT_TRUE(scene.meshes[0].closed);
  EXPECT_FALSE(scene.meshes[1].closed);
  EXPECT_EQ(scene.report.open_meshes, 1U);
}

TEST(Scene, RefusesIndicesOutOfRange) {
  Scene vertex = cubes(1);
  vertex.meshes[0].triangles[7].y = 8;
  EXPECT_TRUE(says(finish_error(vertex), "triangle 7: vertex index 8 is out of range"));
  Scene mesh = cubes(1);
  mesh.objects[0].mesh = 1;
  EXPECT_TRUE(says(finish_error(mesh), "mesh 1 is out of range"));
  Scene cell = cubes(1);
  cell.objects[0].cell = 0;
  EXPECT_TRUE(says(finish_error(cell), "cell 0 is out of range"));
  Scene portal = cubes(1);
  portal.portals.push_back({{}, 0, 1});
  EXPECT_TRUE(says(finish_error(portal), "portal 0"));
}

TEST(Scene, AcceptsMirrors) {
  Scene scene = cubes(1);
  scene.objects[0].transform[0] *= -1.0;
  EXPECT_NO_THROW(scene.finish());
}

TEST(Scene, RefusesTransformsThatAreSingularOrNotFinite) {
  Scene flat = cubes(1);
  flat.objects[0].transform[1] = glm::dvec3(0.0);
  EXPECT_TRUE(says(finish_error(flat), "singular"));
  Scene broken = cubes(1);
  broken.objects[0].transform[3].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(says(finish_error(broken), "not finite"));
  Scene tiny = cubes(1);
  for (int axis = 0; axis < 3; ++axis) tiny.objects[0].transform[axis] *= 1e-6;
  EXPECT_NO_THROW(tiny.finish());
}

TEST(Scene, RefusesCoordinatesTooLargeForFloat) {
  Scene scene = cubes(1);
  scene.objects[0].transform[3].x = 1e39;
  EXPECT_TRUE(says(finish_error(scene), "too large"));
}

TEST(Scene, RefusesMoreTrianglesThanIdsCanName) {
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  Mesh& mesh = scene.meshes[0];
  mesh.triangles.resize(1U << 16U, mesh.triangles[0]);
  scene.objects.resize(1U << 16U);
  EXPECT_TRUE(says(finish_error(scene), "2^32"));
}

}  // namespace
}  // namespace vislab
