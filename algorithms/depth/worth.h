// Notices that occlusion culling does not pay, and stops it for a while.
//
// Idea: what a frame's culling saved and what it cost is estimated from counts, at declared costs
//   (CostTable::typical() and the constants below); no clock is read, so answers come again. After
//   a few frames in a row without profit the method sleeps, and tries one frame after ever longer
//   pauses. A cut of the camera, or many objects that change, make it try soon.
// Guarantee: none needed: a method that sleeps keeps everything.
// Cost: a few operations a frame.
// Limits: costs are declared, not measured; a scene that alternates faster than the pauses is
//   judged by the frames that were tried.
// Sources: none; Greene, Kass, Miller 1993 and Zachmann slide 47 say that culling may not pay.
#pragma once

#include <cstdint>

#include "common/culler/culler.h"

namespace vislab::depth_culling {

class Worth {
 public:
  /// What one call of cull() did.
  struct Work {
    std::uint64_t queries = 0;           // boxes projected and compared with the buffer
    std::uint64_t drawn_triangles = 0;   // handed to the software rasteriser
    std::uint64_t buffer_pixels = 0;     // cleared or reduced, once a frame
    std::uint64_t hidden_objects = 0;    // found hidden by others (not: outside of the view)
    std::uint64_t hidden_triangles = 0;  // of these; may be estimated
  };

  /// Before every path. Counters go on.
  void reset() {
    const std::uint64_t frames_asleep = frames_asleep_;
    *this = Worth();
    frames_asleep_ = frames_asleep;
  }
  /// From ICuller::update().
  void note(const Frame& frame, const Changes& changes);
  /// At the start of cull(): is occlusion to be looked for in this frame? The same answer
  /// throughout a frame.
  bool tries(const Frame& frame);
  /// At the end of a cull() that tried.
  void add(const Work& work);

  /// Frames that slept, ever.
  std::uint64_t frames_asleep() const { return frames_asleep_; }

 private:
  void judge_last_frame();
  bool cut(const Frame& frame) const;
  void wake_soon();

  static constexpr std::uint64_t no_frame = ~std::uint64_t{0};

  std::uint64_t frame_ = no_frame;  // that was decided last
  bool trying_ = true;
  bool added_ = false;  // work was added in it
  double profit_ns_ = 0.0;
  int frames_without_profit_ = 0;
  std::uint64_t pause_ = first_pause;  // the next one
  std::uint64_t sleep_ = 0;            // frames still to sleep
  bool have_camera_ = false;
  Camera camera_;
  std::uint64_t frames_asleep_ = 0;

  static constexpr std::uint64_t first_pause = 8;
};

}  // namespace vislab::depth_culling
