#include "experiments/analysis/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "common/geometry/random.h"

namespace vislab {
namespace {

constexpr int resamples = 1000;
constexpr std::uint64_t bootstrap_seed = 20260101;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Reorders the samples, so that resampling needs no copies.
double median_in_place(std::span<double> samples) {
  if (samples.empty()) return nan;
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  if (samples.size() % 2 == 1) return *middle;
  return 0.5 * (*std::max_element(samples.begin(), middle) + *middle);
}

/// Student's t that 2.5 % exceed. Of ten degrees of freedom and more by the expansion about the
/// normal distribution (Abramowitz and Stegun, 26.7.5), to three decimals.
double student_95(std::size_t degrees) {
  constexpr std::array few{12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622};
  if (degrees <= few.size()) return few[degrees - 1];
  constexpr double z = 1.959964;
  const double n = static_cast<double>(degrees);
  const double first = (std::pow(z, 3) + z) / 4.0;
  const double second = (5.0 * std::pow(z, 5) + 16.0 * std::pow(z, 3) + 3.0 * z) / 96.0;
  const double third =
      (3.0 * std::pow(z, 7) + 19.0 * std::pow(z, 5) + 17.0 * std::pow(z, 3) - 15.0 * z) / 384.0;
  return z + first / n + second / (n * n) + third / (n * n * n);
}

/// `value` with Student's interval of the rounds' figures, of which there are two or more: over
/// their logarithms, or, if one is 0, over themselves. The value is not their mean; the interval
/// reaches it.
Estimate with_student_interval(double value, std::vector<double> figures) {
  const bool is_log = std::ranges::all_of(figures, [](double figure) { return figure > 0.0; });
  const auto count = static_cast<double>(figures.size());
  double mean = 0.0;
  // Figures that are alike must give no width at all: 0 is exact only about one of them.
  const double origin = is_log ? std::log(figures.front()) : figures.front();
  for (double& figure : figures) {
    figure = (is_log ? std::log(figure) : figure) - origin;
    mean += figure / count;
  }
  double squares = 0.0;
  for (const double figure : figures) squares += (figure - mean) * (figure - mean);
  const double half = student_95(figures.size() - 1) * std::sqrt(squares / (count - 1.0) / count);
  // Without spread the bounds are the figures', which the way through logarithms would round.
  if (!(half > 0.0) && mean == 0.0) return {value, value, value};
  double low = origin + mean - half;
  double high = origin + mean + half;
  low = is_log ? std::exp(low) : std::max(0.0, low);
  high = is_log ? std::exp(high) : high;
  return {value, std::min(low, value), std::max(high, value)};
}

/// The median of sorted samples of which each was drawn so many times, as many times in all as
/// there are samples.
double median_of_drawn(std::span<const double> sorted, std::span<const std::uint32_t> times) {
  const std::size_t lower = (sorted.size() - 1) / 2;
  const std::size_t upper = sorted.size() / 2;
  std::size_t i = 0;
  std::size_t seen = times[0];
  while (seen <= lower) seen += times[++i];
  const double first = sorted[i];
  while (seen <= upper) seen += times[++i];
  return upper == lower ? first : 0.5 * (first + sorted[i]);
}

/// Of one round: `value`, the median of its frames, with the bootstrap's interval over them.
Estimate with_interval_of_frames(double value, RoundSamples frames) {
  Random random(bootstrap_seed);
  // How often each is drawn says all: nothing needs to be sorted again.
  std::ranges::sort(frames);
  std::vector<std::uint32_t> times(frames.size());
  std::vector<double> values;
  values.reserve(resamples);
  for (int i = 0; i < resamples; ++i) {
    std::ranges::fill(times, 0);
    for (std::size_t k = 0; k < frames.size(); ++k) ++times[random.below(frames.size())];
    values.push_back(median_of_drawn(frames, times));
  }
  return {value, quantile(values, 0.025), quantile(values, 0.975)};
}

/// `value` with the interval that the samples of each round give it; rounds without any do not
/// count.
Estimate with_interval(double value, const SampleGrid& rounds) {
  std::vector<double> medians;
  const RoundSamples* last = nullptr;
  for (const RoundSamples& round : rounds) {
    if (round.empty()) continue;
    medians.push_back(median(round));
    last = &round;
  }
  if (medians.empty()) return Estimate::none();
  if (medians.size() == 1) return with_interval_of_frames(value, *last);
  return with_student_interval(value, std::move(medians));
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
  for (std::size_t f = 0; f < of_path.size(); ++f) {
    for (std::size_t r = 0; r < rounds.size(); ++r) of_frame[r] = rounds[r][f];
    of_path[f] = median_in_place(of_frame);
  }
  return with_interval(median_in_place(of_path), rounds);
}

Estimate standard_deviation(const SampleGrid& rounds) {
  double mean = 0.0;
  double count = 0.0;
  for (const RoundSamples& round : rounds) {
    count += static_cast<double>(round.size());
    for (const double sample : round) mean += sample;
  }
  if (!(count > 0.0)) return Estimate::none();
  mean /= count;
  double all_squares = 0.0;
  std::vector<double> of_rounds;
  for (const RoundSamples& round : rounds) {
    if (round.empty()) continue;
    double squares = 0.0;
    for (const double sample : round) squares += (sample - mean) * (sample - mean);
    all_squares += squares;
    of_rounds.push_back(std::sqrt(squares / static_cast<double>(round.size())));
  }
  const double value = std::sqrt(all_squares / count);
  if (of_rounds.size() < 2) return {value, value, value};
  return with_student_interval(value, std::move(of_rounds));
}

Estimate paired_ratio(const SampleGrid& numerator, const SampleGrid& denominator) {
  SampleGrid ratios(numerator.size());
  std::vector<double> pairs;
  for (std::size_t r = 0; r < ratios.size(); ++r) {
    for (std::size_t f = 0; f < numerator[r].size(); ++f) {
      if (!(denominator[r][f] > 0.0)) continue;
      ratios[r].push_back(numerator[r][f] / denominator[r][f]);
    }
    pairs.insert(pairs.end(), ratios[r].begin(), ratios[r].end());
  }
  return with_interval(median_in_place(pairs), ratios);
}

}  // namespace vislab
