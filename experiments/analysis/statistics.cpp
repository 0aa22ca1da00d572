#include "experiments/analysis/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "common/geometry/random.h"

namespace vislab {
namespace {

constexpr int resamples = 1000;
constexpr std::uint64_t bootstrap_seed = 20260101;
constexpr std::size_t few_rounds = 3;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Reorders the samples, so that resampling needs no copies.
double median_in_place(std::span<double> samples) {
  if (samples.empty()) return nan;
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  if (samples.size() % 2 == 1) return *middle;
  return 0.5 * (*std::max_element(samples.begin(), middle) + *middle);
}

/// `count` indices below `count`, drawn with replacement; or all of them in order.
void draw_indices(Random& random, bool resample, std::vector<std::size_t>& indices) {
  for (std::size_t i = 0; i < indices.size(); ++i) {
    indices[i] = resample ? random.below(indices.size()) : i;
  }
}

/// The interval of `statistic(rounds, frames)` under resampling of the index lists handed to it.
template <typename Statistic>
Estimate bootstrap(std::size_t rounds, std::size_t frames, bool resample_frames,
                   Statistic&& statistic) {
  Random random(bootstrap_seed);
  std::vector<std::size_t> round_indices(rounds);
  std::vector<std::size_t> frame_indices(frames);
  draw_indices(random, false, round_indices);
  draw_indices(random, false, frame_indices);
  Estimate estimate;
  estimate.value = statistic(round_indices, frame_indices);
  std::vector<double> values;
  values.reserve(resamples);
  for (int i = 0; i < resamples; ++i) {
    draw_indices(random, true, round_indices);
    draw_indices(random, resample_frames, frame_indices);
    const double value = statistic(round_indices, frame_indices);
    if (!std::isnan(value)) values.push_back(value);
  }
  estimate.low = quantile(values, 0.025);
  estimate.high = quantile(std::move(values), 0.975);
  return estimate;
}

bool is_empty(const SampleGrid& rounds) { return rounds.empty() || rounds.front().empty(); }

}  // namespace

Estimate Estimate::none() { return {nan, nan, nan}; }

double quantile(std::vector<double> samples, double share) {
  if (samples.empty()) return nan;
  std::ranges::sort(samples);
  const double at = share * static_cast<double>(samples.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, samples.size() - 1);
  return samples[below] + (at - static_cast<double>(below)) * (samples[above] - samples[below]);
}

double median(std::vector<double> samples) { return median_in_place(samples); }

Estimate median_of_frames(const SampleGrid& rounds) {
  if (is_empty(rounds)) return Estimate::none();
  std::vector<double> of_frame(rounds.size());
  std::vector<double> of_path(rounds.front().size());
  return bootstrap(rounds.size(), rounds.front().size(), rounds.size() < few_rounds,
                   [&](const auto& round_indices, const auto& frame_indices) {
                     for (std::size_t f = 0; f < frame_indices.size(); ++f) {
                       for (std::size_t r = 0; r < round_indices.size(); ++r) {
                         of_frame[r] = rounds[round_indices[r]][frame_indices[f]];
                       }
                       of_path[f] = median_in_place(of_frame);
                     }
                     return median_in_place(of_path);
                   });
}

Estimate standard_deviation(const SampleGrid& rounds) {
  double mean = 0.0;
  std::size_t count = 0;
  for (const RoundSamples& round : rounds) {
    count += round.size();
    for (const double sample : round) mean += sample;
  }
  if (count == 0) return Estimate::none();
  mean /= static_cast<double>(count);
  // Sums about the mean of all: those of resampled rounds are sums of these.
  struct Sums {
    double count = 0.0, first = 0.0, second = 0.0;
  };
  std::vector<Sums> sums;
  for (const RoundSamples& round : rounds) {
    Sums& own = sums.emplace_back();
    own.count = static_cast<double>(round.size());
    for (const double sample : round) {
      own.first += sample - mean;
      own.second += (sample - mean) * (sample - mean);
    }
  }
  return bootstrap(rounds.size(), 1, false, [&](const auto& round_indices, const auto&) {
    Sums all;
    for (const std::size_t r : round_indices) {
      all.count += sums[r].count;
      all.first += sums[r].first;
      all.second += sums[r].second;
    }
    if (!(all.count > 0.0)) return nan;
    const double shift = all.first / all.count;
    return std::sqrt(std::max(0.0, all.second / all.count - shift * shift));
  });
}

Estimate paired_ratio(const SampleGrid& numerator, const SampleGrid& denominator) {
  if (is_empty(numerator)) return Estimate::none();
  SampleGrid ratios = numerator;
  for (std::size_t r = 0; r < ratios.size(); ++r) {
    for (std::size_t f = 0; f < ratios[r].size(); ++f) {
      ratios[r][f] = denominator[r][f] > 0.0 ? numerator[r][f] / denominator[r][f] : nan;
    }
  }
  std::vector<double> pairs;
  return bootstrap(ratios.size(), ratios.front().size(), ratios.size() < few_rounds,
                   [&](const auto& round_indices, const auto& frame_indices) {
                     pairs.clear();
                     for (const std::size_t r : round_indices) {
                       for (const std::size_t f : frame_indices) {
                         if (!std::isnan(ratios[r][f])) pairs.push_back(ratios[r][f]);
                       }
                     }
                     return median_in_place(pairs);
                   });
}

}  // namespace vislab
