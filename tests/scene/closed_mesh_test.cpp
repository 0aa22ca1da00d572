#include <gtest/gtest.h>

#include "common/scene/generators/generators.h"
#include "common/scene/scene.h"
#include "tests/scene/test_meshes.h"

namespace vislab {
namespace {

TEST(ClosedMesh, ACubeIsClosed) { EXPECT_TRUE(is_closed_outward(cube_mesh())); }

TEST(ClosedMesh, ACubeWithAHoleIsNot) {
  for (std::size_t t = 0; t < 12; ++t) {
    Mesh mesh = cube_mesh();
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
    EXPECT_FALSE(is_closed_outward(mesh));
  }
}

TEST(ClosedMesh, AnInvertedCubeIsNotOutward) {
  EXPECT_FALSE(is_closed_outward(inverted(cube_mesh())));
}

TEST(ClosedMesh, OneTurnedTriangleIsFound) {
  Mesh mesh = cube_mesh();
  std::swap(mesh.triangles[4].x, mesh.triangles[4].y);
  EXPECT_FALSE(is_closed_outward(mesh));
}

TEST(ClosedMesh, TwoCubesAreClosedAndOneInvertedAmongThemIsFound) {
  Mesh both = cube_mesh();
  append(both, cube_mesh(), {5.0F, 0.0F, 0.0F});
  EXPECT_TRUE(is_closed_outward(both));
  // The large one outweighs the inverted one, so that the parts must be looked at one by one.
  Mesh mixed = cube_mesh();
  for (glm::vec3& p : mixed.positions) p *= 3.0F;
  append(mixed, inverted(cube_mesh()), {10.0F, 0.0F, 0.0F});
  EXPECT_FALSE(is_closed_outward(mixed));
}

TEST(ClosedMesh, TakesVerticesAtEqualPositionsAsOne) {
  EXPECT_TRUE(is_closed_outward(with_split_vertices(cube_mesh())));
}

TEST(ClosedMesh, PassesOverTrianglesThatAreCollapsed) {
  Mesh mesh = cube_mesh();
  mesh.triangles.emplace_back(0, 1, 1);
  EXPECT_TRUE(is_closed_outward(mesh));
}

TEST(ClosedMesh, AnEdgeOfFourTrianglesIsNotASurface) {
  Mesh mesh = cube_mesh();
  append(mesh, cube_mesh(), {2.0F, 2.0F, 0.0F});  // they touch along an edge
  EXPECT_FALSE(is_closed_outward(mesh));
}

TEST(ClosedMesh, IsTrueFarFromTheOrigin) {
  Mesh mesh;
  append(mesh, cube_mesh(), glm::vec3(4096.0F));
  EXPECT_TRUE(is_closed_outward(mesh));
}

}  // namespace
}  // namespace vislab
