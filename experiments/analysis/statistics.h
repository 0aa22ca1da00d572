// Medians, quantiles and bootstrap intervals of repeated measurements.
//
// Samples lie in a grid: rounds (repetitions of a whole path) × frames (of that path). Rounds are a
// random sample of what could have been measured; frames are not, the path is fixed: only rounds
// are resampled, unless there are fewer than three. Intervals are percentile bootstraps (Efron and
// Tibshirani, "An Introduction to the Bootstrap", 1993, chapter 13) of 1000 resamples with a fixed
// seed, so the same samples give the same interval.
#pragma once

#include <vector>

namespace vislab {

/// A value with its 95 % bootstrap interval; all three are NaN if nothing was measured.
struct Estimate {
  double value = 0.0, low = 0.0, high = 0.0;

  static Estimate none();
  bool measured() const { return value == value; }
};

/// Samples of one round, one a frame. All rounds of a grid have the same number of frames.
using RoundSamples = std::vector<double>;
using SampleGrid = std::vector<RoundSamples>;

/// The quantile at `share` in [0, 1], interpolated linearly between the two samples next to it;
/// NaN without samples. O(samples log samples).
double quantile(std::vector<double> samples, double share);

/// The quantile at 0.5. O(samples).
double median(std::vector<double> samples);

/// Median over the frames of each frame's median over the rounds. The interval comes from
/// resampling rounds; with fewer than three rounds, frames are resampled too, because so few rounds
/// say too little.
Estimate median_of_frames(const SampleGrid& rounds);

/// Standard deviation of all samples. The interval comes from resampling rounds, so that it has no
/// width where there is one round only; NaN without samples. Rounds may differ in length here.
/// O(samples + resamples × rounds).
Estimate standard_deviation(const SampleGrid& rounds);

/// Median of numerator / denominator over all pairs: the same round and the same frame of both
/// grids, which have the same shape. Pairs without a positive denominator do not count. The
/// interval comes from resampling as in median_of_frames().
Estimate paired_ratio(const SampleGrid& numerator, const SampleGrid& denominator);

}  // namespace vislab
