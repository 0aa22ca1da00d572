#include "common/judge/region_truth.h"

#include <gtest/gtest.h>

#include <numeric>

#include "common/scene/error.h"
#include "common/scene/quake_world.h"
#include "tests/algorithms/portal_rooms.h"

namespace vislab {
namespace {

constexpr RegionSettings few{8, 200, 1, 2};

std::vector<CellId> all_cells(const Scene& scene) {
  std::vector<CellId> cells(scene.cells.size());
  std::iota(cells.begin(), cells.end(), 0U);
  return cells;
}

std::vector<ObjectId> all_objects(const Scene& scene) {
  std::vector<ObjectId> objects(scene.object_count());
  std::iota(objects.begin(), objects.end(), 0U);
  return objects;
}

TEST(RegionTruth, ASetThatHoldsAllMissesNothingAndItsExcessIsWhatNoRayHits) {
  const Scene scene = make_room_line({.rooms = 5});
  RegionJudge judge(scene, few);
  const std::vector<CellTruth> truth = judge.trace(all_cells(scene));
  const RegionVerdict verdict = judge.judge(truth, [&](CellId) { return all_objects(scene); });
  EXPECT_EQ(verdict.misses + verdict.strays, 0U);
  EXPECT_EQ(verdict.rays, 5U * 8U * 200U);
  EXPECT_EQ(verdict.hits, verdict.rays) << "the rooms are closed";
  EXPECT_EQ(verdict.kept, 5 * scene.object_count());
  EXPECT_EQ(verdict.seen + verdict.unseen, verdict.kept);
  EXPECT_GT(verdict.unseen, 0U);
  EXPECT_DOUBLE_EQ(verdict.over(),
                   static_cast<double>(verdict.unseen) / static_cast<double>(verdict.seen));
  EXPECT_GE(verdict.over_points(), verdict.over()) << "a point sees no more than its cell";
}

TEST(RegionTruth, EveryRayThatHitsWhatASetLeavesOutIsAMiss) {
  const Scene scene = make_room_line({.rooms = 2});
  RegionJudge judge(scene, few);
  const std::vector<CellTruth> truth = judge.trace(all_cells(scene));
  const ObjectId left_out = truth[1].seen.back().object;
  std::uint64_t expected = 0;
  for (const CellTruth& cell : truth) {
    for (const ObjectRays& seen : cell.seen) {
      if (seen.object == left_out) expected += seen.rays;
    }
  }
  const RegionVerdict verdict = judge.judge(truth, [&](CellId) {
    std::vector<ObjectId> set = all_objects(scene);
    std::erase(set, left_out);
    return set;
  });
  EXPECT_GT(expected, 0U);
  EXPECT_EQ(verdict.misses, expected);
  EXPECT_EQ(verdict.strays, 0U);
  ASSERT_FALSE(verdict.witnesses.empty());
  EXPECT_EQ(verdict.witnesses.front().object, left_out);
}

TEST(RegionTruth, RaysThatLeaveTheCellsAreNoFaultOfASet) {
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  scene.objects.push_back({0, box_transform({4.0, 0.5, 0.5}, glm::dvec3(1.0)), none_id});
  scene.cells.resize(1);
  scene.cells[0].regions = {rooms_of_tests::box_region({0, 0, 0}, {1, 1, 1})};
  scene.cells[0].bounds = scene.cells[0].regions[0].bounds;
  scene.finish();
  RegionJudge judge(scene, few);
  const std::vector<CellTruth> truth = judge.trace(all_cells(scene));
  const RegionVerdict verdict = judge.judge(truth, [](CellId) { return std::vector<ObjectId>(); });
  EXPECT_GT(verdict.hits, 0U);
  EXPECT_EQ(verdict.strays, verdict.hits);
  EXPECT_EQ(verdict.misses, 0U);
}

TEST(RegionTruth, DoesNotDependOnTheNumberOfThreads) {
  const Scene scene = make_room_line({.rooms = 4, .holes = 2});
  const auto seen_with = [&](int threads) {
    RegionJudge judge(scene, {4, 100, 7, threads});
    std::vector<std::array<std::uint64_t, 4>> seen;
    for (const CellTruth& cell : judge.trace(all_cells(scene))) {
      for (const ObjectRays& rays : cell.seen) {
        seen.push_back({cell.cell, rays.object, rays.rays, cell.seen_by_points});
      }
    }
    return seen;
  };
  EXPECT_EQ(seen_with(1), seen_with(2));
}

TEST(RegionTruth, NobodyStandsInACellThinnerThanFloatsAre) {
  Scene scene = make_room_line({.rooms = 2});
  scene.cells[1].regions = {rooms_of_tests::box_region({4, 0, 0}, {4 + 1e-5, 1, 1})};
  RegionJudge judge(scene, few);
  const std::vector<CellTruth> truth = judge.trace(all_cells(scene));
  EXPECT_EQ(truth[0].viewpoints, few.viewpoints);
  EXPECT_EQ(truth[1].viewpoints, 0U);
}

TEST(RegionTruth, InAQuakeWorldOnlyCellsThatPortalsJoinWithAPlaceAreReachable) {
  Scene scene = make_room_line({.rooms = 4});
  EXPECT_EQ(reachable_cells(scene), all_cells(scene)) << "no Quake III world";
  auto world = std::make_shared<QuakeWorld>();
  world->leaves.resize(4);
  world->cell_of_leaf = {0, 1, 2, 3};
  world->places.push_back({"info_player_start", {}, 0.0, 1});
  scene.quake = world;
  std::erase_if(scene.portals, [](const Portal& portal) { return portal.from + portal.to == 5; });
  EXPECT_EQ(reachable_cells(scene), (std::vector<CellId>{0, 1, 2}));
}

TEST(RegionTruth, RefusesToTraceNoRays) {
  const Scene scene = make_room_line({.rooms = 2});
  EXPECT_THROW(RegionJudge(scene, {8, 0, 1, 1}), InputError);
  EXPECT_THROW(RegionJudge(scene, {0, 8, 1, 1}), InputError);
}

}  // namespace
}  // namespace vislab
