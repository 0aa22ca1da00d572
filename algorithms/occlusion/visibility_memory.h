// What was found visible in the frame before: the guess with which coherent methods start.
//
// Idea: a stamp an object, the frame in which it was last found visible. What was not in the view,
// or not shown, has no stamp of the last frame and so counts as not seen: it is asked about first.
// Cost: O(1) an object; nothing is cleared from frame to frame.
// Source: Zachmann, Computer-Graphik 2, SS 2012, slides 54 and 61 ("previously visible").
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/scene/scene.h"

namespace vislab::occlusion_culling {

class VisibilityMemory {
 public:
  /// Nothing was visible before.
  void build(std::size_t objects) { stamps_.assign(objects, 0); }
  void reset() { std::ranges::fill(stamps_, 0); }

  /// Was it found visible in the frame before `frame` (Frame::index)? Ask before mark(frame, …).
  bool seen_before(std::uint64_t frame, ObjectId object) const {
    return frame > 0 && stamps_[object] == frame;
  }
  /// It is found visible in `frame`.
  void mark(std::uint64_t frame, ObjectId object) { stamps_[object] = frame + 1; }

  std::size_t bytes() const { return stamps_.capacity() * sizeof(std::uint64_t); }

 private:
  std::vector<std::uint64_t> stamps_;  // index + 1 of the frame in which it was last seen
};

}  // namespace vislab::occlusion_culling
