// Medians, quantiles and 95 % intervals of repeated measurements.
//
// Samples lie in a grid: rounds (repetitions of a whole path) × frames (of that path). Rounds are a
// random sample of what could have been measured; frames are not, the path is fixed. So each round
// is reduced to one figure, the median over its frames, and the interval is Student's over the
// logarithms of these figures (Student, "The Probable Error of a Mean", Biometrika 6, 1908): what
// disturbs times is a factor, and t has its coverage from two rounds on, if widely. Resampling a
// few whole rounds has not: of three it gives their least and greatest, which hold the truth in
// three cases of four. With one round nothing is known of rounds: the interval is then a percentile
// bootstrap over the frames (Efron and Tibshirani, "An Introduction to the Bootstrap", 1993,
// chapter 13; 1000 resamples, fixed seed), and says how frames differ, not how well the figure
// would repeat.
#pragma once

#include <vector>

namespace vislab {

/// A value with its 95 % interval, low <= value <= high; all three are NaN if nothing was measured.
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

/// Median over the frames of each frame's median over the rounds, with the interval of the rounds'
/// medians (see above). Samples are not negative. Where a round's median is 0, the interval is
/// Student's over the medians themselves, and begins at 0 at the lowest. O(rounds × frames); of one
/// round O(frames × resamples).
Estimate median_of_frames(const SampleGrid& rounds);

/// Standard deviation of all samples; the interval is Student's over the logarithms of the rounds'
/// own, each about the mean of all. It has no width where there is one round only; NaN without
/// samples. Rounds may differ in length here. O(samples).
Estimate standard_deviation(const SampleGrid& rounds);

/// Median of numerator / denominator over all pairs: the same round and the same frame of both
/// grids, which have the same shape. Pairs without a positive denominator do not count. The
/// interval is made of the rounds' medians as in median_of_frames().
Estimate paired_ratio(const SampleGrid& numerator, const SampleGrid& denominator);

}  // namespace vislab
