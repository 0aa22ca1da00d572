// Stability along a path: verdicts that change where truth does not, and things that appear late.
#pragma once

#include <cstdint>
#include <vector>

#include "common/culler/visible_set.h"
#include "common/judge/truth.h"

namespace vislab {

/// A frame's truth by object.
struct ObjectVisibility {
  std::vector<std::uint32_t> pixels;  // pixel centres (C) that the object owns
  std::vector<std::uint8_t> visible;  // 1 if any sample of C or J hits it
};

/// O(pixels + objects).
ObjectVisibility object_visibility(const Scene& scene, const FrameTruth& truth);

struct Stability {
  std::uint64_t toggles = 0;         // see flicker
  std::uint64_t pop_px_frames = 0;   // see pop
  std::uint64_t latency_frames = 0;  // see latency

  friend bool operator==(const Stability&, const Stability&) = default;
};

/// Follows what a culler keeps from frame to frame. An object is kept if any of its triangles is.
///   flicker: an object's verdict changes between two frames, though truth sees it in both or in
///            neither
///   pop:     pixels of objects that came into sight and have not been kept since, summed over
///   frames latency: the most frames that such an object is missing
class StabilityJudge {
 public:
  explicit StabilityJudge(const Scene& scene);  // the scene outlives the judge

  /// Frames in the order of the path. O(objects log runs).
  void add(const ObjectVisibility& truth, const VisibleSet& kept);

  const Stability& verdict() const { return verdict_; }

 private:
  struct Past {
    bool kept = false, visible = false;
    bool owned_pixels = false;
    std::uint32_t missing_frames = 0;  // since it came into sight; 0 = not missing
  };

  const Scene* scene_;
  std::vector<Past> past_;
  bool first_ = true;
  Stability verdict_;
};

}  // namespace vislab
