#include "common/scene/generators/generators.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "common/geometry/frustum.h"

namespace vislab {
namespace {

TEST(BoxField, HasItsBoxesInItsCubeAndNoneWhereCamerasStand) {
  BoxFieldParameters parameters;
  parameters.count = 500;
  parameters.extent_m = 20.0;
  Scene scene = make_box_field(parameters);
  scene.finish();
  EXPECT_EQ(scene.object_count(), 500U);
  EXPECT_EQ(scene.meshes.size(), 1U);
  EXPECT_TRUE(scene.meshes[0].closed);
  for (const Object& object : scene.objects) {
    const Aabb box = transformed(scene.meshes[0].bounds, object.transform);
    EXPECT_GE(std::sqrt(distance_squared(box, glm::dvec3(0.0))), 4.99);
    for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(object.transform[3][axis]), 20.0);
  }
}

TEST(BoxField, DependsOnItsSeedAndNothingElse) {
  BoxFieldParameters parameters;
  parameters.count = 50;
  const auto hash_of = [&]() {
    Scene scene = make_box_field(parameters);
    scene.finish();
    return scene.content_hash();
  };
  const std::string first = hash_of();
  EXPECT_EQ(hash_of(), first);
  parameters.seed = 2;
  EXPECT_NE(hash_of(), first);
}

TEST(BoxField, AMillionBoxesShareOneMesh) {
  BoxFieldParameters parameters;
  parameters.count = 1'000'000;
  Scene scene = make_box_field(parameters);
  scene.finish();
  EXPECT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.triangle_count(), 12'000'000U);
  EXPECT_EQ(scene.object_of(11'999'999U), 999'999U);
}

TEST(BoxField, ABoxOfNoHeightIsItsUpperFaceAndAnyOtherIsClosed) {
  const Mesh upper = box_mesh({2.0, 0.0, 0.5}, 3, 1.0);
  EXPECT_EQ(upper.triangles.size(), 18U);
  EXPECT_EQ(upper.positions.size(), 16U);
  const Mesh box = box_mesh({2.0, 1.0, 0.5}, 3, 9.0);
  EXPECT_EQ(box.triangles.size(), 108U);
  EXPECT_EQ(box.positions.size(), 56U);
  EXPECT_TRUE(is_closed_outward(box));
}

TEST(Hares, AreDealtOutwardAlongTheAxes) {
  HaresParameters parameters;
  parameters.count = 14;
  Scene scene = make_hares(cube_mesh(), parameters);
  scene.finish();
  ASSERT_EQ(scene.object_count(), 14U);
  EXPECT_EQ(scene.meshes.size(), 1U);
  std::set<std::string> seen;
  for (const Object& object : scene.objects) {
    const glm::dvec3 p = object.transform[3];
    int axes = 0;
    for (int axis = 0; axis < 3; ++axis) axes += p[axis] != 0.0 ? 1 : 0;
    EXPECT_EQ(axes, 1);
    seen.insert(std::to_string(p.x) + "," + std::to_string(p.y) + "," + std::to_string(p.z));
  }
  EXPECT_EQ(seen.size(), 14U);
  EXPECT_EQ(scene.objects[0].transform[3], glm::dvec3(2.0, 0.0, 0.0));
  EXPECT_EQ(scene.objects[13].transform[3], glm::dvec3(-6.0, 0.0, 0.0));
  EXPECT_NEAR(scene.bounds().max.x, 6.5, 1e-5);
}

TEST(Asteroid, IsASolidWithTheVerticesOfItsDetail) {
  for (const std::uint32_t detail : {4U, 8U, 64U}) {
    for (const double relief : {0.0, 0.3, 0.9}) {
      SCOPED_TRACE(detail);
      Scene scene;
      scene.meshes.push_back(asteroid_mesh(detail, relief, 5));
      scene.objects.push_back({0, glm::dmat4x3(1.0), none_id});
      scene.finish();
      const Mesh& mesh = scene.meshes[0];
      EXPECT_EQ(mesh.positions.size(), (detail + 1) * (detail + 1));
      EXPECT_EQ(mesh.triangles.size(), 2 * detail * (detail - 1));
      EXPECT_TRUE(mesh.closed);
      EXPECT_TRUE(mesh.solid);
      EXPECT_EQ(scene.report.zero_area_triangles, 0U);
      float least = 2.0F;
      float most = 0.0F;
      for (const glm::vec3& p : mesh.positions) {
        least = std::min(least, glm::length(p));
        most = std::max(most, glm::length(p));
      }
      EXPECT_GE(least, 1.0 - relief - 1e-6);
      EXPECT_LE(most, 1.0 + relief + 1e-6);
      if (relief > 0.0) {
        EXPECT_GT(most - least, 0.5 * relief);
      }
    }
  }
}

TEST(AsteroidBelt, LiesInItsRing) {
  AsteroidBeltParameters parameters;
  parameters.count = 300;
  parameters.detail = 8;
  parameters.shapes = 5;
  parameters.height_m = 200.0;
  Scene scene = make_asteroid_belt(parameters);
  scene.finish();
  EXPECT_EQ(scene.object_count(), 300U);
  EXPECT_EQ(scene.meshes.size(), 5U);
  std::set<MeshId> shapes;
  for (const Object& object : scene.objects) {
    shapes.insert(object.mesh);
    const glm::dvec3 p = object.transform[3];
    EXPECT_LE(std::abs(std::hypot(p.x, p.z) - 1000.0), 150.0 + 1e-9);
    EXPECT_LE(std::abs(p.y - 200.0), 30.0);
    const double size = glm::length(object.transform[0]);
    EXPECT_GE(size, 4.0 - 1e-9);
    EXPECT_LE(size, 20.0 + 1e-9);
    EXPECT_NEAR(glm::determinant(glm::dmat3(object.transform)), size * size * size, 1e-6);
  }
  EXPECT_EQ(shapes.size(), 5U);
  parameters.seed = 2;
  Scene other = make_asteroid_belt(parameters);
  other.finish();
  EXPECT_NE(other.content_hash(), scene.content_hash());
}

TEST(AsteroidBelt, LiesAboveTheMiddleOfItsSceneBetweenBeacons) {
  AsteroidBeltParameters parameters;
  parameters.count = 100;
  parameters.detail = 4;
  parameters.height_m = 200.0;
  parameters.beacon_height_m = 300.0;
  Scene scene = make_asteroid_belt(parameters);
  scene.finish();
  EXPECT_EQ(scene.object_count(), 102U);
  EXPECT_NEAR(scene.bounds().center().y, 0.0, 1e-4);
  for (ObjectId id = 0; id < 100; ++id) EXPECT_GT(scene.objects[id].transform[3].y, 100.0);
}

TEST(House, HasTheTrianglesThatAreAskedForAndIsSolid) {
  for (std::uint32_t triangles = 8; triangles <= 2026; triangles += triangles < 200 ? 2 : 46) {
    SCOPED_TRACE(triangles);
    Scene scene;
    scene.meshes.push_back(house_mesh(triangles, triangles));
    scene.objects.push_back({0, glm::dmat4x3(1.0), none_id});
    scene.finish();
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.triangles.size(), triangles);
    EXPECT_EQ(mesh.positions.size(), triangles / 2 + 2);  // Euler: one surface, no hole
    EXPECT_TRUE(mesh.solid);
    EXPECT_EQ(scene.report.zero_area_triangles, 0U);
    EXPECT_EQ(mesh.bounds.min.y, 0.0F);
    EXPECT_LE(mesh.bounds.half_size().x, 8.5);
    EXPECT_LE(mesh.bounds.half_size().z, 7.0);
  }
}

TEST(Houses, StandApartAndHaveTrianglesOfTheirRange) {
  HousesParameters parameters;
  parameters.min_triangles = 118;
  parameters.max_triangles = 2026;
  Scene scene = make_houses(parameters);
  scene.finish();
  ASSERT_EQ(scene.object_count(), 100U);
  std::set<std::size_t> counts;
  for (ObjectId a = 0; a < 100; ++a) {
    const std::size_t triangles = scene.mesh_of(a).triangles.size();
    EXPECT_GE(triangles, 118U);
    EXPECT_LE(triangles, 2026U);
    counts.insert(triangles);
    const Aabb box = transformed(scene.mesh_of(a).bounds, scene.objects[a].transform);
    for (ObjectId b = 0; b < a; ++b) {
      const Aabb other = transformed(scene.mesh_of(b).bounds, scene.objects[b].transform);
      EXPECT_TRUE(box.max.x < other.min.x || box.min.x > other.max.x || box.max.z < other.min.z ||
                  box.min.z > other.max.z);
    }
  }
  EXPECT_GT(counts.size(), 70U);
}

TEST(RibbedSphere, HasThePumpkinsTrianglesAndVertices) {
  Scene scene;
  scene.meshes.push_back(ribbed_sphere_mesh(100, 50, 10));
  scene.objects.push_back({0, glm::dmat4x3(1.0), none_id});
  scene.finish();
  EXPECT_EQ(scene.meshes[0].triangles.size(), 10'000U);
  EXPECT_EQ(scene.meshes[0].positions.size(), 5'002U);
  EXPECT_TRUE(scene.meshes[0].solid);
}

TEST(BoxMesh, IsDenserAtOneCornerByTheRatio) {
  for (const double ratio : {1.0, 100.0}) {
    const Mesh mesh = box_mesh({2.0, 1.0, 0.5}, 10, ratio);
    EXPECT_EQ(mesh.triangles.size(), 6U * 10U * 10U * 2U);
    EXPECT_EQ(mesh.positions.size(), mesh.triangles.size() / 2 + 2);
    EXPECT_TRUE(is_closed_outward(mesh));
    double smallest = 1e9;
    double largest = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 a(mesh.positions[t.x]);
      const glm::dvec3 normal =
          glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
      if (normal.z <= 0.0) continue;  // the face z = +0.5 alone
      smallest = std::min(smallest, glm::length(normal));
      largest = std::max(largest, glm::length(normal));
    }
    EXPECT_NEAR(largest / smallest, ratio, 1e-3 * ratio);
  }
}

TEST(MeshField, ScalesItsInstancesByTheirLongestSide) {
  BoxFieldParameters parameters;
  parameters.count = 50;
  parameters.extent_m = 60.0;
  parameters.rotated = true;
  Mesh slab = box_mesh({4.0, 1.0, 2.0}, 1, 1.0);
  for (glm::vec3& p : slab.positions) p += glm::vec3(7.0F, 0.0F, 0.0F);
  const Scene scene = make_mesh_field(slab, parameters);
  ASSERT_EQ(scene.object_count(), 50U);
  for (const Object& object : scene.objects) {
    const double half = 4.0 * glm::length(object.transform[0]);
    EXPECT_GE(half, 0.2 - 1e-9);
    EXPECT_LE(half, 2.0 + 1e-9);
    EXPECT_NEAR(glm::length(object.transform[1]), glm::length(object.transform[0]), 1e-12);
    const glm::dvec3 middle = object.transform * glm::dvec4(7.0, 0.0, 0.0, 1.0);
    for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(middle[axis]), 60.0 + 1e-9);
    EXPECT_GT(glm::length(middle), 5.0);
  }
}

TEST(City, HasThePeersBuildings) {
  Scene scene = make_city(CityParameters());
  scene.finish();
  EXPECT_EQ(scene.object_count(), 2000U);
  EXPECT_EQ(scene.triangle_count(), 24'000U);
  int towers = 0;
  for (const Object& object : scene.objects) {
    const double height = 2.0 * object.transform[1][1];
    EXPECT_NEAR(object.transform[3].y, 0.5 * height, 1e-12);
    towers += height >= 40.0 ? 1 : 0;
    EXPECT_TRUE((height >= 8.0 && height <= 30.0) || (height >= 40.0 && height <= 80.0));
  }
  EXPECT_GT(towers, 120);
  EXPECT_LT(towers, 280);
}

TEST(City, KeepsTheMiddleOfEveryStreetFree) {
  CityParameters parameters;
  parameters.blocks_x = 5;
  parameters.blocks_z = 4;
  parameters.street_boxes = 300;
  parameters.roof_share = 0.5;
  Scene scene = make_city(parameters);
  scene.finish();
  EXPECT_EQ(scene.object_count(), 320U);
  EXPECT_EQ(scene.meshes.size(), 2U);
  EXPECT_TRUE(scene.meshes[1].closed);
  EXPECT_EQ(scene.meshes[1].triangles.size(), 16U);
  for (ObjectId id = 0; id < scene.object_count(); ++id) {
    const Aabb box = transformed(scene.mesh_of(id).bounds, scene.objects[id].transform);
    for (int street = 0; street <= 5; ++street) {
      const double x = (street - 2.5) * 25.0;
      EXPECT_TRUE(box.max.x < x - 0.99 || box.min.x > x + 0.99);
    }
    for (int street = 0; street <= 4; ++street) {
      const double z = (street - 2.0) * 25.0;
      EXPECT_TRUE(box.max.z < z - 0.99 || box.min.z > z + 0.99);
    }
  }
}

TEST(RoomRing, JoinsItsCellsByPortalsInBothDirections) {
  RoomRingParameters parameters;
  parameters.rooms = 7;
  parameters.boxes_per_room = 3;
  Scene scene = make_room_ring(parameters);
  scene.finish();
  EXPECT_EQ(scene.cells.size(), 7U);
  EXPECT_EQ(scene.object_count(), 7U * 4U);
  ASSERT_EQ(scene.portals.size(), 14U);
  for (const Portal& portal : scene.portals) {
    const std::uint32_t step = (portal.to + 7U - portal.from) % 7U;
    EXPECT_TRUE(step == 1 || step == 6);
    // Counter-clockwise seen from the cell it leads out of: that cell is inside its plane.
    const Plane plane = plane_through(portal.polygon[0], portal.polygon[1], portal.polygon[2]);
    EXPECT_GT(plane.signed_distance(scene.cells[portal.from].bounds.center()), 0.0);
    EXPECT_LT(plane.signed_distance(scene.cells[portal.to].bounds.center()), 0.0);
  }
}

TEST(RoomRing, ClosesUpIntoOneSurfaceThatFacesInward) {
  RoomRingParameters parameters;
  parameters.rooms = 5;
  parameters.boxes_per_room = 0;
  const Scene scene = make_room_ring(parameters);
  Mesh all;
  for (const Object& object : scene.objects) {
    const Mesh& mesh = scene.meshes[object.mesh];
    const auto base = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const glm::uvec3& t : mesh.triangles) all.triangles.push_back(t + base);
  }
  EXPECT_FALSE(is_closed_outward(all));
  for (glm::uvec3& t : all.triangles) std::swap(t.x, t.y);
  EXPECT_TRUE(is_closed_outward(all));
}

}  // namespace
}  // namespace vislab
