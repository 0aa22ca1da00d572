// How likely what was hidden stays hidden.
//
// Idea: the longer something has been hidden without a break, the likelier it is hidden in the next
//   frame too: p(t) = 0.99 - 0.7 e^-t for t frames. The formula was fitted to walks through large
//   scenes; where a method looks often enough it can count for itself how often its expectation
//   came true, and that is right for fast cameras too.
// Guarantee: none: a guess that decides what is asked together, never what is drawn. Numbers lie in
//   (0, 1) and are the same on every machine.
// Cost: a look-up.
// Limits: beyond the last time that is told apart, all times count as that one.
// Sources: Mattausch, Bittner, Wimmer 2008, CHC++, section 4; Zachmann, Computer-Graphik 2, SS
// 2012,
//   slide 65. What counting is added to is the formula, taken for `prior_answers` answers.
#pragma once

#include <array>
#include <cstdint>

namespace vislab::occlusion_culling {

class Persistence {
 public:
  enum class Kind { formula, measured };
  /// Times are told apart up to this one, frames.
  static constexpr std::uint32_t last_time = 31;

  explicit Persistence(Kind kind);

  /// 0.99 - 0.7 e^-t; t up to last_time.
  static double formula(std::uint32_t hidden_frames);

  /// Chance that something that was hidden in the last `hidden_frames` frames, and visible or not
  /// looked at before these, is hidden in this frame too.
  double operator()(std::uint32_t hidden_frames) const {
    return chances_[hidden_frames < last_time ? hidden_frames : last_time];
  }

  /// Tells what became of something that was asked about alone and had been hidden for so long;
  /// nothing happens if the kind is the formula. What was asked about in a group and is visible as
  /// a group is to be told only when it was asked about alone.
  void note(std::uint32_t hidden_frames, bool still_hidden);

  /// Forgets what was noted. Before every path.
  void reset();

 private:
  struct Answers {
    std::uint32_t all = 0, hidden = 0;
  };
  Kind kind_;
  std::array<double, last_time + 1> chances_{};
  std::array<Answers, last_time + 1> answers_{};
};

}  // namespace vislab::occlusion_culling
