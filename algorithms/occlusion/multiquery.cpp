#include "algorithms/occlusion/multiquery.h"

#include <algorithm>

namespace vislab::occlusion_culling {
namespace {

/// Value of a group of `count` candidates with so many boxes and triangles, all hidden with chance
/// `all_hidden`.
double value_of(const MultiqueryModel& model, double all_hidden, double count, double boxes,
                double triangles) {
  if (model.cost == MultiqueryCost::slides) {
    return all_hidden * triangles / (1.0 + model.box_cost * boxes);
  }
  return count / (1.0 + (1.0 - all_hidden) * count);
}

/// Length of the prefix of greatest value; at least 1. `triangles_left` of all candidates.
std::uint32_t best_prefix(const MultiqueryModel& model, const Persistence& persistence,
                          std::span<const MultiqueryCandidate> candidates, double triangles_left) {
  // Roundings must not end the scan before a prefix that is better by one of them.
  constexpr double more_than_roundings = 1.0 + 1e-9;
  double all_hidden = 1.0;
  double boxes = 0.0;
  double triangles = 0.0;
  double best_value = -1.0;
  std::uint32_t best = 1;
  const auto most = static_cast<double>(candidates.size());
  for (std::uint32_t i = 0; i < candidates.size(); ++i) {
    all_hidden *= persistence(candidates[i].hidden_frames);
    boxes += candidates[i].boxes;
    triangles += candidates[i].triangles;
    const double value = value_of(model, all_hidden, i + 1.0, boxes, triangles);
    if (value > best_value) {
      best_value = value;
      best = i + 1;
    }
    // A longer prefix is hidden no likelier and costs no less than this one.
    const double bound = value_of(model, all_hidden, most, boxes, triangles_left);
    if (bound * more_than_roundings < best_value) break;
  }
  return best;
}

}  // namespace

void group_multiqueries(const MultiqueryModel& model, const Persistence& persistence,
                        std::span<MultiqueryCandidate> candidates,
                        std::vector<std::uint32_t>& ends) {
  ends.clear();
  std::ranges::sort(candidates, [](const MultiqueryCandidate& a, const MultiqueryCandidate& b) {
    if (a.hidden_frames != b.hidden_frames) return a.hidden_frames > b.hidden_frames;
    return a.id < b.id;
  });
  double triangles_left = 0.0;
  for (const MultiqueryCandidate& candidate : candidates) triangles_left += candidate.triangles;
  for (std::uint32_t first = 0; first < candidates.size();) {
    const std::uint32_t count =
        best_prefix(model, persistence, candidates.subspan(first), triangles_left);
    for (const MultiqueryCandidate& candidate : candidates.subspan(first, count)) {
      triangles_left -= candidate.triangles;
    }
    first += count;
    ends.push_back(first);
  }
}

}  // namespace vislab::occlusion_culling
