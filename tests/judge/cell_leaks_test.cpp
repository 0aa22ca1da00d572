// The checker of cells, and the rays that find leaks: every planted fault, and none in what is
// sound.
#include "common/judge/cell_leaks.h"

#include <gtest/gtest.h>

#include "common/scene/cell_check.h"
#include "common/scene/convex_region.h"
#include "common/scene/generators/generators.h"
#include "common/scene/generators/rooms.h"

namespace vislab {
namespace {

constexpr std::size_t rays = 400;

Scene finished(Scene scene) {
  scene.finish();
  return scene;
}

RoomsParameters line_of_three() {
  RoomsParameters line;
  line.rows = 3;
  return line;
}

void expect_sound(const Scene& scene) {
  const CellCheck check = check_cells(scene);
  EXPECT_EQ(check.overlaps.count, 0U);
  EXPECT_EQ(check.gaps.count, 0U);
  EXPECT_EQ(check.off.count, 0U);
  const CellLeaks leaks = find_cell_leaks(scene, rays, 1);
  EXPECT_GE(leaks.rays, scene.cells.size() * rays / 2);
  EXPECT_EQ(leaks.leaks.count, 0U) << "cell " << leaks.leaks.cell << " at " << leaks.leaks.place.x
                                   << " " << leaks.leaks.place.y << " " << leaks.leaks.place.z;
}

TEST(CellCheck, FindsNothingInGeneratedBuildings) {
  expect_sound(finished(make_rooms(line_of_three())));
  for (const Windows windows : {Windows::none, Windows::nothing, Windows::outside}) {
    RoomsParameters house;
    house.columns = 3;
    house.rows = 2;
    house.storeys = 2;
    house.doors = 0.5;
    house.open = 0.6;
    house.variation = 0.2;
    house.door_shift_m = 0.8;
    house.door_roll_deg = 20.0;
    house.windows = windows;
    expect_sound(finished(make_rooms(house)));
  }
  RoomsParameters many = line_of_three();
  many.portals = 8;
  many.crack_m = 0.01;
  expect_sound(finished(make_rooms(many)));
}

TEST(CellCheck, FindsNothingInARing) { expect_sound(finished(make_room_ring({}))); }

TEST(CellCheck, FindsCellsThatOverlap) {
  RoomsParameters line = line_of_three();
  line.overlap_m = 0.1;
  const CellCheck check = check_cells(finished(make_rooms(line)));
  EXPECT_EQ(check.overlaps.count, 2U);
  EXPECT_EQ(check.overlaps.cell, 0U);
  EXPECT_EQ(check.overlaps.other, 1U);
  EXPECT_LT(std::abs(check.overlaps.place.z), 0.05);
}

TEST(CellCheck, FindsTheGapBehindAPortal) {
  Scene scene = make_rooms(line_of_three());
  // The second half of the first doorway begins 5 cm behind the portal.
  scene.cells[1].regions[1] = box_region({-0.5, 0.02, -0.125}, {0.5, 2.02, -0.05});
  const CellCheck check = check_cells(finished(std::move(scene)));
  EXPECT_EQ(check.gaps.count, 2U);  // seen from either cell
  EXPECT_EQ(check.off.count, 0U);
  EXPECT_NEAR(check.gaps.place.z, 0.0, 1e-6);
}

TEST(CellCheck, FindsPortalsOffTheBoundaryOrTurnedRound) {
  Scene moved = make_rooms(line_of_three());
  for (glm::dvec3& corner : moved.portals[0].polygon) corner.z += 0.3;
  moved.portals[0] = make_portal(moved.portals[0].polygon, 0, 1);
  const CellCheck check = check_cells(finished(std::move(moved)));
  EXPECT_EQ(check.off.count, 1U);
  EXPECT_EQ(check.gaps.count, 0U);
  EXPECT_EQ(check.off.cell, 0U);
  EXPECT_EQ(check.off.other, 1U);

  Scene turned = make_rooms(line_of_three());
  std::swap(turned.portals[0].from, turned.portals[0].to);
  EXPECT_EQ(check_cells(finished(std::move(turned))).off.count, 1U);
}

TEST(CellLeaks, AreFoundWhereAPortalIsMissing) {
  Scene scene = make_rooms(line_of_three());
  scene.portals.erase(scene.portals.begin());
  const CellLeaks leaks = find_cell_leaks(finished(std::move(scene)), rays, 1);
  EXPECT_GT(leaks.leaks.count, 0U);
  EXPECT_EQ(leaks.leaking_cells, 1U);
  EXPECT_EQ(leaks.leaks.cell, 0U);
}

TEST(CellLeaks, AreFoundWhereACrackHasNoPortal) {
  RoomsParameters line = line_of_three();
  line.crack_m = 0.2;
  line.crack_portal = false;
  const Scene scene = finished(make_rooms(line));
  const CellCheck check = check_cells(scene);
  EXPECT_EQ(check.overlaps.count + check.gaps.count + check.off.count, 0U);
  EXPECT_EQ(find_cell_leaks(scene, 10 * rays, 1).leaking_cells, 3U);
}

TEST(CellLeaks, AreFoundWhereAWallIsMissing) {
  Scene scene = make_rooms(line_of_three());
  // Object 0 is the left wall of the first room; a box stands outside.
  scene.objects[0].transform = box_transform({-20.0, 1.0, 2.5}, {1.0, 5.0, 5.0});
  scene.objects[0].mesh = 0;
  const CellLeaks leaks = find_cell_leaks(finished(std::move(scene)), rays, 1);
  EXPECT_EQ(leaks.leaking_cells, 1U);
  EXPECT_LT(leaks.leaks.place.x, -2.4);
}

TEST(CellLeaks, AreUnknownOfCellsInsideOfAClosedHull) {
  Scene open = make_rooms(line_of_three());
  const CellLeaks before = find_cell_leaks(finished(open), rays, 1);
  EXPECT_EQ(before.unchecked_cells, 0U);
  EXPECT_EQ(before.rays + before.rays_inside_objects, 3 * rays);
  EXPECT_LT(before.rays_inside_objects, rays / 4) << "in the boxes that stand about";
  // All of it in one closed box, and no portal left: everything leaks, but nobody looks.
  open.portals.clear();
  EXPECT_EQ(find_cell_leaks(finished(open), rays, 1).leaking_cells, 3U);
  open.objects.push_back({static_cast<MeshId>(open.meshes.size()),
                          box_transform({0.0, 0.0, 0.0}, glm::dvec3(100.0)), none_id});
  open.meshes.push_back(cube_mesh());
  const CellLeaks hidden = find_cell_leaks(finished(open), rays, 1);
  EXPECT_EQ(hidden.leaks.count, 0U);
  EXPECT_EQ(hidden.rays, 0U);
  EXPECT_EQ(hidden.rays_inside_objects, 3 * rays);
  EXPECT_EQ(hidden.unchecked_cells, 3U);
  EXPECT_EQ(hidden.first_unchecked, 0U);
  // A box around the first room only, which begins at z = 0.
  open.objects.back().transform = box_transform({0.0, 0.0, 100.0}, glm::dvec3(100.0));
  const CellLeaks partly = find_cell_leaks(finished(open), rays, 1);
  EXPECT_EQ(partly.leaking_cells, 2U);
  EXPECT_EQ(partly.unchecked_cells, 1U);
  EXPECT_EQ(partly.first_unchecked, 0U);
}

TEST(CellLeaks, OfTheSameSeedAreTheSame) {
  RoomsParameters line = line_of_three();
  line.crack_m = 0.2;
  line.crack_portal = false;
  const Scene scene = finished(make_rooms(line));
  const CellLeaks a = find_cell_leaks(scene, 50, 7);
  const CellLeaks b = find_cell_leaks(scene, 50, 7);
  EXPECT_EQ(a.leaks.count, b.leaks.count);
  EXPECT_EQ(a.leaks.place, b.leaks.place);
}

}  // namespace
}  // namespace vislab
