// When a method that asks what is hidden does not ask, because hardly anything is.
//
// Idea: after a few frames in a row in which hardly anything was hidden, it sleeps for a while,
//   tries one frame, and sleeps longer if that was in vain, too. Much that is new in the view
//   wakes it.
// Guarantee: none needed: a method that sleeps draws everything in the view.
// Cost: none.
// Limits: what comes to be hidden without anything new is noticed only when the pause ends: after
//   longest_pause frames at most.
// Source: own.
#pragma once

#include <algorithm>
#include <cstdint>

namespace vislab::occlusion_culling {

class SleepPattern {
 public:
  static constexpr int patience = 4;  // frames in vain in a row, after which it falls asleep
  static constexpr std::uint32_t first_pause = 8;
  static constexpr std::uint32_t longest_pause = 64;

  /// Is this frame slept through? The same answer throughout a frame.
  bool asleep(std::uint64_t frame) {
    if (frame == frame_) return asleep_;
    if (frame_ != no_frame) judge();
    frame_ = frame;
    asleep_ = left_ > 0;
    if (asleep_) --left_;
    in_vain_ = true;
    return asleep_;
  }
  /// At the end of a call in a frame that was not slept through.
  void note_tried(bool in_vain) { in_vain_ &= in_vain; }
  /// At the end of a call in one that was.
  void note_slept(bool much_is_new) {
    if (!much_is_new) return;
    left_ = 0;
    frames_in_vain_ = 0;
    pause_ = first_pause;
  }

 private:
  static constexpr std::uint64_t no_frame = ~std::uint64_t{0};

  void judge() {
    if (asleep_) return;
    if (!in_vain_) {
      frames_in_vain_ = 0;
      pause_ = first_pause;
    } else if (++frames_in_vain_ >= patience) {
      left_ = pause_;
      pause_ = std::min(2 * pause_, longest_pause);
      frames_in_vain_ = patience - 1;  // one frame is tried after the pause
    }
  }

  std::uint64_t frame_ = no_frame;
  bool asleep_ = false;
  bool in_vain_ = true;
  int frames_in_vain_ = 0;
  std::uint32_t pause_ = first_pause;  // the next one
  std::uint32_t left_ = 0;             // frames still to sleep
};

}  // namespace vislab::occlusion_culling
