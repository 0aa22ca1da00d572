// What is particular to each kind of octree and partition.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "common/geometry/random.h"
#include "common/spatial/bsp.h"
#include "common/spatial/leaf_octree.h"
#include "common/spatial/loose_octree.h"
#include "common/spatial/octree_cells.h"

namespace vislab {
namespace {

using NodeIndex = SpatialStructure::NodeIndex;

Aabb cube(const glm::vec3& center, float half) {
  return {center - glm::vec3(half), center + glm::vec3(half)};
}

/// Two points that make a root from -8 to 8, and objects between them.
std::vector<Aabb> within_sixteen(const std::vector<Aabb>& between) {
  std::vector<Aabb> boxes{cube(glm::vec3(-8.0F), 0.0F), cube(glm::vec3(8.0F), 0.0F)};
  boxes.insert(boxes.end(), between.begin(), between.end());
  return boxes;
}

std::vector<Aabb> field(std::uint64_t seed, std::size_t count, double half) {
  Random random(seed);
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 center(random.uniform(-100.0, 100.0), random.uniform(-100.0, 100.0),
                           random.uniform(-100.0, 100.0));
    boxes.push_back(cube(center, static_cast<float>(half)));
  }
  return boxes;
}

/// Depth of every reachable node, by index; -1 for others.
std::vector<int> depths(const SpatialStructure& structure) {
  const auto nodes = structure.nodes();
  std::vector<int> result(nodes.size(), -1);
  std::vector<NodeIndex> open{SpatialStructure::root};
  result[SpatialStructure::root] = 0;
  while (!open.empty()) {
    const NodeIndex node = open.back();
    open.pop_back();
    for (NodeIndex i = 0; i < nodes[node].child_count; ++i) {
      result[nodes[node].first_child + i] = result[node] + 1;
      open.push_back(nodes[node].first_child + i);
    }
  }
  return result;
}

TEST(OctreeCells, AreACubeAroundTheCentreOfTheScene) {
  const Aabb root = root_cube({{-1.0F, 2.0F, 3.0F}, {7.0F, 4.0F, 5.0F}});
  EXPECT_EQ(root, (Aabb{{-1.0F, -1.0F, 0.0F}, {7.0F, 7.0F, 8.0F}}));
  EXPECT_TRUE(root_cube({}).empty());
}

TEST(OctreeCells, ShareTheirPlanesToTheLastBit) {
  Aabb cell = root_cube({{-0.1F, 1e7F, 3.0F}, {0.7F, 1.1e7F, 5.0F}});
  while (can_halve(cell)) {
    for (unsigned i = 0; i < 8; ++i) {
      const Aabb part = octant(cell, i);
      EXPECT_TRUE(cell.contains(part));
      for (const unsigned axis : {0U, 1U, 2U}) {
        const Aabb neighbour = octant(cell, i ^ (1U << axis));
        const int a = static_cast<int>(axis);
        EXPECT_TRUE(part.max[a] == neighbour.min[a] || part.min[a] == neighbour.max[a]);
      }
    }
    cell = octant(cell, 5);
  }
}

TEST(LeafOctree, PutsAnObjectIntoAllLeavesThatItTouches) {
  // One at the centre, one in an octant, one that only touches the plane x = 0 from below.
  const std::vector<Aabb> boxes = within_sixteen(
      {cube(glm::vec3(0.0F), 1.0F), cube(glm::vec3(3.0F), 1.0F), cube({-1.0F, 4.0F, 4.0F}, 1.0F)});
  LeafOctree octree({1, 1});
  octree.build(boxes);
  ASSERT_EQ(octree.nodes().size(), 9U);
  EXPECT_TRUE(octree.objects_at(0).empty());
  std::vector<int> leaves(boxes.size(), 0);
  for (NodeIndex leaf = 1; leaf < 9; ++leaf) {
    for (const ObjectId object : octree.objects_at(leaf)) ++leaves[object];
  }
  EXPECT_EQ(leaves, (std::vector<int>{1, 1, 8, 1, 2}));
  EXPECT_EQ(octree.entry_count(), 13U);
}

TEST(LeafOctree, HalvesUntilTheDepthOrTheNumberIsReached) {
  const std::vector<Aabb> boxes = field(1, 1000, 0.1);
  for (const int depth : {0, 1, 3, 5}) {
    for (const std::uint32_t leaf_objects : {1U, 10U, 1000U}) {
      LeafOctree octree({depth, leaf_objects});
      octree.build(boxes);
      const std::vector<int> depth_of = depths(octree);
      for (NodeIndex node = 0; node < depth_of.size(); ++node) {
        EXPECT_LE(depth_of[node], depth);
        if (octree.nodes()[node].child_count != 0) {
          EXPECT_TRUE(octree.objects_at(node).empty());
        } else if (depth_of[node] < depth) {
          EXPECT_LE(octree.objects_at(node).size(), leaf_objects);
        }
      }
    }
  }
}

TEST(LeafOctree, DoesNotGrowWithoutBoundUnderLargeObjects) {
  const std::vector<Aabb> boxes = field(2, 200, 60.0);
  LeafOctree octree({12, 1});
  octree.build(boxes);
  EXPECT_LE(octree.entry_count(), std::uint64_t{1} << 18U);
  EXPECT_LT(octree.bytes(), 64U << 20U);
}

TEST(LeafOctree, MergesLeavesThatHaveBecomeEmpty) {
  const std::vector<Aabb> boxes = field(3, 500, 0.5);
  LeafOctree octree({6, 4});
  octree.build(boxes);
  EXPECT_GT(octree.nodes()[0].child_count, 0U);
  for (ObjectId object = 2; object < 500; ++object) octree.remove(object);
  EXPECT_EQ(octree.nodes()[0].child_count, 0U);
  EXPECT_EQ(octree.entry_count(), 2U);
}

TEST(LooseOctree, LeavesWhatStraddlesAMainPlaneInTheRootIfItIsStrict) {
  const std::vector<Aabb> boxes =
      within_sixteen({cube({0.0F, 5.0F, 5.0F}, 0.1F), cube({4.0F, 5.0F, 5.0F}, 0.1F),
                      cube({5.0F, 5.0F, 5.0F}, 0.1F)});
  LooseOctree strict({0.0, 3, 0.0, 0});
  strict.build(boxes);
  EXPECT_EQ(strict.node_of(2), SpatialStructure::root);
  const std::vector<int> depth = depths(strict);
  EXPECT_EQ(depth[strict.node_of(3)], 1);  // straddles x = 4
  EXPECT_EQ(depth[strict.node_of(4)], 3);

  LooseOctree loose({0.5, 3, 0.0, 0});
  loose.build(boxes);
  const std::vector<int> loose_depth = depths(loose);
  for (const ObjectId object : {2U, 3U, 4U}) EXPECT_EQ(loose_depth[loose.node_of(object)], 3);
}

TEST(LooseOctree, AsksTheSphereNotTheBox) {
  // The box would fit into the octant, the sphere around it does not.
  const std::vector<Aabb> boxes = within_sixteen({cube({1.1F, 4.0F, 4.0F}, 1.0F)});
  LooseOctree octree({0.0, 1, 0.0, 0});
  octree.build(boxes);
  EXPECT_EQ(octree.node_of(2), SpatialStructure::root);
  octree.move(2, cube({1.8F, 4.0F, 4.0F}, 1.0F));
  EXPECT_NE(octree.node_of(2), SpatialStructure::root);
}

TEST(LooseOctree, StopsAtItsDepthAndAtTheLeastEdge) {
  const std::vector<Aabb> boxes = field(4, 300, 0.01);
  for (const int depth : {1, 4, 7}) {
    LooseOctree octree({1.0, depth, 0.0, 0});
    octree.build(boxes);
    EXPECT_EQ(std::ranges::max(depths(octree)), depth);
  }
  LooseOctree coarse({0.0, 12, 30.0, 0});  // the root's edge is about 200
  coarse.build(boxes);
  EXPECT_EQ(std::ranges::max(depths(coarse)), 2);
}

TEST(LooseOctree, EnlargesItsNodesByTheOverlap) {
  const std::vector<Aabb> boxes = within_sixteen({cube({3.0F, 3.0F, 3.0F}, 0.5F)});
  LooseOctree octree({2.0, 1, 0.0, 0});
  octree.build(boxes);
  const Aabb box = octree.nodes()[octree.node_of(2)].box;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(box.min[axis], -2.0F, 1e-5F);
    EXPECT_NEAR(box.max[axis], 10.0F, 1e-5F);
  }
}

TEST(LooseOctree, GivesBackOctantsThatAreNotNeededAnyMore) {
  std::vector<Aabb> boxes = within_sixteen({});
  for (int i = 0; i < 50; ++i) {
    boxes.push_back(cube(glm::vec3(-7.0F + 0.25F * static_cast<float>(i)), 0.01F));
  }
  for (const std::uint32_t leaf_objects : {0U, 4U}) {
    LooseOctree octree({0.0, 8, 0.0, leaf_objects});
    octree.build(boxes);
    EXPECT_GT(octree.node_count(), 50U);
    for (ObjectId object = 0; object < 52; ++object)
      octree.move(object, cube(glm::vec3(5.0F), 0.1F));
    EXPECT_LE(octree.node_count(), 65U);
    octree.finish_changes();
    const std::vector<Aabb> now(52, cube(glm::vec3(5.0F), 0.1F));
    octree.audit(now, 52);
    for (ObjectId object = 0; object < 52; ++object) octree.remove(object);
    EXPECT_EQ(octree.node_count(), 1U);
    EXPECT_EQ(octree.node_of(3), none_id);
  }
}

TEST(LooseOctree, LetsAnObjectStayWhereItStillFits) {
  const std::vector<Aabb> boxes = within_sixteen({cube({3.0F, 3.0F, 3.0F}, 0.1F)});
  LooseOctree octree({1.0, 4, 0.0, 0});
  octree.build(boxes);
  const NodeIndex node = octree.node_of(2);
  octree.move(2, cube({3.3F, 3.0F, 3.0F}, 0.1F));
  EXPECT_EQ(octree.node_of(2), node);
  octree.move(2, cube({6.0F, 3.0F, 3.0F}, 0.1F));
  EXPECT_NE(octree.node_of(2), node);
}

TEST(AxisBsp, PutsStraddlersWhereItIsTold) {
  using enum AxisBsp::Straddlers;
  // Halved at x = 0: two left, two right, and one across, nearer to the right.
  const std::vector<Aabb> boxes{cube({-8.0F, 0.0F, 0.0F}, 1.0F), cube({-5.0F, 0.0F, 0.0F}, 1.0F),
                                cube({5.0F, 0.0F, 0.0F}, 1.0F), cube({8.0F, 0.0F, 0.0F}, 1.0F),
                                cube({0.5F, 0.0F, 0.0F}, 1.0F)};
  const auto objects = [&](AxisBsp::Straddlers straddlers, NodeIndex node) {
    AxisBsp bsp({straddlers, AxisBsp::Split::midpoint, 1, 1});
    bsp.build(boxes);
    std::vector<ObjectId> ids(bsp.objects_at(node).begin(), bsp.objects_at(node).end());
    std::ranges::sort(ids);
    return ids;
  };
  using Ids = std::vector<ObjectId>;
  EXPECT_EQ(objects(node, 0), (Ids{4}));
  EXPECT_EQ(objects(node, 1), (Ids{0, 1}));
  EXPECT_EQ(objects(both, 0), Ids{});
  EXPECT_EQ(objects(both, 1), (Ids{0, 1, 4}));
  EXPECT_EQ(objects(both, 2), (Ids{2, 3, 4}));
  EXPECT_EQ(objects(centre, 1), (Ids{0, 1}));
  EXPECT_EQ(objects(centre, 2), (Ids{2, 3, 4}));
}

TEST(AxisBsp, DividesByTheMiddleTheMedianOrTheCost) {
  // Nine close together on the left, one far to the right.
  std::vector<Aabb> boxes;
  for (int i = 0; i < 9; ++i) boxes.push_back(cube({static_cast<float>(i), 0.0F, 0.0F}, 0.2F));
  boxes.push_back(cube({100.0F, 0.0F, 0.0F}, 0.2F));
  const auto sizes = [&](AxisBsp::Split split) {
    AxisBsp bsp({AxisBsp::Straddlers::centre, split, 1, 1});
    bsp.build(boxes);
    return std::pair(bsp.objects_at(1).size(), bsp.objects_at(2).size());
  };
  EXPECT_EQ(sizes(AxisBsp::Split::midpoint), std::pair(std::size_t{9}, std::size_t{1}));
  EXPECT_EQ(sizes(AxisBsp::Split::median), std::pair(std::size_t{5}, std::size_t{5}));
  EXPECT_EQ(sizes(AxisBsp::Split::cost), std::pair(std::size_t{9}, std::size_t{1}));
}

TEST(AxisBsp, IsTightAroundItsObjectsAfterChanges) {
  std::vector<Aabb> boxes = field(6, 300, 1.0);
  using enum AxisBsp::Straddlers;
  for (const AxisBsp::Straddlers straddlers : {node, both, centre}) {
    AxisBsp bsp({straddlers, AxisBsp::Split::cost, 16, 4});
    bsp.build(boxes);
    for (ObjectId object = 1; object < 300; ++object) bsp.remove(object);
    bsp.finish_changes();
    EXPECT_EQ(bsp.nodes()[0].box, boxes[0]);
    EXPECT_EQ(bsp.node_count(), 1U);
  }
}

TEST(AxisBsp, EndsWhereAllObjectsAreTheSame) {
  const std::vector<Aabb> boxes(5000, cube(glm::vec3(1.0F), 2.0F));
  using enum AxisBsp::Straddlers;
  for (const AxisBsp::Straddlers straddlers : {node, both, centre}) {
    AxisBsp bsp({straddlers, AxisBsp::Split::cost, 32, 1});
    bsp.build({});
    for (ObjectId object = 0; object < boxes.size(); ++object) bsp.insert(object, boxes[object]);
    bsp.finish_changes();
    EXPECT_EQ(bsp.node_count(), 1U);
    EXPECT_EQ(bsp.objects_at(0).size(), boxes.size());
  }
}

TEST(ObjectRuns, UseTheirBlocksAgain) {
  ObjectRuns runs;
  std::vector<ObjectRuns::Run> all(10);
  Random random(7);
  std::vector<std::vector<ObjectId>> expected(10);
  std::size_t bytes = 0;
  for (int step = 0; step < 50'000; ++step) {
    const auto i = static_cast<std::size_t>(random.below(10));
    const std::uint64_t action = random.below(100);
    if (action == 0) {
      runs.release(all[i]);
      expected[i].clear();
    } else if (action < 50 && !expected[i].empty()) {
      const auto position = static_cast<std::uint32_t>(random.below(expected[i].size()));
      runs.take_out(all[i], position);
      expected[i][position] = expected[i].back();
      expected[i].pop_back();
    } else if (expected[i].size() < 100) {
      runs.push(all[i], static_cast<ObjectId>(step));
      expected[i].push_back(static_cast<ObjectId>(step));
    }
    ASSERT_TRUE(std::ranges::equal(runs.of(all[i]), expected[i]));
    if (step == 10'000) bytes = runs.bytes();
  }
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_TRUE(std::ranges::equal(runs.of(all[i]), expected[i]));
  }
  EXPECT_LE(runs.bytes(), 2 * bytes);
}

}  // namespace
}  // namespace vislab
