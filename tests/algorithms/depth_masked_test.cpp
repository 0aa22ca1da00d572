// depth.masked, and what all depth cullers share: order of drawing, occluders, sleep.
#include <gtest/gtest.h>

#include "algorithms/depth/draw_order.h"
#include "algorithms/depth/worth.h"
#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/depth_damage.h"

namespace vislab {
namespace {

using depth_culling::DrawKeys;
using depth_culling::DrawOrder;
using depth_culling::ObjectOrder;
using depth_culling::Worth;

const std::vector<std::string> variants = {"depth.masked", "depth.masked[buffer=masked]",
                                           "depth.masked[buffer=masked_volume,scale=half]",
                                           "depth.masked[scale=quarter]"};

Camera wide_camera(const Viewport& viewport, const glm::dvec3& eye, const glm::dvec3& target) {
  return {look_at(eye, target), perspective_lens(degrees(60.0), viewport.aspect(), 0.3, 1000.0)};
}

Play city() {
  CityParameters parameters;
  parameters.blocks_x = parameters.blocks_z = 8;
  parameters.roof_share = 0.3;
  parameters.street_boxes = 300;
  Play play;
  play.scene = make_city(parameters);
  play.scene.finish();
  return play;
}

Play box_field() {
  BoxFieldParameters parameters;
  parameters.count = 400;
  parameters.extent_m = 20.0;
  parameters.max_half_size_m = 4.0;
  parameters.clear_radius_m = 0.0;
  parameters.rotated = true;
  Play play;
  play.scene = make_box_field(parameters);
  play.scene.finish();
  return play;
}

Play rooms() {
  Play play;
  play.scene = make_room_ring({});
  play.scene.finish();
  return play;
}

/// Along a street, inside of a house or box and through the near plane of others, from above, and
/// without perspective.
void look_around(Play& play, const Viewport& viewport) {
  const auto add = [&](const glm::dvec3& eye, const glm::dvec3& target) {
    play.steps.push_back({wide_camera(viewport, eye, target), {}});
  };
  add({0.0, 1.7, 0.0}, {60.0, 4.0, 1.0});
  add({12.5, 5.0, 12.5}, {90.0, 4.0, 30.0});
  add({-15.0, 30.0, 3.0}, {0.0, 5.0, 0.0});
  play.steps.push_back(play.steps.back());
  play.steps.back().camera.lens = orthographic_lens(40.0, viewport.aspect(), 0.3, 500.0);
}

TEST(DepthMasked, LeavesTheImageAsItIs) {
  const std::array<Viewport, 3> viewports = {Viewport{512, 512}, {1023, 769}, {160, 90}};
  for (const auto& make : {city, box_field, rooms}) {
    for (const Viewport& viewport : viewports) {
      Play play = make();
      look_around(play, viewport);
      // The large image once is enough.
      if (viewport.width > 1000) play.steps.resize(2);
      const bool all = viewport.width < 200;
      for (const std::string& spec : variants) {
        if (!all && spec != variants.front()) continue;
        const Damage done = damage(spec, play, viewport, true);
        EXPECT_EQ(done.image_px, 0U) << spec << ", " << viewport.width;
        EXPECT_EQ(done.false_px, 0U) << spec << ", " << viewport.width;
        EXPECT_LT(done.kept, done.offered) << spec;
      }
    }
  }
}

TEST(DepthMasked, HidesMostNearFirstAndLeastFarFirst) {
  constexpr Viewport viewport{256, 256};
  Play play = city();
  look_around(play, viewport);
  const std::uint64_t near_first = damage("depth.masked[order=near_first]", play, viewport).kept;
  const std::uint64_t random = damage("depth.masked[order=random]", play, viewport).kept;
  const std::uint64_t far_first = damage("depth.masked[order=far_first]", play, viewport).kept;
  EXPECT_LE(near_first, random);
  EXPECT_LE(random, far_first);
  EXPECT_LT(near_first, far_first);
}

TEST(DepthMasked, HidesLessWithoutOccludersAndAtReducedSize) {
  constexpr Viewport viewport{256, 256};
  Play play = city();
  look_around(play, viewport);
  const std::uint64_t full = damage("depth.masked", play, viewport).kept;
  const std::uint64_t quarter = damage("depth.masked[scale=quarter]", play, viewport).kept;
  const std::uint64_t none = damage("depth.masked[occluder_triangles=0]", play, viewport).kept;
  EXPECT_LT(full, quarter);
  EXPECT_LT(quarter, none);
}

/// A wall at z = 0, and cubes before (1) and behind (2) it.
Scene wall() {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {{0, placed({0.0, 0.0, 0.0}, {8.0, 8.0, 0.1}), none_id},
                   {0, placed({1.0, 0.0, 3.0}, glm::dvec3(0.2)), none_id},
                   {0, placed({0.0, 0.0, -3.0}), none_id}};
  scene.finish();
  return scene;
}

TEST(DepthMasked, EmitsNearFirstAndFollowsWhatMovesAndVanishes) {
  const Scene scene = wall();
  const Camera camera = camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0});
  CullerRun run("depth.masked", scene);
  EXPECT_EQ(run.objects(camera), (std::vector<ObjectId>{1, 0}));
  Changes aside;
  aside.moved = {0};
  aside.transforms = {placed({60.0, 0.0, 0.0}, {8.0, 8.0, 0.1})};
  run.update(camera, aside);
  EXPECT_EQ(run.objects(camera), (std::vector<ObjectId>{1, 2}));
  run.reset();
  EXPECT_EQ(run.objects(camera), (std::vector<ObjectId>{1, 0}));
  Changes hidden;
  hidden.hidden = {0};
  run.update(camera, hidden);
  EXPECT_EQ(run.objects(camera), (std::vector<ObjectId>{1, 2}));
}

TEST(DepthMasked, ForgetsTheBufferOnResetAlsoIfThePathHasOneFrame) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {{0, placed({0.0, 0.0, -6.0}), none_id}, {0, placed({0.0, 0.0, 0.0}), none_id}};
  scene.finish();
  const SceneState state(scene);
  const Frame only{0, camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0}), {64, 64}, state.view(), 0.0};
  for (const std::string buffer : {"exact", "masked", "masked_volume"}) {
    // The far cube is asked about first, while nothing is drawn that hides it.
    CullerRun run("depth.masked[order=far_first,sleep=false,buffer=" + buffer + "]", scene);
    RecordingSink sink;
    for (int round = 0; round < 3; ++round) {
      run.reset();
      sink.start(scene, only);
      run.culler().update(only, {});
      run.culler().cull(only, Candidates::everything(), sink);
      EXPECT_EQ(sink.emitted().size(), 2U) << buffer << ", round " << round;
    }
  }
}

TEST(DepthMasked, LetsLaterBatchesOfAFrameBeHiddenByEarlierOnes) {
  const Scene scene = wall();
  CullerRun run("depth.masked", scene);
  const Frame frame = run.frame(camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0}));
  RecordingSink sink;
  const auto kept = [&](std::vector<ObjectId> ids) {
    const std::array<std::span<const ObjectId>, 1> runs{ids};
    sink.start(scene, frame);
    run.culler().cull(frame, Candidates::of(runs), sink);
    return sink.emitted().size();
  };
  EXPECT_EQ(kept({0}), 1U);
  EXPECT_EQ(kept({2}), 0U);
  EXPECT_EQ(kept({1}), 1U);
  EXPECT_EQ(kept({}), 0U);
}

TEST(DepthMasked, SleepsWhereNothingIsHiddenAndWakesForATry) {
  BoxFieldParameters parameters;
  parameters.count = 300;
  parameters.extent_m = 100.0;
  parameters.min_half_size_m = parameters.max_half_size_m = 0.05;
  Scene scene = make_box_field(parameters);
  scene.finish();
  const Camera camera = camera_at({0.0, 0.0, 150.0}, {0.0, 0.0, 0.0});
  CullerRun run("depth.masked", scene);
  for (int frame = 0; frame < 40; ++frame) run.objects(camera);
  EXPECT_GE(run.counter("frames_asleep"), 30U);
  EXPECT_LT(run.counter("frames_asleep"), 37U);
  // Asleep or not, what is outside of the view goes.
  const std::vector<ObjectId> behind = run.objects(camera_at({0.0, 0.0, 150.0}, {0.0, 0.0, 300.0}));
  EXPECT_TRUE(behind.empty());
}

TEST(DepthMasked, AsksLittleMoreWhenTenTimesAsMuchIsHidden) {
  std::array<std::uint64_t, 2> queries{};
  for (std::size_t i = 0; i < 2; ++i) {
    CityParameters parameters;
    parameters.blocks_x = parameters.blocks_z = 8;
    parameters.indoor_boxes = i == 0 ? 500 : 5000;
    Scene scene = make_city(parameters);
    scene.finish();
    CullerRun run("depth.masked", scene);
    run.objects(wide_camera({64, 64}, {0.0, 1.7, 0.0}, {60.0, 4.0, 1.0}));
    queries[i] = run.counter("queries");
  }
  EXPECT_LT(queries[1], 3 * queries[0]);
}

TEST(ObjectOrder, SortsByKeyAndKeepsTheOrderOfEquals) {
  Random random(1);
  for (const std::size_t count : {0U, 1U, 2U, 47U, 48U, 49U, 5000U}) {
    ObjectOrder order;
    for (ObjectId object = 0; object < count; ++object) {
      const std::array keys = {-INFINITY, -1e30F, -2.5F, 0.0F, 1e-30F, 3.0F, INFINITY};
      order.add(random.below(2) == 0 ? keys[random.below(keys.size())]
                                     : static_cast<float>(random.uniform(-9.0, 9.0)),
                object);
    }
    order.sort();
    ASSERT_EQ(order.places().size(), count);
    for (std::size_t i = 1; i < count; ++i) {
      const ObjectOrder::Place& a = order.places()[i - 1];
      const ObjectOrder::Place& b = order.places()[i];
      ASSERT_TRUE(a.key < b.key || (a.key == b.key && a.object < b.object)) << i;
    }
  }
}

TEST(DrawKeys, OfABoxInABoxAreNotSmallerAndInvalidBoxesComeFirst) {
  Random random(1);
  for (const DrawOrder order : {DrawOrder::near_first, DrawOrder::far_first}) {
    for (const bool perspective : {true, false}) {
      Camera camera = camera_at({3.0, 1.0, 2.0}, {0.0, 0.5, 0.0});
      if (!perspective) camera.lens = orthographic_lens(10.0, 1.0, 0.1, 100.0);
      DrawKeys keys(order);
      keys.start(camera);
      for (int trial = 0; trial < 500; ++trial) {
        Aabb inner, outer;
        for (int i = 0; i < 3; ++i) {
          glm::vec3 p;
          for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(random.uniform(-9, 9));
          outer.extend(p);
          if (i < 2) inner.extend(p);
        }
        const float limit = keys.of(outer, 0);
        EXPECT_GE(keys.of(inner, 1), limit - 1e-5F * std::abs(limit));
      }
      EXPECT_EQ(keys.of(Aabb{}, 0), -INFINITY);
    }
  }
}

TEST(Worth, TriesAgainSoonAfterACutAndForgetsOnReset) {
  const Scene scene = wall();
  const SceneState state(scene);
  Frame frame{0, camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0}), {64, 64}, state.view(), 0.0};
  Worth worth;
  Worth::Work loss;
  loss.queries = 100;
  const auto next = [&] {
    const bool tries = worth.tries(frame);
    if (tries) worth.add(loss);
    ++frame.index;
    return tries;
  };
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(next());
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(next());
  EXPECT_TRUE(next());
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(next());
  frame.camera = camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 90.0});
  int pause = 0;
  while (!next()) ++pause;
  EXPECT_LE(pause, 4);
  worth.reset();
  EXPECT_TRUE(next());
  // What pays is never left.
  worth.reset();
  loss.hidden_objects = 1000;
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(next());
}

}  // namespace
}  // namespace vislab
