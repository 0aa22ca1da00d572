#include "experiments/analysis/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/geometry/random.h"

namespace vislab {
namespace {

TEST(Statistics, MedianOfAnOddNumberIsTheMiddleSample) {
  EXPECT_DOUBLE_EQ(median({5.0, 1.0, 3.0}), 3.0);
}

TEST(Statistics, MedianOfAnEvenNumberIsTheMeanOfTheTwoInTheMiddle) {
  EXPECT_DOUBLE_EQ(median({8.0, 1.0, 2.0, 4.0}), 3.0);
}

TEST(Statistics, NothingHasNoMedianAndNoQuantile) {
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(Statistics, QuantilesAreInterpolatedBetweenSamples) {
  const std::vector<double> samples{10.0, 20.0, 30.0, 40.0, 50.0};
  EXPECT_DOUBLE_EQ(quantile(samples, 0.0), 10.0);
  EXPECT_DOUBLE_EQ(quantile(samples, 0.25), 20.0);
  EXPECT_DOUBLE_EQ(quantile(samples, 0.95), 48.0);
  EXPECT_DOUBLE_EQ(quantile(samples, 1.0), 50.0);
  EXPECT_DOUBLE_EQ(quantile({7.0}, 0.99), 7.0);
}

TEST(Statistics, AFrameCountsWithTheMedianOfItsRounds) {
  // Medians of the frames are 2, 20 and 5; a mean, or a median of all samples, would differ.
  const SampleGrid rounds{{1.0, 10.0, 5.0}, {2.0, 20.0, 5.0}, {900.0, 30.0, 5.0}};
  EXPECT_DOUBLE_EQ(median_of_frames(rounds).value, 5.0);
  EXPECT_DOUBLE_EQ(median_of_frames({{1.0, 10.0}, {2.0, 20.0}, {900.0, 30.0}}).value, 11.0);
}

TEST(Statistics, RoundsThatAgreeGiveAnIntervalWithoutWidth) {
  const SampleGrid rounds(5, RoundSamples{1.0, 4.0, 9.0});
  const Estimate estimate = median_of_frames(rounds);
  EXPECT_DOUBLE_EQ(estimate.low, 4.0);
  EXPECT_DOUBLE_EQ(estimate.high, 4.0);
}

TEST(Statistics, TheIntervalIsStudentsOverTheLogarithmsOfTheRounds) {
  // Logarithms -1, 0 and 1: their mean is 0, its error 1/√3, and t of two degrees 4.3027.
  const double e = std::numbers::e;
  const Estimate three = median_of_frames({{1.0 / e}, {1.0}, {e}});
  EXPECT_DOUBLE_EQ(three.value, 1.0);
  EXPECT_NEAR(three.high, std::exp(4.3027 / std::sqrt(3.0)), 1e-9);
  EXPECT_NEAR(three.low, 1.0 / three.high, 1e-9);
  // Two rounds: 12.7062 times the error of the mean.
  const Estimate two = paired_ratio({{1.0, 1.0}, {e, e}}, {{1.0, 1.0}, {1.0, 1.0}});
  EXPECT_NEAR(std::log(two.high), 0.5 + 12.7062 * 0.5, 1e-9);
  EXPECT_NEAR(std::log(two.low), 0.5 - 12.7062 * 0.5, 1e-9);
  // Many: t of 40 degrees is 2.0211.
  SampleGrid many(41, RoundSamples{1.0});
  many.back() = {e};
  const double error = std::sqrt((40.0 / 41.0) / 40.0 / 41.0);
  EXPECT_NEAR(std::log(median_of_frames(many).high), 1.0 / 41.0 + 2.0211 * error, 1e-5);
}

TEST(Statistics, TheIntervalReachesTheValueAndNothingBelowZero) {
  const Estimate outlier = median_of_frames({{1.0}, {1.0}, {1.0}, {1.0}, {900.0}});
  EXPECT_DOUBLE_EQ(outlier.value, 1.0);
  EXPECT_LE(outlier.low, 1.0);
  EXPECT_GT(outlier.high, 30.0);
  const Estimate zero = median_of_frames({{0.0}, {1.0}, {2.0}});
  EXPECT_DOUBLE_EQ(zero.low, 0.0);
  EXPECT_NEAR(zero.high, 1.0 + 4.3027 / std::sqrt(3.0), 1e-9);
}

TEST(Statistics, FramesMakeTheIntervalOnlyOfASingleRound) {
  RoundSamples samples;
  for (int i = 0; i < 20; ++i) samples.push_back(i);
  const Estimate one = median_of_frames({samples});
  EXPECT_LT(one.low, 9.5);
  EXPECT_GT(one.high, 9.5);
  const Estimate two = median_of_frames({samples, samples});
  EXPECT_DOUBLE_EQ(two.low, 9.5);
  EXPECT_DOUBLE_EQ(two.high, 9.5);
}

/// The normal distribution of mean 0 and deviation 1, by Box and Muller.
double normal(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * random.uniform());
}

TEST(Statistics, IntervalsOfFewRoundsHoldTheTruthAsOftenAsTheySay) {
  constexpr int experiments = 2000;
  constexpr int frames = 24;
  constexpr double truth = 0.8;
  Random random(8);
  for (const int rounds : {2, 3, 5, 7}) {
    int ratio_holds = 0;
    int time_holds = 0;
    for (int i = 0; i < experiments; ++i) {
      SampleGrid cell(static_cast<std::size_t>(rounds), RoundSamples(frames));
      const SampleGrid none(static_cast<std::size_t>(rounds), RoundSamples(frames, 1.0));
      for (RoundSamples& round : cell) {
        const double of_round = 0.02 * normal(random);
        for (double& sample : round) {
          sample = truth * std::exp(of_round + 0.05 * normal(random));
        }
      }
      const Estimate ratio = paired_ratio(cell, none);
      const Estimate time = median_of_frames(cell);
      ratio_holds += ratio.low <= truth && truth <= ratio.high ? 1 : 0;
      time_holds += time.low <= truth && truth <= time.high ? 1 : 0;
    }
    EXPECT_GE(ratio_holds, 0.93 * experiments) << rounds << " rounds";
    EXPECT_GE(time_holds, 0.93 * experiments) << rounds << " rounds";
  }
}

TEST(Statistics, RatiosArePairedByRoundAndFrame) {
  // The machine was three times slower in the second round: paired ratios do not see it.
  const SampleGrid none{{10.0, 20.0}, {30.0, 60.0}};
  const SampleGrid cell{{5.0, 10.0}, {15.0, 30.0}};
  const Estimate estimate = paired_ratio(cell, none);
  EXPECT_DOUBLE_EQ(estimate.value, 0.5);
  EXPECT_DOUBLE_EQ(estimate.low, 0.5);
  EXPECT_DOUBLE_EQ(estimate.high, 0.5);
}

TEST(Statistics, TheRatioIsTheMedianOfAllPairs) {
  const Estimate estimate = paired_ratio({{1.0, 2.0, 6.0}}, {{2.0, 2.0, 2.0}});
  EXPECT_DOUBLE_EQ(estimate.value, 1.0);
  EXPECT_LE(estimate.low, estimate.value);
  EXPECT_GE(estimate.high, estimate.value);
}

TEST(Statistics, FramesOfRatiosWidenTheIntervalOnlyOfASingleRound) {
  const RoundSamples cell{1.0, 2.0, 3.0, 4.0, 5.0};
  const RoundSamples none(5, 1.0);
  const Estimate two = paired_ratio({cell, cell}, {none, none});
  EXPECT_DOUBLE_EQ(two.low, 3.0);
  EXPECT_DOUBLE_EQ(two.high, 3.0);
  const Estimate one = paired_ratio({cell}, {none});
  EXPECT_LT(one.low, 3.0);
  EXPECT_GT(one.high, 3.0);
}

TEST(Statistics, PairsWithoutAPositiveDenominatorDoNotCount) {
  EXPECT_DOUBLE_EQ(paired_ratio({{4.0, 6.0}}, {{0.0, 2.0}}).value, 3.0);
  EXPECT_FALSE(paired_ratio({{4.0}}, {{0.0}}).measured());
}

TEST(Statistics, NothingMeasuredGivesNoEstimate) {
  EXPECT_FALSE(median_of_frames({}).measured());
  EXPECT_FALSE(median_of_frames({{}, {}}).measured());
  EXPECT_FALSE(paired_ratio({}, {}).measured());
}

TEST(Statistics, SpreadIsThatOfAllSamplesWithAnIntervalOfRounds) {
  EXPECT_DOUBLE_EQ(standard_deviation({{1.0, 3.0}, {5.0, 7.0}}).value, std::sqrt(5.0));
  const Estimate alike = standard_deviation({{1.0, 3.0}, {3.0, 1.0}, {1.0, 3.0}});
  EXPECT_DOUBLE_EQ(alike.low, 1.0);
  EXPECT_DOUBLE_EQ(alike.high, 1.0);
  const Estimate unlike = standard_deviation({{1.0, 3.0}, {2.0, 2.0}, {0.0, 9.0}, {1.0, 2.0}});
  EXPECT_LT(unlike.low, unlike.value);
  EXPECT_GT(unlike.high, unlike.value);
  EXPECT_FALSE(standard_deviation({}).measured());
  EXPECT_FALSE(standard_deviation({{}, {}}).measured());
}

TEST(Statistics, TheSameSamplesGiveTheSameInterval) {
  SampleGrid rounds;
  for (int r = 0; r < 7; ++r) rounds.push_back({1.0 + r, 2.0 + 3.0 * r, 4.0 - 0.1 * r});
  const Estimate first = median_of_frames(rounds);
  const Estimate second = median_of_frames(rounds);
  EXPECT_EQ(first.low, second.low);
  EXPECT_EQ(first.high, second.high);
  EXPECT_LT(first.low, first.high);
}

}  // namespace
}  // namespace vislab
