// The SIMD path of frustum.flat against the definition: kept unless surely_outside() holds of a
// plane.
#include "algorithms/frustum/flat_boxes.h"

#include <gtest/gtest.h>

#include "common/simd/simd_target.h"
#include "tests/geometry/adversarial_boxes.h"

namespace vislab {
namespace {

using frustum_culling::FlatBoxes;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr FlatBoxes::Order both_orders[] = {FlatBoxes::Order::ids, FlatBoxes::Order::groups};

/// What is to be kept, by object.
std::vector<bool> defined(const Frustum& frustum, std::span<const Aabb> boxes) {
  std::vector<bool> kept;
  for (const Aabb& box : boxes) {
    kept.push_back(std::ranges::none_of(
        frustum.span(), [&](const Plane& plane) { return surely_outside(plane, box); }));
  }
  return kept;
}

/// What is kept, by object. Bits beyond the objects must be 0.
std::vector<bool> kept_by(FlatBoxes& flat, const Frustum& frustum, std::span<const Aabb> boxes) {
  const auto words = flat.cull(frustum, boxes);
  std::vector<bool> kept(boxes.size(), false);
  for (std::size_t slot = 0; slot < words.size() * 64; ++slot) {
    if ((words[slot / 64] >> (slot % 64) & 1) == 0) continue;
    EXPECT_LT(slot, boxes.size());
    const ObjectId object = flat.objects_by_slot()[slot];
    EXPECT_FALSE(kept[object]) << "twice: " << object;
    EXPECT_EQ(flat.slot_of(object), slot);
    kept[object] = true;
  }
  return kept;
}

Aabb box_at(const glm::vec3& center, float half) { return {center - half, center + half}; }

std::vector<Aabb> boxes_around(std::uint64_t seed, std::size_t count, double reach) {
  Random random(seed);
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    boxes.push_back(box_at(glm::vec3(test::random_vector(random, reach)),
                           static_cast<float>(random.uniform(0.001, 0.02) * reach)));
  }
  return boxes;
}

Camera camera_towards(const glm::dvec3& target) {
  return {look_at({0.0, 0.0, 0.0}, target), perspective_lens(1.0, 1.5, 0.3, 80.0)};
}

TEST(FlatBoxes, KeepWhatTheDefinitionKeepsOfAdversarialBoxesWithEveryInstructionSet) {
  Random random(7);
  for (int i = 0; i < 400; ++i) {
    const Camera camera = test::adversarial_camera(random);
    std::vector<Aabb> boxes;
    const std::size_t count = 1 + random.below(300);
    for (std::size_t b = 0; b < count; ++b) {
      boxes.push_back(test::adversarial_box(random, camera));
      if (random.below(50) == 0) boxes.back().max[static_cast<int>(random.below(3))] = nan;
      if (random.below(50) == 0) boxes.back().min[static_cast<int>(random.below(3))] = -infinity;
      if (random.below(50) == 0) boxes.back() = Aabb();
    }
    const Frustum frustum = frustum_of(camera);
    const std::vector<bool> expected = defined(frustum, boxes);
    for (const FlatBoxes::Order order : both_orders) {
      FlatBoxes flat(order);
      flat.build(boxes);
      for (const std::string& target : simd_targets()) {
        const SimdTargetScope scope(target);
        ASSERT_EQ(kept_by(flat, frustum, boxes), expected) << target << ", scene " << i;
      }
    }
  }
}

TEST(FlatBoxes, DecideMostBoxesOfAFieldWithoutAskingAgain) {
  const std::vector<Aabb> boxes = boxes_around(3, 5000, 50.0);
  const Frustum frustum = frustum_of(camera_towards({1.0, 0.2, 0.3}));
  const std::vector<bool> expected = defined(frustum, boxes);
  FlatBoxes by_id(FlatBoxes::Order::ids);
  FlatBoxes groups(FlatBoxes::Order::groups);
  for (FlatBoxes* flat : {&by_id, &groups}) {
    flat->build(boxes);
    EXPECT_EQ(kept_by(*flat, frustum, boxes), expected);
  }
  EXPECT_LT(groups.plane_tests() * 2, by_id.plane_tests());
}

TEST(FlatBoxes, KeepTheirAnswersForAnyCountAndOneOrTwoThreads) {
  const Frustum frustum = frustum_of(camera_towards({1.0, 0.2, 0.3}));
  for (const std::size_t count : {1, 63, 64, 65, 4095, 4096, 4097, (1 << 18) + 77}) {
    const std::vector<Aabb> boxes = boxes_around(count, count, 50.0);
    const std::vector<bool> expected = defined(frustum, boxes);
    for (const FlatBoxes::Order order : both_orders) {
      for (const int threads : {1, 2}) {
        FlatBoxes flat(order, threads);
        flat.build(boxes);
        EXPECT_EQ(kept_by(flat, frustum, boxes), expected) << count << ", threads " << threads;
      }
    }
  }
}

TEST(FlatBoxes, FollowWhatMovesIsHiddenAndIsShown) {
  std::vector<Aabb> boxes = boxes_around(5, 1000, 50.0);
  std::vector<bool> shown(boxes.size(), true);
  Random random(6);
  std::vector<FlatBoxes> flats;
  for (const FlatBoxes::Order order : both_orders) flats.emplace_back(order).build(boxes);
  for (int frame = 0; frame < 600; ++frame) {
    Changes changes;
    for (ObjectId object = 0; object < boxes.size(); ++object) {
      if (random.below(10) == 0) {
        changes.moved.push_back(object);
        const double reach = random.below(200) == 0 ? 1e7 : 50.0;
        boxes[object] = box_at(glm::vec3(test::random_vector(random, reach)), 1.0F);
        if (random.below(100) == 0) boxes[object].min.y = nan;
      }
      if (random.below(20) == 0) {
        (shown[object] ? changes.hidden : changes.shown).push_back(object);
        shown[object] = !shown[object];
      }
    }
    const Frustum frustum = frustum_of(camera_towards(test::random_vector(random, 1.0)));
    std::vector<bool> expected = defined(frustum, boxes);
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = expected[i] && shown[i];
    for (FlatBoxes& flat : flats) {
      flat.update(boxes, changes);
      ASSERT_EQ(kept_by(flat, frustum, boxes), expected) << "frame " << frame;
      EXPECT_EQ(flat.shown_count(), static_cast<std::size_t>(std::ranges::count(shown, true)));
    }
  }
}

TEST(FlatBoxes, ArrangeThemselvesAnewWhenAllGoesFarAway) {
  std::vector<Aabb> boxes = boxes_around(5, 2000, 50.0);
  FlatBoxes flat(FlatBoxes::Order::groups);
  flat.build(boxes);
  Changes all;
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    all.moved.push_back(object);
    boxes[object].min += glm::vec3(1e5F, 0.0F, 0.0F);
    boxes[object].max += glm::vec3(1e5F, 0.0F, 0.0F);
  }
  flat.update(boxes, all);
  Camera camera = camera_towards({1.0, 0.2, 0.3});
  camera.pose.eye.x = 1e5;
  const Frustum frustum = frustum_of(camera);
  EXPECT_EQ(kept_by(flat, frustum, boxes), defined(frustum, boxes));
  // Strays would have all their planes tested.
  EXPECT_LT(flat.plane_tests(), boxes.size() * 3);
}

TEST(FlatBoxes, OneBoxFarAwayDoesNotSpoilTheRest) {
  std::vector<Aabb> boxes = boxes_around(5, 2000, 50.0);
  boxes[77] = box_at({1e8F, 0.0F, 0.0F}, 1.0F);
  FlatBoxes flat(FlatBoxes::Order::groups);
  flat.build(boxes);
  const Frustum frustum = frustum_of(camera_towards({1.0, 0.2, 0.3}));
  EXPECT_EQ(kept_by(flat, frustum, boxes), defined(frustum, boxes));
  EXPECT_LT(flat.plane_tests(), boxes.size() * 3);
}

TEST(FlatBoxes, MayBeNone) {
  for (const FlatBoxes::Order order : both_orders) {
    FlatBoxes flat(order);
    flat.build({});
    flat.update({}, {});
    EXPECT_TRUE(flat.cull(frustum_of(camera_towards({1.0, 0.0, 0.0})), {}).empty());
  }
}

TEST(SelectIds, CopiesFullAndPartialWords) {
  std::vector<ObjectId> ids;
  for (ObjectId i = 0; i < 256; ++i) ids.push_back(1000 + i);
  const std::vector<std::uint64_t> words{~std::uint64_t{0}, 0, 0x8000000000000001ULL, 2};
  std::vector<ObjectId> out(256);
  EXPECT_EQ(frustum_culling::select_ids(words, ids, out.data()), 67U);
  EXPECT_EQ(out[0], 1000U);
  EXPECT_EQ(out[63], 1063U);
  EXPECT_EQ(out[64], 1128U);
  EXPECT_EQ(out[65], 1191U);
  EXPECT_EQ(out[66], 1193U);
}

}  // namespace
}  // namespace vislab
