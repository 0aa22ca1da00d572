#include "algorithms/occlusion/persistence.h"

#include <algorithm>

namespace vislab::occlusion_culling {
namespace {

/// The formula counts like so many answers beside those that were noted.
constexpr double prior_answers = 16.0;
/// When so many were noted for a time, all are halved: the camera may go differently by now.
constexpr std::uint32_t most_answers = 1024;

/// By repeated products, not by a library's function: the same on every machine.
constexpr std::array<double, Persistence::last_time + 1> formula_table() {
  constexpr double one_over_e = 0.36787944117144233;
  std::array<double, Persistence::last_time + 1> table{};
  double power = 1.0;
  for (double& chance : table) {
    chance = 0.99 - 0.7 * power;
    power *= one_over_e;
  }
  return table;
}

constexpr std::array<double, Persistence::last_time + 1> formula_chances = formula_table();

}  // namespace

double Persistence::formula(std::uint32_t hidden_frames) {
  return formula_chances[std::min(hidden_frames, last_time)];
}

Persistence::Persistence(Kind kind) : kind_(kind) { reset(); }

void Persistence::reset() {
  chances_ = formula_chances;
  answers_ = {};
}

void Persistence::note(std::uint32_t hidden_frames, bool still_hidden) {
  if (kind_ == Kind::formula) return;
  const std::uint32_t time = std::min(hidden_frames, last_time);
  Answers& answers = answers_[time];
  ++answers.all;
  if (still_hidden) ++answers.hidden;
  if (answers.all >= most_answers) {
    answers.all /= 2;
    answers.hidden /= 2;
  }
  chances_[time] =
      (prior_answers * formula_chances[time] + answers.hidden) / (prior_answers + answers.all);
}

}  // namespace vislab::occlusion_culling
