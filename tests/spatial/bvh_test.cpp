// What only binary hierarchies have: quality of the builds, runs, and refitting.
#include "common/spatial/bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/random.h"

namespace vislab {
namespace {

using enum Bvh::Build;
using enum Bvh::Motion;

/// Small boxes, most of them in a few dense clusters.
std::vector<Aabb> clusters(std::size_t count) {
  Random random(1);
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const auto cluster = static_cast<float>(random.below(8));
    const glm::vec3 middle = glm::vec3(cluster * 37.0F, cluster * cluster * 11.0F, cluster * -5.0F);
    const double x = random.uniform(-10.0, 10.0);
    const double y = random.uniform(-2.0, 2.0);
    const glm::vec3 center = middle + glm::vec3(x, y, random.uniform(-10.0, 10.0));
    boxes.push_back({center - 0.1F, center + 0.1F});
  }
  return boxes;
}

double area_of(Bvh::Build build, const std::vector<Aabb>& boxes) {
  Bvh bvh({build, refit, 1});
  bvh.build(boxes);
  EXPECT_NO_THROW(bvh.audit(boxes, boxes.size()));
  return bvh.surface_area();
}

TEST(Bvh, BuildsByAreasAreBetterThanHalvesOfTheZCurve) {
  const std::vector<Aabb> boxes = clusters(3000);
  const double halves = area_of(packed, boxes);
  EXPECT_LT(area_of(top_down, boxes), 0.9 * halves);
  EXPECT_LT(area_of(bottom_up, boxes), 0.9 * halves);
  EXPECT_LT(area_of(incremental, boxes), 0.9 * halves);
}

TEST(Bvh, LeavesHaveAtMostSoManyObjects) {
  const std::vector<Aabb> boxes = clusters(1000);
  for (const Bvh::Build build : {top_down, bottom_up, incremental, packed}) {
    for (const std::uint32_t most : {1U, 3U, 8U, 50U}) {
      Bvh bvh({build, refit, most});
      bvh.build(boxes);
      std::size_t largest = 0;
      for (Bvh::NodeIndex node = 0; node < bvh.nodes().size(); ++node) {
        largest = std::max(largest, bvh.objects_at(node).size());
      }
      EXPECT_LE(largest, most);
      EXPECT_GT(largest, most / 2);
    }
  }
}

TEST(Bvh, KeepsSubtreesAsRunsUntilObjectsComeOrGo) {
  std::vector<Aabb> boxes = clusters(200);
  for (const Bvh::Build build : {top_down, bottom_up, incremental, packed}) {
    Bvh bvh({build, refit, 4});
    bvh.build(boxes);
    EXPECT_EQ(bvh.objects_below(Bvh::root).size(), 200U);
    bvh.move(7, {glm::vec3(900.0F), glm::vec3(901.0F)});
    bvh.finish_changes();
    EXPECT_EQ(bvh.objects_below(Bvh::root).size(), 200U);
    bvh.remove(3);
    bvh.finish_changes();
    EXPECT_TRUE(bvh.objects_below(Bvh::root).empty());
  }
}

TEST(Bvh, RefittingShrinksAndEnlargingDoesNot) {
  const std::vector<Aabb> start = clusters(500);
  const auto area_after_excursion = [&](Bvh::Motion motion) {
    std::vector<Aabb> boxes = start;
    Bvh bvh({top_down, motion, 4});
    bvh.build(boxes);
    const double before = bvh.surface_area();
    for (ObjectId object = 0; object < 500; object += 50) {
      bvh.move(object, {glm::vec3(5000.0F), glm::vec3(5001.0F)});
    }
    bvh.finish_changes();
    for (ObjectId object = 0; object < 500; object += 50) bvh.move(object, start[object]);
    bvh.finish_changes();
    EXPECT_NO_THROW(bvh.audit(boxes, boxes.size()));
    return bvh.surface_area() / before;
  };
  EXPECT_DOUBLE_EQ(area_after_excursion(refit), 1.0);
  EXPECT_GT(area_after_excursion(enlarge), 100.0);
  EXPECT_LT(area_after_excursion(reinsert), 1.5);
  EXPECT_DOUBLE_EQ(area_after_excursion(rebuild), 1.0);
}

TEST(Bvh, ReinsertingStaysNearTheQualityOfABuildWhenAllMix) {
  std::vector<Aabb> boxes = clusters(1000);
  Bvh refitted({top_down, refit, 4});
  Bvh reinserted({top_down, reinsert, 4});
  refitted.build(boxes);
  reinserted.build(boxes);
  std::ranges::reverse(boxes);
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    refitted.move(object, boxes[object]);
    reinserted.move(object, boxes[object]);
  }
  refitted.finish_changes();
  reinserted.finish_changes();
  ASSERT_NO_THROW(refitted.audit(boxes, boxes.size()));
  ASSERT_NO_THROW(reinserted.audit(boxes, boxes.size()));
  EXPECT_LT(reinserted.surface_area() * 3.0, refitted.surface_area());
}

TEST(Bvh, DoesNotMakeAChainOfEqualBoxes) {
  const std::vector<Aabb> boxes(4096, {glm::vec3(1.0F), glm::vec3(2.0F)});
  for (const Bvh::Build build : {top_down, bottom_up, incremental, packed}) {
    Bvh bvh({build, refit, 1});
    bvh.build(boxes);
    std::size_t depth = 0;
    std::vector<std::pair<Bvh::NodeIndex, std::size_t>> open{{Bvh::root, 0}};
    while (!open.empty()) {
      const auto [node, level] = open.back();
      open.pop_back();
      depth = std::max(depth, level);
      for (std::uint32_t i = 0; i < bvh.nodes()[node].child_count; ++i) {
        open.emplace_back(bvh.nodes()[node].first_child + i, level + 1);
      }
    }
    EXPECT_LE(depth, 24U) << static_cast<int>(build);
  }
}

}  // namespace
}  // namespace vislab
