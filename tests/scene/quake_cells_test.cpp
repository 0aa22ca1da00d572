#include "common/scene/quake_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "common/geometry/random.h"
#include "common/scene/orientation.h"
#include "common/scene/quake_gaps.h"
#include "common/scene/quake_leaves.h"
#include "tests/input_error.h"

namespace vislab {
namespace {

using Cells = QuakeCellLimits::Cells;

Aabb box_of(const glm::vec3& low, const glm::vec3& high) {
  Aabb box;
  box.extend(low);
  box.extend(high);
  return box;
}

Aabb box_of(const LeafShapes& shapes, std::uint32_t leaf) {
  Aabb box;
  for (const std::uint32_t face : shapes.faces_of_leaf[leaf]) {
    for (const glm::dvec3& corner : shapes.faces[face].polygon) box.extend(glm::vec3(corner));
  }
  return box;
}

/// Twice the outward areas of a leaf's faces, added up: zero if the shape is closed.
glm::dvec3 gap(const LeafShapes& shapes, std::uint32_t leaf) {
  glm::dvec3 sum(0.0);
  for (const std::uint32_t id : shapes.faces_of_leaf[leaf]) {
    const LeafFace& face = shapes.faces[id];
    if (face.front == face.back) continue;  // within what is solid
    sum += area_vector(face.polygon) * (face.front == leaf ? -1.0 : 1.0);
  }
  return sum;
}

double volume(const LeafShapes& shapes, std::uint32_t leaf) {
  double sum = 0.0;
  for (const std::uint32_t id : shapes.faces_of_leaf[leaf]) {
    const LeafFace& face = shapes.faces[id];
    if (face.front == face.back) continue;
    const double cone = glm::dot(area_vector(face.polygon), face.polygon[0]) / 6.0;
    sum += face.front == leaf ? -cone : cone;
  }
  return sum;
}

const Aabb room = box_of({-2, 0, -2}, {2, 3, 2});

/// A room in solid matter, divided by each of the planes in turn, all over. Leaf 0 is solid; the
/// others are open, each its own cluster. Boxes are those of the shapes.
QuakeWorld divided_room(const std::vector<Plane>& splits) {
  QuakeWorld world;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 normal(0.0);
    normal[axis] = 1.0;
    world.planes.push_back({normal, -room.min[axis]});
    world.planes.push_back({-normal, room.max[axis]});
  }
  world.planes.insert(world.planes.end(), splits.begin(), splits.end());
  world.leaves.push_back({-1, -1, {}, none_id});
  const auto below = [&](auto& self, std::uint32_t plane) -> std::int32_t {
    if (plane == world.planes.size()) {
      const auto cluster = static_cast<std::int32_t>(world.cluster_count++);
      world.leaves.push_back({cluster, 0, {}, none_id});
      return -static_cast<std::int32_t>(world.leaves.size());
    }
    const auto node = static_cast<std::int32_t>(world.nodes.size());
    world.nodes.push_back({plane, 0, -1});
    const std::int32_t front = self(self, plane + 1);
    world.nodes[static_cast<std::size_t>(node)].front = front;
    if (plane >= 6) {
      const std::int32_t back = self(self, plane + 1);
      world.nodes[static_cast<std::size_t>(node)].back = back;
    }
    return node;
  };
  below(below, 0);
  const LeafShapes shapes = shapes_of_leaves(world, room);
  for (std::uint32_t leaf = 1; leaf < world.leaves.size(); ++leaf) {
    if (!shapes.faces_of_leaf[leaf].empty()) world.leaves[leaf].bounds = box_of(shapes, leaf);
  }
  return world;
}

std::vector<Plane> random_planes(int count) {
  Random random(5);
  std::vector<Plane> planes;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 normal = random_direction(random);
    const glm::dvec3 through(random.uniform(-1.5, 1.5), random.uniform(0.5, 2.5),
                             random.uniform(-1.5, 1.5));
    planes.push_back({normal, -glm::dot(normal, through)});
  }
  return planes;
}

const Plane at_x0{{1, 0, 0}, 0};
const Plane at_z1{{0, 0, 1}, -1};

TEST(LeafShapes, FillTheWorldsBoxAndAreClosed) {
  const QuakeWorld world = divided_room(random_planes(6));
  const LeafShapes shapes = shapes_of_leaves(world, room);
  double sum = 0.0;
  double of_room = 0.0;
  for (std::uint32_t leaf = 0; leaf < world.leaves.size(); ++leaf) {
    const double own = volume(shapes, leaf);
    EXPECT_GE(own, 0.0) << leaf;
    EXPECT_LT(glm::length(gap(shapes, leaf)), 1e-9) << leaf;
    sum += own;
    if (leaf > 0) of_room += own;
  }
  EXPECT_NEAR(of_room, 4.0 * 3.0 * 4.0, 1e-9);
  EXPECT_NEAR(sum, 6.0 * 5.0 * 6.0, 1e-9);  // a metre more to all sides
}

TEST(LeafShapes, HoldThePointsThatTheTreePutsThere) {
  const QuakeWorld world = divided_room(random_planes(6));
  const QuakeCells found = find_quake_cells(world, room, {});
  Random random(9);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 point(random.uniform(-2.5, 2.5), random.uniform(-0.5, 3.5),
                           random.uniform(-2.5, 2.5));
    const CellId cell = found.cell_of_leaf[world.leaf_at(point)];
    for (CellId other = 0; other < found.cells.size(); ++other) {
      const bool inside =
          std::ranges::all_of(found.cells[other].regions.front().planes,
                              [&](const Plane& p) { return p.signed_distance(point) >= 0.0; });
      EXPECT_EQ(inside, other == cell);
    }
  }
}

TEST(LeafShapes, ShareTheFaceInWhichTheyTouch) {
  const QuakeWorld world = divided_room({at_x0});
  const LeafShapes shapes = shapes_of_leaves(world, room);
  int between = 0;
  for (const LeafFace& face : shapes.faces) {
    if (face.front != 1 || face.back != 2) continue;
    ++between;
    EXPECT_NEAR(area(face.polygon), 12.0, 1e-12);
    EXPECT_GT(area_vector(face.polygon).x, 0.0);  // counter-clockwise seen from leaf 1, at x > 0
    EXPECT_EQ(face.plane.normal, at_x0.normal);
  }
  EXPECT_EQ(between, 1);
  EXPECT_EQ(world.leaf_at({1, 1, 0}), 1U);
}

TEST(QuakeCells, OpenIntoEachOtherWhereLeavesTouch) {
  const QuakeWorld world = divided_room(random_planes(5));
  const QuakeCells found = find_quake_cells(world, room, {});
  ASSERT_GT(found.cells.size(), 8U);
  ASSERT_GT(found.portals.size(), 20U);
  EXPECT_EQ(found.cell_of_leaf[0], none_id);
  for (std::size_t i = 0; i < found.portals.size(); i += 2) {
    const Portal& there = found.portals[i];
    const Portal& back = found.portals[i + 1];
    EXPECT_EQ(there.from, back.to);
    EXPECT_EQ(there.to, back.from);
    EXPECT_LT(glm::length(area_vector(there.polygon) + area_vector(back.polygon)), 1e-12);
    EXPECT_GT(glm::dot(area_vector(there.polygon), there.plane.normal), 0.0);
    for (const CellId cell : {there.from, there.to}) {
      const ConvexRegion& region = found.cells[cell].regions.front();
      for (const glm::dvec3& corner : there.polygon) {
        EXPECT_NEAR(there.plane.signed_distance(corner), 0.0, 1e-6);
        double nearest = 1.0;
        for (const Plane& plane : region.planes) {
          EXPECT_GT(plane.signed_distance(corner), -1e-5);
          nearest = std::min(nearest, std::abs(plane.signed_distance(corner)));
        }
        EXPECT_LT(nearest, 1e-6) << "not on the boundary of cell " << cell;
      }
    }
  }
}

TEST(QuakeCells, AreJoinedToRoomsWhereTheirUnionIsConvex) {
  // Four quarters of a room, one of them made solid: what is left is an L of two rooms.
  QuakeWorld world = divided_room({at_x0, at_z1});
  ASSERT_EQ(find_quake_cells(world, room, {}).cells.size(), 4U);
  EXPECT_EQ(find_quake_cells(world, room, {Cells::rooms, 0.0}).cells.size(), 1U);
  world.leaves[world.leaf_at({1, 1, 1.5})].cluster = -1;
  const QuakeCells rooms = find_quake_cells(world, room, {Cells::rooms, 0.0});
  ASSERT_EQ(rooms.cells.size(), 2U);
  ASSERT_EQ(rooms.portals.size(), 2U);
  EXPECT_EQ(rooms.cells[0].regions.size() + rooms.cells[1].regions.size(), 3U);
  // The smaller room, 2 x 3 x 1 or x 3 metres, is joined if it is too small.
  EXPECT_EQ(find_quake_cells(world, room, {Cells::rooms, 5.9}).cells.size(), 2U);
  const QuakeCells one = find_quake_cells(world, room, {Cells::rooms, 18.1});
  EXPECT_EQ(one.cells.size(), 1U);
  EXPECT_TRUE(one.portals.empty());
}

TEST(QuakeCells, JoinThePortalsBetweenTheSameRooms) {
  // Each side of x = 0 is one room of two leaves.
  const QuakeWorld world = divided_room({at_z1, at_x0});
  QuakeWorld parted = world;
  parted.leaves[world.leaf_at({1, 1, 1.5})].cluster = -1;
  EXPECT_EQ(find_quake_cells(world, room, {}).portals.size(), 8U);
  const QuakeCells rooms = find_quake_cells(parted, room, {Cells::rooms, 0.0});
  ASSERT_EQ(rooms.portals.size(), 2U);
  EXPECT_GT(area(rooms.portals[0].polygon), 2.9);
}

TEST(QuakeCells, OfASealedWorldHaveNothingOdd) {
  QuakeWorld world = divided_room({at_x0});
  world.bytes_per_cluster = 1;
  world.visible = {3, 3};
  world.report = find_quake_cells(world, room, {}).report;
  EXPECT_EQ(world.report.leaves_open_to_outside, 0U);
  EXPECT_EQ(world.doubt_about_sets(), "");
}

TEST(QuakeCells, ReportACrackInTheHull) {
  QuakeWorld world = divided_room({at_x0});
  world.nodes[1].back = -static_cast<std::int32_t>(world.leaves.size() + 1);  // beyond x = 2
  world.leaves.push_back({2, 0, {}, none_id});
  world.cluster_count = 3;
  const QuakeCells found = find_quake_cells(world, room, {});
  EXPECT_EQ(found.report.leaves_open_to_outside, 1U);
  EXPECT_EQ(found.cells.size(), 3U);
  EXPECT_EQ(found.portals.size(), 4U);  // one leads out
}

TEST(QuakeCells, ReportSetsThatAreMissingOrDoNotFit) {
  QuakeWorld world = divided_room({at_x0});
  EXPECT_NE(world.doubt_about_sets().find("no potentially visible sets"), std::string::npos);
  world.bytes_per_cluster = 1;
  world.visible = {3, 1};
  world.report = find_quake_cells(world, room, {}).report;
  EXPECT_EQ(world.report.blind_clusters, 1U);
  EXPECT_NE(world.doubt_about_sets().find("1 clusters do not see themselves"), std::string::npos);
  world.visible = {3, 2};
  world.report = find_quake_cells(world, room, {}).report;
  EXPECT_EQ(world.report.blind_clusters, 0U);
  EXPECT_EQ(world.report.unseen_neighbours, 1U);
  EXPECT_NE(world.doubt_about_sets().find("do not see each other"), std::string::npos);
}

TEST(QuakeCells, AreRefusedWhereTheTreeDoesNotFitItsLeaves) {
  for (const double shift : {0.2, -0.2}) {
    QuakeWorld world = divided_room({at_x0, at_z1});
    world.planes[6].d += shift;
    EXPECT_TRUE(says(input_error([&]() { find_quake_cells(world, room, {}); }), "BSP tree puts"));
  }
  QuakeWorld turned = divided_room({at_x0, at_z1});
  turned.planes[7].normal = -turned.planes[7].normal;
  EXPECT_TRUE(says(input_error([&]() { find_quake_cells(turned, room, {}); }), "BSP tree puts"));
}

/// A square in the plane at x, 4 metres high and wide.
Object square_at(Scene& scene, float x) {
  Mesh mesh;
  mesh.positions = {{x, -0.5F, -2}, {x, 3.5F, -2}, {x, 3.5F, 2}, {x, -0.5F, 2}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.meshes.push_back(mesh);
  return {static_cast<MeshId>(scene.meshes.size() - 1), glm::dmat4x3(1.0), none_id};
}

TEST(QuakeGaps, AreSolidLeavesWithBareFacesOnSeveralSides) {
  // A solid slab from x = -0.5 to 0.5 parts the room. The room's own walls are bare as well, but
  // all of what lies behind them is one leaf, which counts always.
  QuakeWorld world = divided_room({{{1, 0, 0}, -0.5}, {{1, 0, 0}, 0.5}});
  world.leaves[world.leaf_at({0, 1, 0})].cluster = -1;
  const std::uint32_t front = world.leaf_at({1, 1, 0});
  const std::uint32_t back = world.leaf_at({-1, 1, 0});
  const LeafShapes shapes = shapes_of_leaves(world, room);
  Scene scene;
  world.first_leaf = {0};
  EXPECT_EQ(count_see_through_leaves(scene, world, shapes), 2U);
  scene.objects.push_back(square_at(scene, 0.5F));
  world.leaf_lists = {front};
  world.first_leaf = {0, 1};
  EXPECT_EQ(count_see_through_leaves(scene, world, shapes), 1U);
  // Bare on both sides, but for a part.
  scene.objects[0] = square_at(scene, 0.5F);
  scene.meshes.back().triangles.pop_back();
  EXPECT_EQ(count_see_through_leaves(scene, world, shapes), 2U);
  scene.objects.push_back(square_at(scene, -0.5F));
  world.leaf_lists = {front, back};
  world.first_leaf = {0, 1, 2};
  EXPECT_EQ(count_see_through_leaves(scene, world, shapes), 1U);
}

}  // namespace
}  // namespace vislab
