#include "experiments/analysis/persistence.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace vislab {
namespace {

/// Objects that are anywhere, before a camera that looks along -z from the origin.
class Counted {
 public:
  explicit Counted(std::vector<double> z) : counter_(z.size()) {
    for (const double depth : z) {
      const auto end = static_cast<float>(depth);
      bounds_.push_back({glm::vec3(-0.5F, -0.5F, end - 0.5F), glm::vec3(0.5F, 0.5F, end + 0.5F)});
      shown_.push_back(static_cast<ObjectId>(shown_.size()));
    }
    frame_.camera.lens = perspective_lens(1.0, 1.0, 0.1, 100.0);
  }

  void look_from(const glm::dvec3& eye) { frame_.camera.pose.eye = eye; }
  void hide(ObjectId object) { std::erase(shown_, object); }
  void put(ObjectId object, float z) {
    bounds_[object] = {glm::vec3(-0.5F, -0.5F, z - 0.5F), glm::vec3(0.5F, 0.5F, z + 0.5F)};
  }
  void add(std::vector<ObjectId> visible) {
    frame_.objects = {{}, bounds_, shown_};
    counter_.add(frame_, visible);
  }
  PersistenceCounts counts() const { return counter_.counts(); }

 private:
  PersistenceCounter counter_;
  std::vector<Aabb> bounds_;
  std::vector<ObjectId> shown_;
  Frame frame_;
};

void expect_cases(const StillHidden& still, std::uint64_t cases, std::uint64_t hidden) {
  EXPECT_EQ(still.cases, cases);
  EXPECT_EQ(still.hidden, hidden);
}

TEST(PersistenceCounts, ObjectsAreCountedByHowLongTheyWereHiddenInARow) {
  Counted counted({-5.0, -10.0});
  counted.add({0});     // 1 hidden for 1
  counted.add({0});     // 1 still: 2
  counted.add({0, 1});  // 1 appears after 2
  counted.add({0});     // 1 vanishes
  counted.add({0, 1});  // 1 appears after 1
  const PersistenceCounts counts = counted.counts();
  expect_cases(counts.after[0], 4 + 1, 1);  // object 0 in four frames, 1 in one
  expect_cases(counts.after[1], 2, 1);
  expect_cases(counts.after[2], 1, 0);
  expect_cases(counts.after[3], 0, 0);
  // Only the second time had it been seen.
  expect_cases(counts.after_seen[1], 1, 0);
  expect_cases(counts.after_seen[2], 0, 0);
  EXPECT_DOUBLE_EQ(counts.hidden_share, 3.0 / 10.0);
  EXPECT_DOUBLE_EQ(counts.appearing_share, 2.0 / 3.0);
}

TEST(PersistenceCounts, WhatLeavesTheViewOrIsNoLongerShownStartsAnew) {
  Counted counted({-5.0, -10.0});
  counted.add({0});
  counted.add({0});
  counted.put(1, 10.0F);  // behind the camera
  counted.add({0});
  counted.put(1, -10.0F);
  counted.add({0});
  counted.hide(1);
  counted.add({0});
  const PersistenceCounts counts = counted.counts();
  expect_cases(counts.after[1], 1, 1);
  expect_cases(counts.after[2], 0, 0);
}

TEST(PersistenceCounts, LongTimesShareTheLastPlace) {
  Counted counted({-5.0});
  for (int i = 0; i < 50; ++i) counted.add({});
  const PersistenceCounts counts = counted.counts();
  expect_cases(counts.after[30], 1, 1);
  expect_cases(counts.after[PersistenceCounter::last_time], 49 - 30, 49 - 30);
  EXPECT_TRUE(std::isnan(counts.after[0].share().value));
}

TEST(PersistenceCounts, TheCamerasSpeedIsItsMedianFromFrameToFrame) {
  Counted counted({-5.0});
  for (const double x : {0.0, 0.5, 1.0, 9.0}) {
    counted.look_from({x, 0.0, 0.0});
    counted.add({0});
  }
  EXPECT_DOUBLE_EQ(counted.counts().step_m, 0.5);
  EXPECT_DOUBLE_EQ(counted.counts().turn_deg, 0.0);
}

TEST(PersistenceCounts, SharesHaveWilsonsInterval) {
  const Estimate share = StillHidden{10, 8}.share();
  EXPECT_DOUBLE_EQ(share.value, 0.8);
  EXPECT_NEAR(share.low, 0.490, 0.001);  // as tabulated
  EXPECT_NEAR(share.high, 0.943, 0.001);
  EXPECT_DOUBLE_EQ((StillHidden{10, 10}.share().high), 1.0);
  EXPECT_LT((StillHidden{10, 10}.share().low), 0.8);
}

TEST(PersistenceCounts, TheFitFindsTheFormulaThatTheCountsWereMadeFrom) {
  PersistenceCounts counts;
  counts.after.resize(PersistenceCounter::last_time + 1);
  for (std::size_t t = 1; t < counts.after.size(); ++t) {
    const double p = 0.97 - 0.6 * std::exp(-static_cast<double>(t) / 1.5);
    counts.after[t] = {1'000'000, static_cast<std::uint64_t>(std::llround(1e6 * p))};
  }
  const PersistenceFit fit = counts.fit();
  EXPECT_NEAR(fit.level, 0.97, 0.001);
  EXPECT_NEAR(fit.drop, 0.6, 0.03);
  EXPECT_NEAR(fit.time, 1.5, 0.06);
  for (StillHidden& still : counts.after) still = {100, 100};
  EXPECT_NEAR(counts.fit()(3.0), 1.0, 1e-12);
  counts.after.assign(PersistenceCounter::last_time + 1, {});
  counts.after[1] = {10, 9};
  EXPECT_TRUE(std::isnan(counts.fit().level));
}

TEST(PersistenceCounts, AsJsonTheyStandBesideTheFormula) {
  Counted counted({-5.0});
  for (int i = 0; i < 3; ++i) counted.add({});
  const std::string json = to_json({{"city", "slow", {64, 32}, 3, counted.counts()}});
  for (const char* part : {"\"scene\": \"city\"", "\"height_px\": 32", "\"frames\": 2",
                           "\"still_hidden\": 1", "\"formula\": 0.73"}) {
    EXPECT_NE(json.find(part), std::string::npos) << part << " in " << json;
  }
}

}  // namespace
}  // namespace vislab
