// Potentially visible sets: the geometry of sequences of portals, sets held against rays from all
// over a cell, and the sets of a Quake III world.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "algorithms/portal/pvs_flow.h"
#include "algorithms/portal/pvs_polygon.h"
#include "common/geometry/random.h"
#include "common/judge/region_truth.h"
#include "common/scene/error.h"
#include "common/scene/quake_world.h"
#include "tests/algorithms/portal_rooms.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

using namespace portal_culling;

/// An upright square across the x axis, counter-clockwise seen from smaller x.
std::vector<glm::dvec3> square(double x, double z, double half) {
  return {{x, -half, z - half}, {x, -half, z + half}, {x, half, z + half}, {x, half, z - half}};
}

/// Rooms of 4 m along the x axis; the wall after room k has a square hole of 1 m about z = at[k].
Scene rooms_with_holes_at(const std::vector<double>& at) {
  Scene scene;
  scene.name = "staggered";
  scene.meshes.push_back(cube_mesh());
  scene.cells.resize(at.size() + 1);
  for (CellId room = 0; room <= at.size(); ++room) {
    scene.objects.push_back(
        {0, box_transform({4.0 * room + 2.0, -3.0, 0.0}, glm::dvec3(0.2)), room});
    scene.cells[room].regions = {box_region({4.0 * room, -4, -9}, {4.0 * room + 4.0, 4, 9})};
    scene.cells[room].bounds = scene.cells[room].regions[0].bounds;
    scene.cells[room].objects = {room};
    if (room == at.size()) break;
    std::vector<glm::dvec3> hole = square(4.0 * room + 4.0, at[room], 0.5);
    scene.portals.push_back(make_portal(hole, room, room + 1));
    std::ranges::reverse(hole);
    scene.portals.push_back(make_portal(hole, room + 1, room));
  }
  scene.finish();
  return scene;
}

std::vector<std::vector<CellId>> sets_of(const Scene& scene, const PvsLimits& limits,
                                         std::uint64_t* given_up = nullptr) {
  PortalGraph graph;
  graph.build(scene);
  const PvsTable table = find_visible_cells(graph, limits);
  if (given_up != nullptr) *given_up = table.given_up;
  std::vector<std::vector<CellId>> sets(scene.cells.size());
  for (CellId cell = 0; cell < sets.size(); ++cell) {
    BitWords words(words_for(sets.size()), 0);
    table.cells.unite(cell, words);
    for (CellId other = 0; other < sets.size(); ++other) {
      if (bit(words, other)) sets[cell].push_back(other);
    }
  }
  return sets;
}

using Set = std::vector<CellId>;

TEST(PvsRows, ComeBackAsTheyWentIn) {
  for (const std::size_t bits : {1U, 64U, 65U, 5000U}) {
    CompressedRows rows;
    rows.clear(bits);
    Random random(bits);
    std::vector<BitWords> given;
    for (const double share : {0.0, 0.001, 0.5, 1.0}) {
      given.emplace_back(words_for(bits), 0);
      for (std::size_t i = 0; i < bits; ++i) {
        if (random.uniform() < share) set_bit(given.back(), i);
      }
      rows.add(given.back());
    }
    for (std::size_t row = 0; row < given.size(); ++row) {
      BitWords back(words_for(bits), 0);
      rows.unite(row, back);
      EXPECT_EQ(back, given[row]);
    }
  }
}

TEST(PvsPolygon, SeparatorsLeaveWhatLinesThroughBothPolygonsReach) {
  const FlowPolygon first(square(0.0, 0.0, 0.5));
  const FlowPolygon second(square(1.0, 0.0, 0.5));
  FlowPolygon target(square(2.0, 0.0, 9.0));
  std::vector<HalfSpace> separators;
  append_separators(first, second, 0.0, separators);
  for (const HalfSpace& half : separators) ASSERT_TRUE(target.clip(half));
  double reach = 0.0;
  for (const glm::dvec3& corner : target.corners()) {
    reach = std::max({reach, std::abs(corner.y), std::abs(corner.z)});
  }
  EXPECT_NEAR(reach, 1.5, 1e-9);
}

TEST(PvsFlow, ThirdHoleIsSeenOnlyIfALineGoesThroughAllThree) {
  // Lines through [-0.5, 0.5] at x = 4 and [1, 2] at x = 8 are at 1.5 m or more at x = 12.
  EXPECT_EQ(sets_of(rooms_with_holes_at({0.0, 1.5, 2.1}), {})[0], (Set{0, 1, 2, 3}));
  EXPECT_EQ(sets_of(rooms_with_holes_at({0.0, 1.5, 1.01}), {})[0], (Set{0, 1, 2, 3}));
  const auto hidden = sets_of(rooms_with_holes_at({0.0, 1.5, 0.99}), {});
  EXPECT_EQ(hidden[0], (Set{0, 1, 2}));
  EXPECT_EQ(hidden[3], (Set{1, 2, 3})) << "sight is mutual";
}

TEST(PvsFlow, SetsAreSymmetricAndDoNotDependOnThreads) {
  const Scene ring = [] {
    Scene scene = make_room_ring({30, 0, 1});
    scene.finish();
    return scene;
  }();
  const auto sets = sets_of(ring, {.threads = 1});
  EXPECT_EQ(sets, sets_of(ring, {.threads = 2}));
  for (CellId cell = 0; cell < sets.size(); ++cell) {
    EXPECT_LT(sets[cell].size(), 30U) << "the ring turns";
    for (const CellId other : sets[cell]) {
      EXPECT_TRUE(std::ranges::binary_search(sets[other], cell)) << cell << " " << other;
    }
  }
}

TEST(PvsFlow, SightIsMutualOnlyIfEachPortalLeadsBackWhereItLeads) {
  // Straight on one sees the last room. The ways back are elsewhere in the walls, to one side and
  // the other in turn, and from the last room none goes through all of them.
  Scene scene = rooms_with_holes_at({0.0, 0.0, 0.0});
  EXPECT_EQ(sets_of(scene, {})[0], (Set{0, 1, 2, 3}));
  for (std::size_t i = 1; i < scene.portals.size(); i += 2) {
    Portal& back = scene.portals[i];
    for (glm::dvec3& corner : back.polygon) corner.z += back.to % 2 == 0 ? -8.0 : 8.0;
    back = make_portal(back.polygon, back.from, back.to);
  }
  const auto sets = sets_of(scene, {});
  EXPECT_EQ(sets[0], (Set{0, 1, 2, 3}));
  EXPECT_EQ(sets[3], (Set{1, 2, 3}));
}

/// Six rooms with rectangles of all sizes and rolls between them, such that what is found from one
/// end of the row is not what is found from the other; and two rooms apart from them, of which one
/// opens into the other.
Scene rooms_seen_otherwise_from_either_end() {
  Scene scene;
  scene.cells.resize(8);
  const auto set_box = [&](CellId cell, const glm::dvec3& min, const glm::dvec3& max) {
    scene.cells[cell].regions = {rooms_of_tests::box_region(min, max)};
    scene.cells[cell].bounds = scene.cells[cell].regions[0].bounds;
  };
  Random random(41);
  for (CellId room = 0; room < 6; ++room) {
    const double x = 4.0 * room;
    set_box(room, {x, -9, -9}, {x + 4.0, 9, 9});
    if (room == 5) break;
    const double roll = random.uniform(0.0, 1.57);
    const double y = random.uniform(-1.0, 1.0);
    const double z = random.uniform(-1.0, 1.0);
    const double half_width = random.uniform(0.2, 0.8);
    const double half_height = random.uniform(0.05, 0.8);
    const glm::dvec3 middle(x + 4.0, y, z);
    const glm::dvec3 u = half_width * glm::dvec3(0.0, -std::sin(roll), std::cos(roll));
    const glm::dvec3 v = half_height * glm::dvec3(0.0, std::cos(roll), std::sin(roll));
    std::vector<glm::dvec3> hole{middle - v - u, middle - v + u, middle + v + u, middle + v - u};
    scene.portals.push_back(make_portal(hole, room, room + 1));
    std::ranges::reverse(hole);
    scene.portals.push_back(make_portal(hole, room + 1, room));
  }
  set_box(6, {0, 20, 0}, {4, 22, 2});
  set_box(7, {4, 20, 0}, {8, 22, 2});
  scene.portals.push_back(make_portal({{4, 20, 0}, {4, 20, 1}, {4, 21, 1}, {4, 21, 0}}, 6, 7));
  return scene;
}

TEST(PvsFlow, APortalLeadsBackWhicheverOfItsCornersIsFirst) {
  Scene scene = rooms_seen_otherwise_from_either_end();
  auto one_way = sets_of(scene, {});
  scene.portals.pop_back();
  const auto mutual = sets_of(scene, {});
  for (const CellId apart : {6, 7}) one_way[apart] = mutual[apart];
  ASSERT_NE(mutual, one_way) << "rooms in which it does not matter are no test";
  for (std::size_t i = 1; i < scene.portals.size(); i += 2) {
    std::ranges::rotate(scene.portals[i].polygon, scene.portals[i].polygon.begin() + 1);
  }
  EXPECT_EQ(sets_of(scene, {}), mutual);
}

TEST(PvsFlow, ASourceThatIsGivenUpSeesAllThatTheSidesOfThePortalsAllow) {
  const Scene scene = rooms_with_holes_at({0.0, 1.5, 0.0, 1.5});
  std::uint64_t given_up = 0;
  const auto all = sets_of(scene, {.most_passes = 0}, &given_up);
  EXPECT_GT(given_up, 0U);
  EXPECT_EQ(all[0], (Set{0, 1, 2, 3, 4}));
  EXPECT_EQ(sets_of(scene, {}, &given_up)[0], (Set{0, 1, 2}));
  EXPECT_EQ(given_up, 0U);
}

/// Rays from all over the cells, against the sets that the culler gives them.
RegionVerdict judged(CullerRun& run, const Scene& scene, std::uint32_t rays) {
  RegionJudge judge(scene, {12, rays, 3, 2});
  const std::vector<CellTruth> truth = judge.trace(reachable_cells(scene));
  return judge.judge(truth, [&](CellId cell) {
    const auto set = region_set(run.culler(), cell, scene);
    EXPECT_TRUE(set);
    return set.value_or(std::vector<ObjectId>());
  });
}

TEST(Pvs, MissesNoRayThroughRolledHolesInRowsOfUpToEight) {
  for (const RoomLine& line : {RoomLine{6, 1, 0.0}, RoomLine{6, 1, 30.0}, RoomLine{4, 8, 45.0},
                               RoomLine{5, 3, 10.0, 0.3}}) {
    const Scene scene = make_room_line(line);
    CullerRun run("portal.pvs", scene);
    const RegionVerdict verdict = judged(run, scene, 500);
    EXPECT_EQ(verdict.misses, 0U) << line.rooms << " " << line.holes << " " << line.roll_deg;
    EXPECT_EQ(verdict.cells, line.rooms);
  }
}

TEST(Pvs, AHoleThatIsNoPortalIsFoundByRays) {
  Scene scene = make_room_line({.rooms = 4});
  std::erase_if(scene.portals, [](const Portal& portal) { return portal.from + portal.to == 3; });
  CullerRun run("portal.pvs", scene);
  EXPECT_GT(judged(run, scene, 300).misses, 0U);
}

TEST(Pvs, KeepsWhatAWalkThroughThePortalsKeeps) {
  const Scene scene = make_room_line({.rooms = 6, .holes = 2, .roll_deg = 20.0});
  CullerRun pvs("portal.pvs", scene);
  CullerRun walk("portal.polygon", scene);
  Random random(5);
  std::size_t fewer = 0;
  for (int i = 0; i < 60; ++i) {
    const glm::dvec3 eye{random.uniform(0.3, 23.7), random.uniform(0.3, 2.7),
                         random.uniform(-3.7, 3.7)};
    const Camera camera =
        camera_at(eye, {random.uniform(0.0, 24.0), 1.5, random.uniform(-4.0, 4.0)});
    std::vector<ObjectId> kept = pvs.objects(camera);
    std::vector<ObjectId> walked = walk.objects(camera);
    std::ranges::sort(kept);
    std::ranges::sort(walked);
    EXPECT_TRUE(std::ranges::includes(kept, walked)) << i;
    fewer += kept.size() < scene.object_count() ? 1 : 0;
  }
  EXPECT_GT(fewer, 30U);
}

TEST(Pvs, WhereNoSetTellsAnythingTheFrustumDecides) {
  const Scene scene = rooms_with_holes_at({0.0, 6.0, -6.0});
  CullerRun run("portal.pvs", scene);
  const Camera first_room = camera_at({1.0, -3.0, 0.0}, {9.0, -3.0, 0.0});
  EXPECT_EQ(run.objects(first_room), (std::vector<ObjectId>{0, 1, 2}));
  const Camera outside = camera_at({-5.0, -3.0, 0.0}, {9.0, -3.0, 0.0});
  EXPECT_EQ(run.objects(outside), (std::vector<ObjectId>{0, 1, 2, 3}));
  EXPECT_EQ(run.counter("frames_outside"), 1U);
  run.update(first_room, {{3}, {box_transform({6.0, -3.0, 0.0}, glm::dvec3(0.2))}, {}, {}});
  EXPECT_EQ(run.objects(first_room), (std::vector<ObjectId>{0, 1, 2, 3})) << "it has moved";
  run.reset();
  EXPECT_EQ(run.objects(first_room), (std::vector<ObjectId>{0, 1, 2}));
}

TEST(Pvs, WhatComesBackIsWhereTheSceneHasItAgain) {
  const Scene scene = rooms_with_holes_at({0.0, 6.0, -6.0});
  CullerRun run("portal.pvs", scene);
  const Camera first_room = camera_at({1.0, -3.0, 0.0}, {9.0, -3.0, 0.0});
  const glm::dmat4x3 home = scene.objects[3].transform;
  const glm::dmat4x3 away = box_transform({6.0, -3.0, 0.0}, glm::dvec3(0.2));
  run.update(first_room, {{3}, {away}, {}, {}});
  EXPECT_EQ(run.objects(first_room), (std::vector<ObjectId>{0, 1, 2, 3}));
  run.update(first_room, {{3}, {home}, {}, {}});
  EXPECT_EQ(run.objects(first_room), (std::vector<ObjectId>{0, 1, 2}));
  // What is in no cell has no home to come to.
  Scene loose = scene;
  loose.cells[3].objects.clear();
  CullerRun other("portal.pvs", loose);
  other.update(first_room, {{3}, {away}, {}, {}});
  other.update(first_room, {{3}, {home}, {}, {}});
  EXPECT_EQ(other.objects(first_room), (std::vector<ObjectId>{0, 1, 2, 3}));
}

TEST(Pvs, WhereAWallOfWhatIsSeenIsHiddenOrHasGoneTheFrustumDecides) {
  Scene scene = rooms_with_holes_at({0.0, 6.0, -6.0});
  // A piece of the wall between the second and the third room, and one of the last room's end.
  for (const double x : {8.0, 16.0}) {
    Mesh wall;
    for (const glm::dvec3& corner : square(x, 0.0, 1.0)) wall.positions.emplace_back(corner);
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    const auto object = static_cast<ObjectId>(scene.objects.size());
    const CellId room = x < 10.0 ? 1 : 3;
    scene.objects.push_back({static_cast<MeshId>(scene.meshes.size()), glm::dmat4x3(1.0), room});
    scene.meshes.push_back(wall);
    scene.cells[room].objects.push_back(object);
  }
  scene.finish();
  const ObjectId wall = 4, unseen_wall = 5;
  CullerRun run("portal.pvs", scene);
  const Camera camera = camera_at({1.0, -3.0, 0.0}, {9.0, -3.0, 0.0});
  const std::vector<ObjectId> closed{0, 1, 2, wall};
  const std::vector<ObjectId> open{0, 1, 2, 3, unseen_wall};
  EXPECT_EQ(run.objects(camera), closed);
  run.update(camera, {{}, {}, {}, {unseen_wall}});
  EXPECT_EQ(run.objects(camera), closed) << "nobody sees from here that it is hidden";
  run.update(camera, {{}, {}, {unseen_wall}, {wall}});
  EXPECT_EQ(run.objects(camera), open);
  run.update(camera, {{}, {}, {wall}, {}});
  EXPECT_EQ(run.objects(camera), closed);
  glm::dmat4x3 aside(1.0);
  aside[3].z = 2.0;
  run.update(camera, {{wall}, {aside}, {}, {}});
  EXPECT_EQ(run.objects(camera), (std::vector<ObjectId>{0, 1, 2, 3, wall, unseen_wall}));
  run.reset();
  EXPECT_EQ(run.objects(camera), closed);
}

TEST(Pvs, WhoeverStandsInTwoCellsSeesWhatBothSee) {
  Scene scene = rooms_with_holes_at({0.0, 1.5, 0.99});
  CullerRun apart("portal.pvs", scene);
  EXPECT_EQ(region_set(apart.culler(), 0, scene), (std::vector<ObjectId>{0, 1, 2}));
  scene.cells[0].regions = {box_region({0, -4, -9}, {5, 4, 9})};
  scene.cells[0].bounds = scene.cells[0].regions[0].bounds;
  CullerRun overlapping("portal.pvs", scene);
  EXPECT_EQ(region_set(overlapping.culler(), 0, scene), (std::vector<ObjectId>{0, 1, 2, 3}));
}

/// Three rooms along x, 4 m each, as leaves 1 to 3 of a tree; leaf 0 is solid.
Scene small_world(std::vector<std::uint8_t> visible) {
  Scene scene = rooms_with_holes_at({0.0, 0.0});
  auto world = std::make_shared<QuakeWorld>();
  world->planes = {{{1, 0, 0}, 0.0}, {{1, 0, 0}, -4.0}, {{1, 0, 0}, -8.0}};
  world->nodes = {{0, 1, -1}, {1, 2, -2}, {2, -4, -3}};
  world->leaves.resize(4);
  for (std::int32_t leaf = 1; leaf < 4; ++leaf) {
    world->leaves[static_cast<std::size_t>(leaf)].cluster = leaf - 1;
  }
  world->cell_of_leaf = {none_id, 0, 1, 2};
  world->leaf_lists = {1, 2, 3};
  world->first_leaf = {0, 1, 2, 3};
  world->cluster_count = 3;
  world->bytes_per_cluster = 1;
  world->visible = std::move(visible);
  scene.quake = world;
  return scene;
}

TEST(MapPvs, KeepsTheClustersThatTheWorldSaysAreSeen) {
  const Scene scene = small_world({0b011, 0b111, 0b110});
  CullerRun run("portal.map_pvs", scene);
  const Camera first_room = camera_at({1.0, -3.0, 0.0}, {9.0, -3.0, 0.0});
  EXPECT_EQ(run.objects(first_room), (std::vector<ObjectId>{0, 1}));
  EXPECT_EQ(run.objects(camera_at({4.5, -3.0, 0.0}, {9.0, -3.0, 0.0})),
            (std::vector<ObjectId>{1, 2}))
      << "the first room lies behind";
  const Camera in_the_wall = camera_at({-0.15, -3.0, 0.0}, {9.0, -3.0, 0.0});
  EXPECT_EQ(run.objects(in_the_wall), (std::vector<ObjectId>{0, 1, 2}));
  const Camera eye_in_the_wall = camera_at({-0.05, -3.0, 0.0}, {9.0, -3.0, 0.0});
  EXPECT_EQ(run.objects(eye_in_the_wall), (std::vector<ObjectId>{0, 1})) << "rays begin before it";
  EXPECT_EQ(region_set(run.culler(), 0, scene), (std::vector<ObjectId>{0, 1}));
  EXPECT_EQ(region_set(run.culler(), 2, scene), (std::vector<ObjectId>{1, 2}));
}

/// At x = 3.9 and across the rooms, with a near plane 3 m away that reaches from x = 0.9 to 6.9.
Camera with_a_wide_window() {
  return {look_at({3.9, -3.0, -8.0}, {3.9, -3.0, 0.0}),
          perspective_lens(degrees(90.0), 1.0, 3.0, 200.0)};
}

TEST(MapPvs, LooksFromAllClustersThatTheNearPlanesWindowReachesInto) {
  const Scene scene = small_world({0b011, 0b111, 0b110});
  CullerRun run("portal.map_pvs", scene);
  EXPECT_EQ(run.objects(with_a_wide_window()), (std::vector<ObjectId>{0, 1, 2}));
  const Scene apart = small_world({0b001, 0b010, 0b100});
  CullerRun apart_run("portal.map_pvs", apart);
  EXPECT_EQ(apart_run.objects(with_a_wide_window()), (std::vector<ObjectId>{0, 1}));
}

TEST(MapPvs, KeepsEverythingInTheFrustumWhereAWallIsInTheMiddleOfTheWindow) {
  Scene scene = small_world({0b001, 0b010, 0b100});
  auto world = std::make_shared<QuakeWorld>(*scene.quake);
  world->planes.push_back({{1, 0, 0}, -4.2});  // solid from x = 4 on to here
  world->nodes[1].front = 3;
  world->nodes.push_back({3, 2, -1});
  scene.quake = world;
  CullerRun run("portal.map_pvs", scene);
  EXPECT_EQ(run.objects(with_a_wide_window()), (std::vector<ObjectId>{0, 1, 2}));
}

TEST(MapPvs, PassesOverBitsBeyondTheLastCluster) {
  const Scene scene = small_world({0b11111011, 0xff, 0b11110110});
  CullerRun run("portal.map_pvs", scene);
  EXPECT_EQ(run.objects(camera_at({1.0, -3.0, 0.0}, {9.0, -3.0, 0.0})),
            (std::vector<ObjectId>{0, 1}));
  EXPECT_EQ(region_set(run.culler(), 2, scene), (std::vector<ObjectId>{1, 2}));
}

TEST(MapPvs, RefusesAWorldWithoutVisibilityData) {
  const Scene scene = small_world({});
  EXPECT_THROW(CullerRun("portal.map_pvs", scene), InputError);
}

TEST(MapPvs, RefusesSetsThatDoNotFitTheirWorld) {
  Scene scene = small_world({0b011, 0b101, 0b110});
  auto world = std::make_shared<QuakeWorld>(*scene.quake);
  world->report.blind_clusters = 1;
  scene.quake = world;
  EXPECT_THROW(CullerRun("portal.map_pvs", scene), InputError);
}

/// What counters say of the sizes of sets in a frame.
std::pair<std::uint64_t, std::uint64_t> set_sizes(const std::string& spec, const Scene& scene) {
  CullerRun run(spec, scene);
  const Camera camera = camera_at({1.0, -3.0, 0.0}, {9.0, -3.0, 0.0});
  run.update(camera, {});
  const std::pair<std::uint64_t, std::uint64_t> first{run.counter("set_bytes"),
                                                      run.counter("set_raw_bytes")};
  run.objects(camera);
  run.update(camera, {});
  EXPECT_EQ(run.counter("set_bytes"), 2 * first.first) << "once a frame";
  EXPECT_EQ(run.counter("set_raw_bytes"), 2 * first.second);
  EXPECT_GE(run.culler().bytes(), first.first) << "the sets are memory of the method's";
  return first;
}

TEST(MapPvs, ItsSetsHaveTheSizeOfTheMapsRows) {
  // Three clusters in a byte each.
  EXPECT_EQ(set_sizes("portal.map_pvs", small_world({0b011, 0b111, 0b110})),
            (std::pair<std::uint64_t, std::uint64_t>{3, 3}));
}

TEST(Pvs, CompressedRowsAreComparedWithABitForEachPairOfCells) {
  // 201 rooms, of which each sees few others: most bytes of a row are zero.
  std::vector<double> holes(200);
  for (std::size_t i = 0; i < holes.size(); ++i) holes[i] = i % 2 == 0 ? 6.0 : -6.0;
  const auto [stored, raw] = set_sizes("portal.pvs", rooms_with_holes_at(holes));
  EXPECT_EQ(raw, 201U * 26U);
  EXPECT_LT(stored, raw);
  EXPECT_GT(stored, 201U * sizeof(std::uint32_t)) << "where each row begins is a part of it";
}

TEST(MapPvs, InScenesThatAreNoQuakeWorldTheFrustumDecides) {
  const Scene scene = rooms_with_holes_at({0.0, 6.0, -6.0});
  CullerRun run("portal.map_pvs", scene);
  EXPECT_EQ(run.objects(camera_at({1.0, -3.0, 0.0}, {9.0, -3.0, 0.0})),
            (std::vector<ObjectId>{0, 1, 2, 3}));
  EXPECT_FALSE(region_set(run.culler(), 0, scene));
}

}  // namespace
}  // namespace vislab
