// What every octree, partition and hierarchy promises, whatever its kind and limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/geometry/random.h"
#include "common/spatial/bsp.h"
#include "common/spatial/bvh.h"
#include "common/spatial/leaf_octree.h"
#include "common/spatial/loose_octree.h"

namespace vislab {
namespace {

const float nan = std::numeric_limits<float>::quiet_NaN();
const float infinity = std::numeric_limits<float>::infinity();

struct Kind {
  std::string name;
  std::function<std::unique_ptr<SpatialStructure>(int depth, std::uint32_t leaf_objects)> make;
};

std::vector<Kind> kinds() {
  std::vector<Kind> all;
  all.push_back({"leaf octree", [](int depth, std::uint32_t leaf_objects) {
                   return std::make_unique<LeafOctree>(LeafOctree::Limits{depth, leaf_objects});
                 }});
  for (const double overlap : {0.0, 0.5, 5.0}) {
    all.push_back({"loose octree, overlap " + std::to_string(overlap),
                   [overlap](int depth, std::uint32_t leaf_objects) {
                     return std::make_unique<LooseOctree>(
                         LooseOctree::Limits{overlap, depth, 0.0, leaf_objects - 1});
                   }});
  }
  using enum Bvh::Build;
  for (const Bvh::Build build : {top_down, bottom_up, incremental, packed}) {
    using enum Bvh::Motion;
    for (const Bvh::Motion motion : {refit, enlarge, reinsert, rebuild}) {
      all.push_back({"BVH, build " + std::to_string(static_cast<int>(build)) + ", motion " +
                         std::to_string(static_cast<int>(motion)),
                     [=](int /*depth*/, std::uint32_t leaf_objects) {
                       return std::make_unique<Bvh>(Bvh::Limits{build, motion, leaf_objects});
                     }});
    }
  }
  using enum AxisBsp::Straddlers;
  for (const AxisBsp::Straddlers straddlers : {node, both, centre}) {
    using enum AxisBsp::Split;
    for (const AxisBsp::Split split : {midpoint, median, cost}) {
      all.push_back({"partition, straddlers " + std::to_string(static_cast<int>(straddlers)) +
                         ", split " + std::to_string(static_cast<int>(split)),
                     [=](int depth, std::uint32_t leaf_objects) {
                       return std::make_unique<AxisBsp>(
                           AxisBsp::Limits{straddlers, split, depth, leaf_objects});
                     }});
    }
  }
  return all;
}

Aabb cube(const glm::vec3& center, float half) {
  return {center - glm::vec3(half), center + glm::vec3(half)};
}

glm::vec3 point(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach),
          random.uniform(-reach, reach)};
}

/// Mostly small boxes between -100 and 100; some flat, long, huge, far away or broken.
Aabb some_box(Random& random) {
  const glm::vec3 center = point(random, 100.0);
  switch (random.below(40)) {
    case 0:
      return {center, center};
    case 1:
      return {center, center + glm::vec3(0.0F, 50.0F, 1.0F)};
    case 2:
      return cube(center, 500.0F);
    case 3:
      return cube(center * 1e6F, 20.0F);
    case 4:
      return {center, {nan, 1.0F, 1.0F}};
    case 5:
      return {center, {infinity, 200.0F, 200.0F}};
    case 6:
      return {};
    case 7:
      return cube(glm::vec3(0.0F), static_cast<float>(random.uniform(0.0, 2.0)));
    default:
      return cube(center, static_cast<float>(random.uniform(0.01, 3.0)));
  }
}

std::vector<Aabb> random_boxes(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) boxes.push_back(some_box(random));
  return boxes;
}

/// Small boxes between -100 and 100.
std::vector<Aabb> near_boxes(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 center = point(random, 100.0);
    boxes.push_back(cube(center, static_cast<float>(random.uniform(0.01, 3.0))));
  }
  return boxes;
}

TEST(EveryStructure, FindsEachObjectAtEveryDepthAndLeafSize) {
  const std::vector<Aabb> boxes = near_boxes(1, 100);
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    for (int depth = 0; depth <= 12; ++depth) {
      for (const std::uint32_t leaf_objects : {1U, 8U}) {
        SCOPED_TRACE(depth);
        const auto structure = kind.make(depth, leaf_objects);
        structure->build(boxes);
        ASSERT_NO_THROW(structure->audit(boxes, boxes.size()));
        EXPECT_TRUE(structure->unplaced().empty());
      }
    }
  }
}

TEST(EveryStructure, FindsLongFlatHugeAndFarObjects) {
  std::vector<Aabb> boxes = near_boxes(1, 60);
  boxes.push_back({{-90.0F, 3.0F, 3.0F}, {90.0F, 3.5F, 3.0F}});
  boxes.push_back(cube({0.0F, 0.0F, 0.0F}, 60.0F));
  const std::vector<Aabb> wild = random_boxes(1, 100);
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    for (const std::vector<Aabb>& those : {wild, boxes}) {
      const auto structure = kind.make(4, 2);
      structure->build(those);
      ASSERT_NO_THROW(structure->audit(those, those.size()));
    }
  }
}

TEST(EveryStructure, KeepsBrokenBoxesUnplacedAndNothingElseWhenBuilt) {
  Random random(2);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 200; ++i) boxes.push_back(cube(point(random, 50.0), 1.0F));
  boxes[7].min.y = nan;
  boxes[8].max.x = infinity;
  boxes[9] = {};
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const auto structure = kind.make(6, 4);
    structure->build(boxes);
    EXPECT_EQ(std::vector<ObjectId>(structure->unplaced().begin(), structure->unplaced().end()),
              (std::vector<ObjectId>{7, 8, 9}));
  }
}

TEST(EveryStructure, LosesNothingInAHundredThousandChanges) {
#ifdef __SANITIZE_ADDRESS__
  constexpr int steps = 20'000;  // the sanitizers take ten times as long
#else
  constexpr int steps = 100'000;
#endif
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const auto structure = kind.make(7, 4);
    constexpr std::size_t count = 500;
    // A root that is not laid around what is far away, so that there is work in the tree.
    std::vector<Aabb> boxes = near_boxes(3, count);
    structure->build(boxes);
    std::vector<bool> in(count, true);
    std::size_t inside = count;
    Random random(4);
    for (int step = 0; step < steps; ++step) {
      const auto object = static_cast<ObjectId>(random.below(count));
      if (!in[object]) {
        boxes[object] = some_box(random);
        structure->insert(object, boxes[object]);
        in[object] = true;
        ++inside;
      } else if (random.below(4) == 0) {
        structure->remove(object);
        in[object] = false;
        --inside;
      } else if (random.below(3) == 0 || !boxes[object].valid()) {
        boxes[object] = some_box(random);
        structure->move(object, boxes[object]);
      } else {
        const glm::vec3 way = point(random, 1.0);
        boxes[object] = {boxes[object].min + way, boxes[object].max + way};
        structure->move(object, boxes[object]);
      }
      if (step % (steps / 20) == 0) {
        structure->finish_changes();
        ASSERT_NO_THROW(structure->audit(boxes, inside)) << step;
      }
    }
    structure->finish_changes();
    ASSERT_NO_THROW(structure->audit(boxes, inside));
  }
}

TEST(EveryStructure, GivesItsMemoryBackToItself) {
#ifdef __SANITIZE_ADDRESS__
  constexpr int steps = 5'000;  // the sanitizers take ten times as long
#else
  constexpr int steps = 20'000;
#endif
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const auto structure = kind.make(8, 4);
    constexpr std::size_t count = 400;
    Random random(5);
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < count; ++i) boxes.push_back(cube(point(random, 100.0), 1.0F));
    structure->build(boxes);
    const auto churn = [&](int moves) {
      for (int step = 0; step < moves; ++step) {
        const auto object = static_cast<ObjectId>(random.below(count));
        boxes[object] = cube(point(random, 90.0), static_cast<float>(random.uniform(0.1, 2.0)));
        structure->move(object, boxes[object]);
      }
      structure->finish_changes();
    };
    churn(steps);
    const std::size_t before = structure->bytes();
    churn(5 * steps);
    EXPECT_LE(structure->bytes(), 2 * before);
  }
}

TEST(EveryStructure, TakesUpObjectsThatLeaveTheRootAndComeBack) {
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const auto structure = kind.make(5, 2);
    Random random(6);
    std::vector<Aabb> boxes;
    for (int i = 0; i < 100; ++i) boxes.push_back(cube(point(random, 50.0), 1.0F));
    const std::vector<Aabb> start = boxes;
    structure->build(boxes);
    for (ObjectId object = 0; object < 30; ++object) {
      boxes[object] = cube({1e4F, -2e5F, 3e3F + static_cast<float>(object)}, 1.0F);
      structure->move(object, boxes[object]);
    }
    structure->finish_changes();
    ASSERT_NO_THROW(structure->audit(boxes, 100));
    // All leave: the root follows, if there is one to follow.
    for (ObjectId object = 30; object < 100; ++object) {
      boxes[object] = cube(glm::vec3(1e4F, -2e5F, 3e3F) + point(random, 50.0), 1.0F);
      structure->move(object, boxes[object]);
    }
    structure->finish_changes();
    ASSERT_NO_THROW(structure->audit(boxes, 100));
    EXPECT_LT(structure->unplaced().size(), 51U);
    boxes = start;
    for (ObjectId object = 0; object < 100; ++object) structure->move(object, boxes[object]);
    structure->finish_changes();
    ASSERT_NO_THROW(structure->audit(boxes, 100));
    EXPECT_LT(structure->unplaced().size(), 51U);
  }
}

TEST(EveryStructure, HoldsObjectsBiggerThanItsRoot) {
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const auto structure = kind.make(5, 1);
    std::vector<Aabb> boxes{cube({-3, -3, -3}, 1), cube({3, 3, 3}, 1), cube({2, 2, 2}, 1)};
    structure->build(boxes);
    boxes.push_back(cube({0, 0, 0}, 100.0F));
    structure->insert(3, boxes[3]);
    boxes[0] = cube({0, 0, 0}, 1e38F);
    structure->move(0, boxes[0]);
    structure->finish_changes();
    ASSERT_NO_THROW(structure->audit(boxes, 4));
    structure->remove(3);
    structure->remove(0);
    structure->finish_changes();
    ASSERT_NO_THROW(structure->audit(boxes, 2));
  }
}

TEST(EveryStructure, IsWholeWhenAllBoxesAreOnePoint) {
  const std::vector<Aabb> boxes(300, {{5.0F, -6.0F, 7.0F}, {5.0F, -6.0F, 7.0F}});
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const auto structure = kind.make(12, 1);
    structure->build(boxes);
    ASSERT_NO_THROW(structure->audit(boxes, boxes.size()));
    EXPECT_TRUE(structure->unplaced().empty());
    EXPECT_LT(structure->nodes().size(), 2'000U);
  }
}

TEST(EveryStructure, IsWholeWhereFloatHasFewNumbers) {
  // Around 1e8 floats are 8 apart: cells cannot be halved often.
  std::vector<Aabb> boxes;
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 corner(1e8F + 8.0F * static_cast<float>(i % 7), -1e8F,
                           1e8F + 8.0F * static_cast<float>(i / 7));
    boxes.push_back({corner, corner + glm::vec3(8.0F)});
  }
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const auto structure = kind.make(12, 1);
    structure->build(boxes);
    ASSERT_NO_THROW(structure->audit(boxes, boxes.size()));
    for (ObjectId object = 0; object < 200; object += 3) {
      boxes[object].min.y += 8.0F;
      boxes[object].max.y += 24.0F;
      structure->move(object, boxes[object]);
    }
    structure->finish_changes();
    ASSERT_NO_THROW(structure->audit(boxes, boxes.size()));
  }
}

TEST(EveryStructure, BeginsWithNothingAndCanBeEmptied) {
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const auto structure = kind.make(6, 2);
    EXPECT_EQ(structure->nodes().size(), 1U);
    structure->build({});
    EXPECT_TRUE(structure->nodes()[0].box.empty());
    std::vector<Aabb> boxes = random_boxes(8, 100);
    for (ObjectId object = 0; object < 100; ++object) structure->insert(object, boxes[object]);
    structure->finish_changes();
    ASSERT_NO_THROW(structure->audit(boxes, 100));
    for (ObjectId object = 0; object < 100; ++object) structure->remove(object);
    structure->finish_changes();
    ASSERT_NO_THROW(structure->audit(boxes, 0));
    EXPECT_TRUE(structure->nodes()[0].box.empty());
    EXPECT_EQ(structure->nodes()[0].child_count, 0U);
  }
}

TEST(EveryStructure, IsTheSameAgainAfterTheSameCalls) {
  const std::vector<Aabb> boxes = random_boxes(9, 300);
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const auto first = kind.make(6, 4);
    const auto again = kind.make(6, 4);
    again->build(random_boxes(10, 500));
    for (SpatialStructure* structure : {first.get(), again.get()}) {
      structure->build(boxes);
      for (ObjectId object = 0; object < 300; object += 2) {
        structure->move(object, boxes[299 - object]);
      }
      structure->finish_changes();
    }
    const auto nodes = first->nodes();
    ASSERT_EQ(nodes.size(), again->nodes().size());
    for (std::uint32_t node = 0; node < nodes.size(); ++node) {
      EXPECT_EQ(nodes[node].box, again->nodes()[node].box);
      EXPECT_TRUE(std::ranges::equal(first->objects_at(node), again->objects_at(node)));
    }
    EXPECT_TRUE(std::ranges::equal(first->unplaced(), again->unplaced()));
  }
}

TEST(EveryStructure, RefusesIdsThatAreInTwiceOrNotAtAll) {
  const std::vector<Aabb> boxes = random_boxes(11, 10);
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const auto structure = kind.make(6, 4);
    structure->build(boxes);
    EXPECT_THROW(structure->insert(3, boxes[3]), std::logic_error);
    structure->remove(3);
    EXPECT_THROW(structure->remove(3), std::logic_error);
    EXPECT_THROW(structure->move(3, boxes[3]), std::logic_error);
    EXPECT_THROW(structure->remove(1000), std::logic_error);
    structure->insert(1000, boxes[3]);
    EXPECT_NO_THROW(structure->remove(1000));
  }
}

}  // namespace
}  // namespace vislab
