#include "algorithms/backface/culling_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace vislab::backface_culling {
namespace {

/// Volume of { s in [0, L] : w.s <= d } for w >= 0, by inclusion and exclusion: the corner simplex
/// of w.s <= d, less those that begin beyond a side, and so on.
double clipped_volume(std::span<const double> weights, std::span<const double> lengths, double d) {
  std::array<double, 3> steps{};  // w_i L_i
  double largest = 0.0;
  double total = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    steps[i] = weights[i] * lengths[i];
    largest = std::max(largest, steps[i]);
    total += steps[i];
  }
  double volume = 1.0;
  if (d <= 0.0) return 0.0;
  if (d >= total) {
    for (const double length : lengths) volume *= length;
    return volume;
  }
  // Along an axis that hardly counts the sums would be rounding only: there its middle stands for
  // it, which is off in the second order.
  constexpr double negligible = 1e-4;
  std::array<double, 3> counted{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    volume *= lengths[i];
    if (steps[i] > negligible * largest) {
      counted[count++] = steps[i];
    } else {
      d -= 0.5 * steps[i];
    }
  }
  double sum = 0.0;
  double divisor = 1.0;
  for (std::size_t i = 0; i < count; ++i) divisor *= static_cast<double>(i + 1) * counted[i];
  for (unsigned sides = 0; sides < (1U << count); ++sides) {
    double rest = d;
    double sign = 1.0;
    for (std::size_t i = 0; i < count; ++i) {
      if (((sides >> i) & 1U) == 0) continue;
      rest -= counted[i];
      sign = -sign;
    }
    if (!(rest > 0.0)) continue;
    for (std::size_t i = 0; i < count; ++i) sign *= rest;
    sum += sign;
  }
  return volume * std::clamp(sum / divisor, 0.0, 1.0);
}

}  // namespace

double culling_volume(const ClusterBound& bound, const Aabb& box) {
  const glm::dvec3 low = glm::dvec3(box.min) - glm::dvec3(bound.origin);
  const glm::dvec3 high = glm::dvec3(box.max) - glm::dvec3(bound.origin);
  double volume = 0.0;
  for (unsigned octant = 0; octant < 8; ++octant) {
    std::array<double, 3> weights{}, lengths{};
    double d = bound.back;
    bool empty = false;
    for (int axis = 0; axis < 3; ++axis) {
      const bool positive = ((octant >> static_cast<unsigned>(axis)) & 1U) != 0;
      const double from = positive ? std::max(low[axis], 0.0) : low[axis];
      const double to = positive ? high[axis] : std::min(high[axis], 0.0);
      if (!(from < to)) empty = true;
      const double weight = positive ? bound.high[axis] : bound.low[axis];
      d -= weight * (weight > 0.0 ? from : to);  // from the corner where the value is least
      const auto i = static_cast<std::size_t>(axis);
      weights[i] = std::abs(weight);
      lengths[i] = to - from;
    }
    if (!empty) volume += clipped_volume(weights, lengths, d);
  }
  return volume;
}

bool should_join(const ClusterOdds& a, const ClusterOdds& b, double joined_probability,
                 double test_cost, JoinRule rule) {
  const double apart = a.probability * a.triangles + b.probability * b.triangles;
  const double signed_cost = rule == JoinRule::derived ? -test_cost : test_cost;
  return joined_probability * (a.triangles + b.triangles) > apart + signed_cost;
}

}  // namespace vislab::backface_culling
