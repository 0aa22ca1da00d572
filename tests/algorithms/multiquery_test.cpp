#include "algorithms/occlusion/multiquery.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/random.h"

namespace vislab::occlusion_culling {
namespace {

TEST(Persistence, IsTheLecturesFormulaAndLevelsOff) {
  const Persistence persistence(Persistence::Kind::formula);
  const double known[] = {0.290, 0.732, 0.895, 0.955, 0.977};
  for (std::uint32_t t = 0; t < 5; ++t) EXPECT_NEAR(persistence(t), known[t], 0.0006) << t;
  for (std::uint32_t t = 0; t <= Persistence::last_time; ++t) {
    EXPECT_NEAR(persistence(t), 0.99 - 0.7 * std::exp(-static_cast<double>(t)), 1e-14);
  }
  EXPECT_EQ(persistence(4'000'000'000U), persistence(Persistence::last_time));
}

TEST(Persistence, CountsWhatCameTrueIfItIsMeasuredAndForgetsItOnReset) {
  Persistence measured(Persistence::Kind::measured);
  Persistence formula(Persistence::Kind::formula);
  for (int i = 0; i < 5000; ++i) {
    measured.note(3, i % 2 == 0);
    formula.note(3, i % 2 == 0);
  }
  EXPECT_NEAR(measured(3), 0.5, 0.02);
  EXPECT_EQ(measured(2), Persistence::formula(2));
  EXPECT_EQ(formula(3), Persistence::formula(3));
  measured.reset();
  EXPECT_EQ(measured(3), Persistence::formula(3));
  // However one-sided the answers are, it stays a chance.
  for (int i = 0; i < 5000; ++i) measured.note(0, false);
  EXPECT_GT(measured(0), 0.0);
  for (int i = 0; i < 5000; ++i) measured.note(9, true);
  EXPECT_LT(measured(9), 1.0);
}

double value(const MultiqueryModel& model, std::span<const MultiqueryCandidate> group) {
  double hidden = 1.0;
  double triangles = 0.0;
  double boxes = 0.0;
  for (const MultiqueryCandidate& candidate : group) {
    hidden *= Persistence::formula(candidate.hidden_frames);
    triangles += candidate.triangles;
    boxes += candidate.boxes;
  }
  const auto count = static_cast<double>(group.size());
  if (model.cost == MultiqueryCost::paper) return count / (1.0 + (1.0 - hidden) * count);
  return hidden * triangles / (1.0 + model.box_cost * boxes);
}

TEST(Multiquery, EachGroupIsThePrefixOfGreatestValueOfWhatIsLeft) {
  Random random(7);
  const Persistence persistence(Persistence::Kind::formula);
  std::vector<std::uint32_t> ends{5, 6, 7};
  for (int trial = 0; trial < 400; ++trial) {
    const MultiqueryModel model{trial % 2 == 0 ? MultiqueryCost::paper : MultiqueryCost::slides,
                                random.uniform(0.0, 0.5)};
    std::vector<MultiqueryCandidate> candidates(random.below(60));
    for (std::uint32_t i = 0; i < candidates.size(); ++i) {
      candidates[i] = {static_cast<std::uint32_t>(random.below(12)),
                       static_cast<std::uint32_t>(random.below(10'000)),
                       1 + static_cast<std::uint32_t>(random.below(16)),
                       static_cast<std::uint32_t>(candidates.size()) - i};
    }
    group_multiqueries(model, persistence, candidates, ends);
    std::uint32_t first = 0;
    for (const std::uint32_t end : ends) {
      ASSERT_GT(end, first);
      const std::span left = std::span(candidates).subspan(first);
      std::size_t best = 1;
      for (std::size_t n = 2; n <= left.size(); ++n) {
        if (value(model, left.first(n)) > value(model, left.first(best))) best = n;
      }
      EXPECT_EQ(end - first, best) << "trial " << trial;
      first = end;
    }
    ASSERT_EQ(first, candidates.size());
    for (std::size_t i = 1; i < candidates.size(); ++i) {
      const MultiqueryCandidate& a = candidates[i - 1];
      const MultiqueryCandidate& b = candidates[i];
      EXPECT_TRUE(a.hidden_frames > b.hidden_frames ||
                  (a.hidden_frames == b.hidden_frames && a.id < b.id));
    }
  }
}

TEST(Multiquery, WhatWasHiddenForLongIsAskedTogetherAndWhatWasNotIsKeptApart) {
  const Persistence persistence(Persistence::Kind::formula);
  std::vector<MultiqueryCandidate> candidates;
  for (std::uint32_t i = 0; i < 12; ++i) candidates.push_back({i < 2 ? 1U : 20U, 100, 1, i});
  std::vector<std::uint32_t> ends;
  group_multiqueries({MultiqueryCost::paper, 0.0}, persistence, candidates, ends);
  EXPECT_EQ(ends, (std::vector<std::uint32_t>{10, 12}));
  // With the slides' model one heavy thing is not worth the risk of a light one.
  candidates = {{20, 10'000, 1, 0}, {1, 10, 1, 1}};
  group_multiqueries({MultiqueryCost::slides, 0.1}, persistence, candidates, ends);
  EXPECT_EQ(ends, (std::vector<std::uint32_t>{1, 2}));
}

TEST(Multiquery, NothingGivesNoGroupAndWorthlessThingsStillOneEach) {
  const Persistence persistence(Persistence::Kind::formula);
  std::vector<std::uint32_t> ends{3};
  group_multiqueries({}, persistence, {}, ends);
  EXPECT_TRUE(ends.empty());
  std::vector<MultiqueryCandidate> candidates{{4, 0, 1, 0}, {4, 0, 1, 1}};
  group_multiqueries({MultiqueryCost::slides, 0.1}, persistence, candidates, ends);
  EXPECT_EQ(ends, (std::vector<std::uint32_t>{1, 2}));
}

}  // namespace
}  // namespace vislab::occlusion_culling
