#include "common/judge/stability.h"

#include <gtest/gtest.h>

#include "common/scene/generators/generators.h"

namespace vislab {
namespace {

/// Three cubes: triangles 0-11, 12-23 and 24-35.
Scene three_cubes() {
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  for (int i = 0; i < 3; ++i) {
    scene.objects.push_back({0, box_transform({3.0 * i, 0.0, 0.0}, glm::dvec3(1.0)), none_id});
  }
  scene.finish();
  return scene;
}

ObjectVisibility seen(std::vector<std::uint32_t> pixels) {
  ObjectVisibility truth;
  for (const std::uint32_t count : pixels) truth.visible.push_back(count > 0 ? 1 : 0);
  truth.pixels = std::move(pixels);
  return truth;
}

VisibleSet objects(const std::vector<ObjectId>& ids) {
  std::vector<VisibleSet::Run> runs;
  for (const ObjectId id : ids) runs.push_back({12 * id, 12});
  return VisibleSet(runs);
}

TEST(ObjectVisibility, CountsPixelsOfCAndSeesSamplesOfJ) {
  const Scene scene = three_cubes();
  FrameTruth truth;
  truth.viewport = {3, 1};
  truth.ids = {13, none_id, 20};
  truth.hits = {{30, 2, 1}};
  const ObjectVisibility visibility = object_visibility(scene, truth);
  EXPECT_EQ(visibility.pixels, (std::vector<std::uint32_t>{0, 2, 0}));
  EXPECT_EQ(visibility.visible, (std::vector<std::uint8_t>{0, 1, 1}));
}

TEST(StabilityJudge, AnAnswerThatFollowsTruthIsStable) {
  const Scene scene = three_cubes();
  StabilityJudge judge(scene);
  judge.add(seen({5, 0, 0}), objects({0}));
  judge.add(seen({0, 7, 0}), objects({1}));
  judge.add(seen({5, 7, 9}), objects({0, 1, 2}));
  EXPECT_EQ(judge.verdict(), Stability{});
}

TEST(StabilityJudge, EveryChangeThatTruthDoesNotMakeIsAToggle) {
  const Scene scene = three_cubes();
  StabilityJudge judge(scene);
  judge.add(seen({5, 0, 0}), objects({0, 1}));
  judge.add(seen({5, 0, 0}), objects({0}));     // 1 goes
  judge.add(seen({5, 0, 0}), objects({1, 2}));  // 0 goes though visible, 1 and 2 come
  EXPECT_EQ(judge.verdict().toggles, 4U);
  EXPECT_EQ(judge.verdict().pop_px_frames, 0U) << "nothing has come into sight since the start";
}

TEST(StabilityJudge, WhatComesLateIsMissingUntilItIsKept) {
  const Scene scene = three_cubes();
  StabilityJudge judge(scene);
  judge.add(seen({5, 0, 0}), objects({0}));
  judge.add(seen({5, 100, 0}), objects({0}));
  judge.add(seen({5, 200, 40}), objects({0}));
  judge.add(seen({5, 300, 50}), objects({0, 1}));
  judge.add(seen({5, 300, 0}), objects({0, 1}));  // 2 was never shown at all
  EXPECT_EQ(judge.verdict().pop_px_frames, 100U + 200U + 40U + 50U);
  EXPECT_EQ(judge.verdict().latency_frames, 2U);
}

}  // namespace
}  // namespace vislab
