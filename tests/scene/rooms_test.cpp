// Generated buildings: their boards, cells and portals, and ways through them.
#include "common/scene/generators/rooms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/scene/cell_objects.h"
#include "common/scene/convex_region.h"
#include "common/scene/generators/generators.h"
#include "common/scene/generators/pierced_board.h"
#include "common/scene/paths/tracks.h"
#include "tests/input_error.h"

namespace vislab {
namespace {

Scene finished(const RoomsParameters& parameters) {
  Scene scene = make_rooms(parameters);
  scene.finish();
  return scene;
}

bool in_cell(const Scene& scene, CellId cell, const glm::dvec3& point) {
  return std::ranges::any_of(scene.cells[cell].regions, [&](const ConvexRegion& region) {
    return contains(region, point, 0.0);
  });
}

glm::dvec3 middle_of(const ConvexPolygon& polygon) {
  glm::dvec3 sum(0.0);
  for (const glm::dvec3& corner : polygon) sum += corner;
  return sum / static_cast<double>(polygon.size());
}

RoomsParameters small_house() {
  RoomsParameters house;
  house.columns = 3;
  house.rows = 2;
  house.storeys = 3;
  house.doors = 0.3;
  house.door_shift_m = 0.8;
  house.variation = 0.2;
  house.windows = Windows::outside;
  return house;
}

TEST(PiercedBoard, IsSolidWithAnyOpenings) {
  const double c = std::cos(0.6);
  const double s = std::sin(0.6);
  const BoardOpening turned{{-c, -s}, {s, -c}, {c, s}, {-s, c}};
  const BoardOpening square{{2.0, -1.0}, {2.5, -1.0}, {2.5, 1.0}, {2.0, 1.0}};
  const BoardOpening triangle{{3.0, 0.0}, {4.0, -0.5}, {3.5, 1.5}};
  for (const auto& openings :
       {std::vector<BoardOpening>{}, {turned}, {triangle, turned}, {square, triangle, turned}}) {
    Scene scene;
    scene.meshes.push_back(pierced_board_mesh({-2.0, -2.0}, {5.0, 2.0}, 0.1, openings));
    scene.objects.push_back({});
    scene.finish();
    EXPECT_TRUE(scene.meshes[0].solid) << openings.size();
    // As large as the board without its openings.
    double volume = 0.0;
    for (std::uint32_t t = 0; t < scene.meshes[0].triangles.size(); ++t) {
      const auto corners = world_triangle(scene.meshes[0], glm::dmat4x3(1.0), t);
      volume += glm::dot(corners[0], glm::cross(corners[1], corners[2])) / 6.0;
    }
    double expected = 28.0;
    for (const BoardOpening& opening : openings) {
      ConvexPolygon flat;
      for (const glm::dvec2& p : opening) flat.emplace_back(p, 0.0);
      expected -= area(flat);
    }
    EXPECT_NEAR(volume, 0.2 * expected, 1e-5);
  }
}

TEST(ConvexRegions, KnowTheirBoxFromTheirPlanesAndRefuseWhatIsNotBounded) {
  std::vector<Plane> planes = box_region({-1.0, 2.0, 3.0}, {4.0, 5.0, 6.5}).planes;
  const double half = std::sqrt(0.5);
  planes.push_back({{-half, -half, 0.0}, half * 7.0});  // x + y <= 7
  const std::optional<ConvexRegion> region = region_inside(planes);
  ASSERT_TRUE(region);
  EXPECT_EQ(region->bounds.min, glm::vec3(-1.0F, 2.0F, 3.0F));
  EXPECT_EQ(region->bounds.max, glm::vec3(4.0F, 5.0F, 6.5F));
  EXPECT_TRUE(contains(*region, {3.0, 3.9, 4.0}, 0.0));
  EXPECT_FALSE(contains(*region, {3.5, 4.0, 4.0}, 0.0));
  EXPECT_TRUE(contains(*region, {3.5, 4.0, 4.0}, 0.4));
  EXPECT_FALSE(region_inside({planes[0], planes[1], planes[2], planes[3], planes[4]}));
  planes.push_back({{1.0, 0.0, 0.0}, -10.0});  // x >= 10
  EXPECT_FALSE(region_inside(planes));
}

TEST(ConvexRegions, ShareAPointOnlyWhereTheyOverlapByTheDepth) {
  const ConvexRegion a = box_region({0.0, 0.0, 0.0}, {2.0, 2.0, 2.0});
  EXPECT_FALSE(shared_point(a, box_region({2.0, 0.0, 0.0}, {3.0, 2.0, 2.0}), 1e-3));
  EXPECT_FALSE(shared_point(a, box_region({1.9995, 0.0, 0.0}, {3.0, 2.0, 2.0}), 1e-3));
  const auto point = shared_point(a, box_region({1.9, 0.0, 0.0}, {3.0, 2.0, 2.0}), 1e-3);
  ASSERT_TRUE(point);
  EXPECT_NEAR(point->x, 1.95, 1e-3);
  EXPECT_TRUE(shared_point(a, box_region({0.5, 0.5, 0.5}, {1.0, 1.0, 1.0}), 1e-3));
}

TEST(Rooms, BoardsAreSolidAndPortalsLieBetweenTheirCells) {
  for (const Windows windows : {Windows::none, Windows::nothing, Windows::outside}) {
    RoomsParameters house = small_house();
    house.windows = windows;
    const Scene scene = finished(house);
    EXPECT_EQ(scene.cells.size(), windows == Windows::outside ? 19U : 18U);
    EXPECT_EQ(scene.report.open_meshes, 0U);
    EXPECT_EQ(scene.report.self_intersecting_meshes, 0U);
    ASSERT_FALSE(scene.portals.empty());
    for (const Portal& portal : scene.portals) {
      const glm::dvec3 middle = middle_of(portal.polygon);
      EXPECT_TRUE(in_cell(scene, portal.from, middle + portal.plane.normal * 0.01));
      EXPECT_TRUE(in_cell(scene, portal.to, middle - portal.plane.normal * 0.01));
    }
  }
}

TEST(Rooms, ALineHasItsFirstDoorAtTheOriginAndGoesOnBehindIt) {
  RoomsParameters line;
  line.rows = 4;
  const Scene scene = finished(line);
  ASSERT_EQ(scene.cells.size(), 4U);
  ASSERT_EQ(scene.portals.size(), 6U);
  for (const glm::dvec3& corner : scene.portals[0].polygon) EXPECT_EQ(corner.z, 0.0);
  EXPECT_EQ(scene.portals[0].from, 0U);
  EXPECT_EQ(scene.portals[0].to, 1U);
  EXPECT_TRUE(in_cell(scene, 0, {0.0, 1.0, 3.0}));
  EXPECT_TRUE(in_cell(scene, 1, {0.0, 1.0, -3.0}));
}

TEST(Rooms, DialsAddPortalsCloseDoorsAndCrackWalls) {
  RoomsParameters line;
  line.rows = 3;
  for (const std::uint32_t portals : {0U, 1U, 4U, 8U}) {
    line.portals = portals;
    EXPECT_EQ(finished(line).portals.size(), 4U * portals);
  }
  line.portals = 2;
  const std::size_t objects = finished(line).object_count();
  line.open = 0.0;
  EXPECT_TRUE(finished(line).portals.empty());
  EXPECT_EQ(finished(line).object_count(), objects + 4U);
  line.crack_m = 1e-3;
  EXPECT_EQ(finished(line).portals.size(), 4U);
  line.crack_portal = false;
  EXPECT_TRUE(finished(line).portals.empty());
}

TEST(Rooms, ASmallerShareOfOpenDoorsIsAPartOfTheSame) {
  RoomsParameters grid;
  grid.columns = 4;
  grid.rows = 4;
  const auto openings = [&](double open) {
    grid.open = open;
    std::vector<std::pair<CellId, CellId>> joined;
    for (const Portal& portal : finished(grid).portals) joined.emplace_back(portal.from, portal.to);
    std::ranges::sort(joined);
    return joined;
  };
  const auto few = openings(0.3);
  const auto many = openings(0.7);
  EXPECT_EQ(openings(1.0).size(), 48U);
  EXPECT_LT(few.size(), many.size());
  EXPECT_TRUE(std::ranges::includes(many, few));
}

TEST(Rooms, RolledDoorsTurnInTheirWallsAndKeepTheirSize) {
  RoomsParameters line;
  line.rows = 2;
  for (const double roll : {0.0, 10.0, 45.0}) {
    line.door_roll_deg = roll;
    const Scene scene = finished(line);
    const glm::dvec3 lower = scene.portals[0].polygon[1] - scene.portals[0].polygon[0];
    EXPECT_NEAR(std::abs(std::atan2(lower.y, lower.x)) * 180.0 / std::acos(-1.0), roll, 1e-4);
    EXPECT_NEAR(area(scene.portals[0].polygon), 2.0, 1e-5);
  }
  line.door_height_m = 3.5;
  EXPECT_TRUE(says(input_error([&] { make_rooms(line); }), "does not fit"));
}

TEST(Rooms, OverlappingCellsShareWhatTheDialSays) {
  RoomsParameters line;
  line.rows = 2;
  for (const double overlap : {0.0, 0.1, 0.5}) {
    line.overlap_m = overlap;
    const Scene scene = finished(line);
    for (const double z : {-0.3, -0.2, -0.04, 0.04, 0.2, 0.3}) {
      const glm::dvec3 point(0.0, 1.0, z);
      const bool both = in_cell(scene, 0, point) && in_cell(scene, 1, point);
      EXPECT_EQ(both, std::abs(z) < 0.5 * overlap) << overlap << " at " << z;
    }
  }
}

TEST(Rooms, SmallThingsLieInTheirRoomsAndMoveNothingElse) {
  RoomsParameters house;
  house.columns = house.rows = house.storeys = 2;
  house.variation = 0.2;
  const Scene without = finished(house);
  house.small_things_per_room = 6;
  const Scene scene = finished(house);
  ASSERT_EQ(scene.object_count(), without.object_count() + 8U * 6U);
  for (ObjectId object = 0; object < scene.object_count(); ++object) {
    if (object < without.object_count()) {
      EXPECT_EQ(scene.objects[object].transform, without.objects[object].transform);
      continue;
    }
    ASSERT_NE(scene.objects[object].cell, none_id);
    const Aabb& room = scene.cells[scene.objects[object].cell].regions.front().bounds;
    for (const glm::vec3& position : scene.mesh_of(object).positions) {
      const glm::dvec4 local(glm::dvec3(position), 1.0);
      const glm::dvec3 in_world = scene.objects[object].transform * local;
      EXPECT_LE(glm::distance(in_world, scene.objects[object].transform[3]), 0.06);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(in_world[axis], room.min[axis]);
        EXPECT_LE(in_world[axis], room.max[axis]);
      }
    }
  }
}

TEST(Rooms, CellsListTheWallsRoundThemAndTheirOwnFurniture) {
  RoomsParameters line;
  line.rows = 3;
  line.boxes_per_room = 2;
  const Scene scene = finished(line);
  for (CellId cell = 0; cell < 3; ++cell) {
    const std::vector<ObjectId>& listed = scene.cells[cell].objects;
    EXPECT_TRUE(std::ranges::is_sorted(listed));
    EXPECT_EQ(listed.size(), 4U + 2U + 2U);  // walls, floor and ceiling, boxes
    for (ObjectId object = 0; object < scene.object_count(); ++object) {
      if (scene.objects[object].cell == cell) {
        EXPECT_TRUE(std::ranges::binary_search(listed, object));
      }
    }
  }
  // The wall between two rooms is in both; nothing is in none.
  std::vector<int> lists(scene.object_count(), 0);
  for (const Cell& cell : scene.cells) {
    for (const ObjectId object : cell.objects) ++lists[object];
  }
  EXPECT_EQ(std::ranges::count(lists, 0), 0);
  EXPECT_EQ(std::ranges::count(lists, 2), 2);
}

TEST(Rooms, AnObjectIsListedWhereASurfacePassesThroughWithoutACorner) {
  Scene scene;
  Mesh sheet;
  sheet.positions = {{-10.0F, 1.0F, -10.0F}, {10.0F, 1.0F, -10.0F}, {0.0F, 1.0F, 30.0F}};
  sheet.triangles = {{0, 1, 2}};
  scene.meshes = {sheet};
  scene.objects.push_back({});
  scene.cells.resize(3);
  scene.cells[0].regions = {box_region({-1.0, 0.0, -1.0}, {1.0, 2.0, 1.0})};
  scene.cells[1].regions = {box_region({-1.0, 1.1, -1.0}, {1.0, 2.0, 1.0})};
  scene.cells[2].regions = {box_region({-9.0, 0.0, 20.0}, {-8.0, 2.0, 21.0})};
  list_objects_of_cells(scene);
  EXPECT_EQ(scene.cells[0].objects, std::vector<ObjectId>{0});
  EXPECT_TRUE(scene.cells[1].objects.empty());
  EXPECT_TRUE(scene.cells[2].objects.empty());  // within the triangle's box only
}

TEST(Rooms, ATourStaysInTheRoomsAndVisitsAsManyAsItShall) {
  const Scene scene = finished(small_house());
  const Track tour = room_tour_track(scene, 18, 1.6);
  std::vector<std::uint8_t> visited(scene.cells.size(), 0);
  for (const Pose& pose : tour.sampled(2000)) {
    bool inside = false;
    for (CellId cell = 0; cell < 18; ++cell) {
      if (!in_cell(scene, cell, pose.eye)) continue;
      inside = true;
      visited[cell] = 1;
    }
    EXPECT_TRUE(inside) << pose.eye.x << " " << pose.eye.y << " " << pose.eye.z;
  }
  EXPECT_EQ(std::ranges::count(visited, 1), 18);
}

TEST(RoomRing, CellsHoldTheirRoomsAndMeetInTheDoorways) {
  for (const std::uint32_t rooms : {3U, 5U, 30U}) {
    RoomRingParameters parameters;
    parameters.rooms = rooms;
    Scene ring = make_room_ring(parameters);
    ring.finish();
    for (const Portal& portal : ring.portals) {
      const glm::dvec3 middle = middle_of(portal.polygon);
      EXPECT_TRUE(in_cell(ring, portal.from, middle + portal.plane.normal * 0.01));
      EXPECT_TRUE(in_cell(ring, portal.to, middle - portal.plane.normal * 0.01));
      EXPECT_TRUE(in_cell(ring, portal.to, middle - portal.plane.normal * 0.5));
    }
    for (ObjectId object = 0; object < ring.object_count(); ++object) {
      const CellId own = ring.objects[object].cell;
      EXPECT_TRUE(std::ranges::binary_search(ring.cells[own].objects, object));
    }
  }
}

}  // namespace
}  // namespace vislab
