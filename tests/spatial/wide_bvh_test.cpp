#include "common/spatial/wide_bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "common/geometry/random.h"
#include "common/simd/simd_target.h"
#include "common/spatial/bvh.h"
#include "tests/geometry/adversarial_boxes.h"

namespace vislab {
namespace {

const float nan = std::numeric_limits<float>::quiet_NaN();
const float infinity = std::numeric_limits<float>::infinity();

/// One way to make the hierarchy.
struct Way {
  std::string name;
  std::function<void(WideBvh&, std::span<const Aabb>)> build;
};

std::vector<Way> ways() {
  std::vector<Way> all;
  for (const auto order : {WideBvh::Order::median, WideBvh::Order::morton}) {
    all.push_back(
        {order == WideBvh::Order::median ? "median" : "morton",
         [order](WideBvh& bvh, std::span<const Aabb> boxes) { bvh.build(boxes, order); }});
  }
  using enum Bvh::Build;
  for (const Bvh::Build build : {top_down, bottom_up, incremental, packed}) {
    for (const std::uint32_t leaf_objects : {1U, 5U, 8U}) {
      all.push_back({"build " + std::to_string(static_cast<int>(build)) + ", leaves of " +
                         std::to_string(leaf_objects),
                     [=](WideBvh& bvh, std::span<const Aabb> boxes) {
                       Bvh tree({build, Bvh::Motion::refit, leaf_objects});
                       tree.build(boxes);
                       bvh.build(boxes, tree);
                     }});
    }
  }
  return all;
}

Aabb cube(const glm::vec3& center, float half) {
  return {center - glm::vec3(half), center + glm::vec3(half)};
}

glm::vec3 point(Random& random, double reach) {
  return glm::vec3(test::random_vector(random, reach));
}

std::vector<Aabb> field(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 center = point(random, 100.0);
    boxes.push_back(cube(center, static_cast<float>(random.uniform(0.1, 2.0))));
  }
  return boxes;
}

Camera some_camera(Random& random) {
  const glm::dvec3 eye = test::random_vector(random, 100.0);
  return {look_at(eye, eye + test::random_vector(random, 1.0)),
          perspective_lens(1.0, 1.5, 0.1, 90.0)};
}

/// What is present and not surely outside of a plane, by ascending id.
std::vector<ObjectId> expected(const Frustum& frustum, std::span<const Aabb> boxes,
                               const std::vector<bool>& present) {
  std::vector<ObjectId> ids;
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    const bool outside = std::ranges::any_of(
        frustum.span(), [&](const Plane& plane) { return surely_outside(plane, boxes[object]); });
    if (present[object] && !outside) ids.push_back(object);
  }
  return ids;
}

std::vector<ObjectId> ids_of(const WideSelection& selection) {
  std::vector<ObjectId> ids;
  for (const auto run : selection.runs) ids.insert(ids.end(), run.begin(), run.end());
  std::ranges::sort(ids);
  return ids;
}

std::vector<ObjectId> answer(const WideBvh& bvh, const Frustum& frustum,
                             std::span<const Aabb> boxes, WideBvh::QueryOptions options = {}) {
  WideSelection selection;
  bvh.query(frustum, boxes, options, selection);
  return ids_of(selection);
}

TEST(WideBvh, GivesTheDefinitionsAnswersHoweverItWasBuilt) {
  for (const std::size_t count : {0, 1, 7, 8, 9, 64, 65, 513, 3000}) {
    const std::vector<Aabb> boxes = field(count, count);
    const std::vector<bool> present(count, true);
    for (const Way& way : ways()) {
      SCOPED_TRACE(way.name + ", " + std::to_string(count) + " boxes");
      WideBvh bvh;
      way.build(bvh, boxes);
      ASSERT_NO_THROW(bvh.audit(boxes));
      Random random(1);
      for (int i = 0; i < 20; ++i) {
        const Frustum frustum = frustum_of(some_camera(random));
        const std::vector<ObjectId> right = expected(frustum, boxes, present);
        EXPECT_EQ(answer(bvh, frustum, boxes), right);
        EXPECT_EQ(answer(bvh, frustum, boxes, {.masking = false}), right);
        const std::vector<ObjectId> more = answer(bvh, frustum, boxes, {.keep_intersecting = true});
        EXPECT_TRUE(std::ranges::includes(more, right));
      }
    }
  }
}

TEST(WideBvh, GivesTheDefinitionsAnswersOnHardBoxesWithEveryInstructionSet) {
  constexpr std::size_t count = 2000;
  Random random(5);
  for (int round = 0; round < 60; ++round) {
    Camera camera = test::adversarial_camera(random);
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < count; ++i) boxes.push_back(test::adversarial_box(random, camera));
    for (int i = 0; i < 5; ++i) boxes[random.below(count)].min.x = nan;
    boxes[random.below(count)].max.y = infinity;
    boxes[random.below(count)] = {};
    camera = test::touching_camera(random, camera, boxes[round * 7 % count]);
    const Frustum frustum = frustum_of(camera);
    const std::vector<ObjectId> right = expected(frustum, boxes, std::vector<bool>(count, true));
    const std::vector<Way> all = ways();
    WideBvh bvh;
    const Way& way = all[static_cast<std::size_t>(round) % all.size()];
    way.build(bvh, boxes);
    ASSERT_NO_THROW(bvh.audit(boxes)) << way.name;
    for (const std::string& target : simd_targets()) {
      const SimdTargetScope scope(target);
      ASSERT_EQ(answer(bvh, frustum, boxes), right) << way.name << ", " << target << ", " << round;
      ASSERT_EQ(answer(bvh, frustum, boxes, {.masking = false}), right) << target;
    }
  }
}

TEST(WideBvh, LosesNothingInAHundredThousandChanges) {
  constexpr std::size_t count = 1000;
  std::vector<Aabb> boxes = field(count, 3);
  std::vector<bool> present(count, true);
  WideBvh bvh;
  bvh.build(boxes, WideBvh::Order::median);
  Random random(4);
  for (int step = 1; step <= 100'000; ++step) {
    const auto object = static_cast<ObjectId>(random.below(count));
    switch (random.below(8)) {
      case 0:
        present[object] = !present[object];
        bvh.set_present(object, boxes[object], present[object]);
        break;
      case 1:
        boxes[object] = cube(point(random, 1e7), 5.0F);
        bvh.move(object, boxes[object]);
        break;
      case 2:
        boxes[object].max.z = random.below(2) == 0 ? nan : infinity;
        bvh.move(object, boxes[object]);
        break;
      default:
        boxes[object] = cube(point(random, 110.0), 1.0F);
        bvh.move(object, boxes[object]);
    }
    if (step % 2'500 != 0) continue;
    if (step % 20'000 == 0) {
      bvh.rebuild(boxes, WideBvh::Order::morton);
    } else {
      bvh.refit();
    }
    ASSERT_NO_THROW(bvh.audit(boxes)) << step;
    const Frustum frustum = frustum_of(some_camera(random));
    ASSERT_EQ(answer(bvh, frustum, boxes), expected(frustum, boxes, present)) << step;
  }
}

TEST(WideBvh, LeavesOutWhatIsNotPresentInsideOfLongRuns) {
  const std::vector<Aabb> boxes = field(5000, 9);
  WideBvh bvh;
  bvh.build(boxes, WideBvh::Order::median);
  // Everything is in view.
  const Frustum frustum = frustum_of(
      {look_at({0.0, 0.0, 500.0}, {0.0, 0.0, 0.0}), perspective_lens(1.0, 1.0, 0.1, 1000.0)});
  std::vector<bool> present(boxes.size(), true);
  EXPECT_EQ(answer(bvh, frustum, boxes), expected(frustum, boxes, present));
  Random random(1);
  for (const std::size_t hidden : {1U, 10U, 3000U, 5000U}) {
    for (std::size_t i = 0; i < hidden; ++i) {
      const auto object = hidden == boxes.size() ? static_cast<ObjectId>(i)
                                                 : static_cast<ObjectId>(random.below(5000));
      present[object] = false;
      bvh.set_present(object, boxes[object], false);
    }
    bvh.refit();
    EXPECT_EQ(answer(bvh, frustum, boxes), expected(frustum, boxes, present));
    EXPECT_EQ(answer(bvh, frustum, boxes, {.keep_intersecting = true}),
              expected(frustum, boxes, present));
  }
}

TEST(WideBvh, StaysRightAndKnowsThatItDecaysWhenAllMix) {
  std::vector<Aabb> boxes = field(4000, 11);
  WideBvh bvh;
  bvh.build(boxes, WideBvh::Order::median);
  EXPECT_DOUBLE_EQ(bvh.decay(), 1.0);
  Random random(2);
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    boxes[object] = cube(point(random, 100.0), 1.0F);
    bvh.move(object, boxes[object]);
  }
  bvh.refit();
  EXPECT_GT(bvh.decay(), 5.0);
  ASSERT_NO_THROW(bvh.audit(boxes));
  const std::vector<bool> present(boxes.size(), true);
  const Frustum frustum = frustum_of(some_camera(random));
  EXPECT_EQ(answer(bvh, frustum, boxes), expected(frustum, boxes, present));
  bvh.rebuild(boxes, WideBvh::Order::median);
  EXPECT_DOUBLE_EQ(bvh.decay(), 1.0);
  EXPECT_EQ(answer(bvh, frustum, boxes), expected(frustum, boxes, present));
}

TEST(WideBvh, HasNotDecayedWhenWhatWasAbsentInARebuildIsShownInItsPlace) {
  const std::vector<Aabb> boxes = field(4000, 11);
  WideBvh bvh;
  bvh.build(boxes, WideBvh::Order::median);
  std::vector<bool> present(boxes.size(), true);
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    if (object % 100 == 0) continue;
    bvh.set_present(object, boxes[object], false);
    present[object] = false;
  }
  bvh.rebuild(boxes, WideBvh::Order::morton);
  EXPECT_LT(bvh.decay(), 1.0);
  ASSERT_NO_THROW(bvh.audit(boxes));
  Random random(4);
  const Frustum frustum = frustum_of(some_camera(random));
  EXPECT_EQ(answer(bvh, frustum, boxes), expected(frustum, boxes, present));
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    bvh.set_present(object, boxes[object], true);
  }
  bvh.refit();
  EXPECT_NEAR(bvh.decay(), 1.0, 1e-9);
}

TEST(WideBvh, DoesNotLetAFewFarObjectsBlurTheOthers) {
  std::vector<Aabb> boxes = field(4000, 13);
  for (ObjectId object = 0; object < 20; ++object) {
    boxes[object * 100] = cube(glm::vec3(1e8F, -1e8F, 1e8F), 10.0F);
  }
  WideBvh bvh;
  bvh.build(boxes, WideBvh::Order::median);
  EXPECT_EQ(bvh.apart_count(), 20U);
  Random random(3);
  const Frustum frustum = frustum_of(some_camera(random));
  WideSelection selection;
  bvh.query(frustum, boxes, {}, selection);
  EXPECT_EQ(ids_of(selection), expected(frustum, boxes, std::vector<bool>(boxes.size(), true)));
  EXPECT_LT(selection.undecided_tests, 25U);
}

TEST(WideBvh, LooksAtLittleOfALargeField) {
  const std::vector<Aabb> boxes = field(50'000, 17);
  WideBvh bvh;
  bvh.build(boxes, WideBvh::Order::median);
  const Frustum frustum = frustum_of(
      {look_at({0.0, 0.0, 0.0}, {1.0, 0.2, 0.3}), perspective_lens(1.0, 1.5, 0.1, 90.0)});
  WideSelection selection;
  bvh.query(frustum, boxes, {}, selection);
  EXPECT_LT(selection.blocks_tested, boxes.size() / 8 / 6);
  const std::size_t plane_tests = selection.plane_tests;
  bvh.query(frustum, boxes, {.masking = false}, selection);
  EXPECT_GT(selection.plane_tests - plane_tests, 2 * plane_tests);
}

TEST(WideBvh, RefusesLeavesThatAreTooLarge) {
  const std::vector<Aabb> boxes = field(100, 19);
  Bvh tree({Bvh::Build::top_down, Bvh::Motion::refit, 20});
  tree.build(boxes);
  WideBvh bvh;
  EXPECT_THROW(bvh.build(boxes, tree), std::logic_error);
}

TEST(WideBvh, IsWholeWhenAllBoxesAreOnePoint) {
  const std::vector<Aabb> boxes(700, {{5.0F, -6.0F, 7.0F}, {5.0F, -6.0F, 7.0F}});
  Random random(1);
  for (const Way& way : ways()) {
    WideBvh bvh;
    way.build(bvh, boxes);
    ASSERT_NO_THROW(bvh.audit(boxes)) << way.name;
    const Frustum at_point = frustum_of(
        {look_at({5.0, -6.0, 10.0}, {5.0, -6.0, 7.0}), perspective_lens(1.0, 1.0, 0.1, 10.0)});
    EXPECT_EQ(answer(bvh, at_point, boxes).size(), 700U) << way.name;
  }
}

}  // namespace
}  // namespace vislab
