// What CHC++ does beyond the paper, each of it alone: it does what it is for, and neither with it
// nor without it any image changes.
#include <gtest/gtest.h>

#include "algorithms/occlusion/sleep_pattern.h"
#include "common/render/modelled_gpu.h"
#include "common/render/osmesa_device.h"
#include "tests/algorithms/query_scenes.h"

namespace vislab {
namespace {

using occlusion_culling::SleepPattern;

/// Is each of these frames slept through, if nothing is hidden in any?
std::vector<bool> frames_in_vain(SleepPattern& sleep, std::uint64_t first, std::uint64_t count) {
  std::vector<bool> asleep;
  for (std::uint64_t frame = first; frame < first + count; ++frame) {
    asleep.push_back(sleep.asleep(frame));
    if (!asleep.back()) sleep.note_tried(true);
  }
  return asleep;
}

TEST(SleepPattern, SleepsLongerAndLongerWhereAskingIsInVain) {
  SleepPattern sleep;
  std::vector<bool> expected(SleepPattern::patience, false);
  for (const std::uint32_t pause : {8U, 16U, 32U, 64U, 64U}) {
    expected.insert(expected.end(), pause, true);
    expected.push_back(false);
  }
  EXPECT_EQ(frames_in_vain(sleep, 0, expected.size()), expected);
}

TEST(SleepPattern, StaysAwakeWhereSomethingIsHiddenNowAndThen) {
  SleepPattern sleep;
  for (std::uint64_t frame = 0; frame < 100; ++frame) {
    EXPECT_FALSE(sleep.asleep(frame)) << frame;
    sleep.note_tried(frame % SleepPattern::patience != 0);
  }
}

TEST(SleepPattern, BelievesAFrameToBeInVainOnlyIfAllItsCallsWere) {
  SleepPattern sleep;
  for (std::uint64_t frame = 0; frame < 50; ++frame) {
    for (const bool in_vain : {true, false, true}) {
      EXPECT_FALSE(sleep.asleep(frame)) << frame;
      sleep.note_tried(in_vain);
    }
  }
}

TEST(SleepPattern, WakesByMuchThatIsNewAndIsAsPatientAsBefore) {
  SleepPattern sleep;
  constexpr std::uint64_t patience = SleepPattern::patience;
  frames_in_vain(sleep, 0, patience);
  ASSERT_TRUE(sleep.asleep(patience));
  sleep.note_slept(false);
  ASSERT_TRUE(sleep.asleep(patience + 1));
  sleep.note_slept(true);
  EXPECT_EQ(frames_in_vain(sleep, patience + 2, patience), std::vector<bool>(patience, false));
  // The pause is the first one again.
  std::vector<bool> expected(SleepPattern::first_pause, true);
  expected.push_back(false);
  EXPECT_EQ(frames_in_vain(sleep, 2 * patience + 2, expected.size()), expected);
}

std::uint64_t counter(const QueryFrame& frame, std::string_view name) {
  for (const auto& [known, count] : frame.counters) {
    if (known == name) return count;
  }
  throw std::logic_error("no counter is called " + std::string(name));
}

constexpr std::size_t plates = 60;

/// Two groups of plates, each side by side, none before another; 300 m apart. Object 0 is a wall
/// far away, object 1 one before the second group.
Scene two_groups() {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {{0, placed({0.0, 0.0, 900.0}, {40.0, 20.0, 0.5}), none_id},
                   {0, placed({300.0, 0.0, -10.0}, {40.0, 20.0, 0.5}), none_id}};
  for (const double middle : {0.0, 300.0}) {
    for (std::size_t i = 0; i < plates; ++i) {
      const glm::dvec3 at(middle + 3.0 * (static_cast<double>(i % 10) - 4.5),
                          3.0 * (static_cast<double>(i / 10) - 2.5), -40.0);
      scene.objects.push_back({0, placed(at, {1.0, 1.0, 0.1}), none_id});
    }
  }
  return scene;
}

Camera at_group(double middle) { return looking({middle, 0.0, 0.0}, {middle, 0.0, -40.0}); }

constexpr const char* sleeper = "occlusion.chcpp[leaf_triangles=100]";
constexpr const char* sleepless = "occlusion.chcpp[leaf_triangles=100,sleep=false]";

/// No image changes; returns how many frames were slept through.
std::uint64_t frames_slept(const std::vector<QueryFrame>& frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) EXPECT_EQ(frames[i].image_px, 0U) << i;
  return counter(frames.back(), "frames_slept");
}

TEST(ChcppSleep, AsksNothingWhereNothingIsHiddenUnlessItIsSwitchedOff) {
  constexpr std::size_t length = SleepPattern::patience + SleepPattern::first_pause + 1;
  QueryPlay stage(finished(two_groups(), std::vector<Camera>(length, at_group(0.0))),
                  query_viewport);
  ModelledGpu device(gpu_presets().front().model);
  const std::vector<QueryFrame> frames = stage.run(sleeper, device);
  EXPECT_EQ(frames_slept(frames), SleepPattern::first_pause);
  for (std::size_t i = 0; i < length; ++i) {
    const bool asleep = i >= SleepPattern::patience && i + 1 < length;
    EXPECT_EQ(frames[i].counts.queries == 0, asleep) << i;
    EXPECT_EQ(frames[i].kept.size(), plates) << i;
  }
  const std::vector<QueryFrame> awake = stage.run(sleepless, device);
  EXPECT_EQ(frames_slept(awake), 0U);
  for (std::size_t i = 0; i < length; ++i) EXPECT_GT(awake[i].counts.queries, 0U) << i;
}

TEST(ChcppSleep, WakesInTheFrameAfterACutToAViewInWhichMuchIsHidden) {
  constexpr std::size_t cut = SleepPattern::patience + 2;
  // What was visible is asked about again within the interval of four frames.
  std::vector<Camera> cameras(cut + 8, at_group(0.0));
  for (std::size_t i = cut; i < cameras.size(); ++i) cameras[i] = at_group(300.0);
  QueryPlay stage(finished(two_groups(), cameras), query_viewport);
  ModelledGpu device(gpu_presets().front().model);
  const std::vector<QueryFrame> frames = stage.run(sleeper, device);
  EXPECT_EQ(frames_slept(frames), 3U);
  EXPECT_EQ(frames[cut].kept.size(), plates + 1);
  EXPECT_GT(frames[cut + 1].counts.queries, 0U);
  EXPECT_EQ(frames.back().kept, std::vector<ObjectId>{1});
}

TEST(ChcppSleep, NoticesAWallThatComesBeforeWhatItSeesWhenThePauseEnds) {
  constexpr std::size_t wall_comes = SleepPattern::patience + 1;
  constexpr std::size_t wakes = SleepPattern::patience + SleepPattern::first_pause;
  Play play = finished(two_groups(), std::vector<Camera>(wakes + 6, at_group(0.0)));
  play.steps[wall_comes].changes.moved = {0};
  play.steps[wall_comes].changes.transforms = {placed({0.0, 0.0, -10.0}, {40.0, 20.0, 0.5})};
  QueryPlay stage(std::move(play), query_viewport);
  ModelledGpu device(gpu_presets().front().model);
  const std::vector<QueryFrame> frames = stage.run(sleeper, device);
  EXPECT_EQ(frames_slept(frames), SleepPattern::first_pause);
  EXPECT_EQ(frames[wakes - 1].kept.size(), plates + 1);
  EXPECT_GT(frames[wakes].counts.queries, 0U);
  EXPECT_EQ(frames.back().kept, std::vector<ObjectId>{0});
}

/// A counter of the last frame with a switch as it is and set to something else; no image changes
/// either way.
struct BothWays {
  std::uint64_t as_it_is = 0, switched = 0;
};
BothWays both_ways(QueryPlay& stage, RenderDevice& device, const std::string& switched,
                   std::string_view name) {
  const auto last = [&](const std::string& spec) {
    const std::vector<QueryFrame> frames = stage.run(spec, device);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(frames[i].image_px, 0U) << spec << ", frame " << i;
    }
    return counter(frames.back(), name);
  };
  // Units that are heavy enough to be worth a second question.
  const std::string base = "occlusion.chcpp[leaf_triangles=400";
  return {last(base + "]"), last(base + "," + switched + "]")};
}

TEST(ChcppSwitches, EachTurnsOffWhatItNames) {
  QueryPlay stage(thousands_of_boxes(), query_viewport);
  OsMesaDevice device;
  for (const auto& [switched, name] :
       {std::pair("open_unasked=false", "opened_unasked"), std::pair("reask=false", "reasked"),
        std::pair("skip_vain=false", "skipped_as_vain"),
        std::pair("multiqueries=false", "multiqueries")}) {
    const BothWays seen = both_ways(stage, device, switched, name);
    EXPECT_GT(seen.as_it_is, 0U) << name;
    EXPECT_EQ(seen.switched, 0U) << name;
  }
}

TEST(ChcppSwitches, WhatIsHandedOverEarlyIsFlushedMoreOften) {
  QueryPlay stage(street(), query_viewport);
  OsMesaDevice device;
  const auto flushes = [&](const std::string& triangles) {
    const std::vector<QueryFrame> frames = stage.run(
        "occlusion.chcpp[leaf_triangles=100,hand_over_triangles=" + triangles + "]", device);
    for (const QueryFrame& frame : frames) EXPECT_EQ(frame.image_px, 0U) << triangles;
    return counts(frames).flushes;
  };
  const std::uint64_t never = flushes("0");
  EXPECT_GT(flushes("50"), never);
  EXPECT_EQ(flushes("1000000000"), never);
}

}  // namespace
}  // namespace vislab
