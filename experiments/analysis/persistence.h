// How long hidden things stay hidden, counted along a path.
//
// Idea: an object in the view that was hidden in exactly the last t frames without a break is
// hidden
//   in this frame too, or not. p(t) is the share of those that are, as the methods that ask about
//   hidden things together need it (CHC++). Truth decides what is hidden.
// Limits: an object counts as hidden if no sample of truth hits it, small ones too. Time is counted
//   from when the object came into the view or the path began, as a method would. Cases of one
//   object, and of neighbours, are not independent: the intervals are too narrow by an unknown
//   factor.
// Source: Mattausch, Bittner, Wimmer 2008, CHC++, section 4; Zachmann, Computer-Graphik 2, SS 2012,
//   slide 65. Intervals: Wilson 1927.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/scene/frame.h"
#include "experiments/analysis/statistics.h"

namespace vislab {

/// Objects that were hidden for one time, and how many of them still were in the next frame.
struct StillHidden {
  std::uint64_t cases = 0;
  std::uint64_t hidden = 0;

  /// The share, with its 95 % interval; NaN without cases.
  Estimate share() const;
};

/// p(t) ≈ level - drop · e^(-t / time), for t from 1; level at most 1, drop at least 0.
struct PersistenceFit {
  double level = 0.0, drop = 0.0, time = 1.0;

  double operator()(double t) const;
};

/// What was counted along a path.
struct PersistenceCounts {
  /// By t, frames hidden without a break; [0]: were visible. The last one holds all longer ones.
  std::vector<StillHidden> after;
  /// The same of objects that were seen in the view before they were hidden.
  std::vector<StillHidden> after_seen;
  double turn_deg = 0.0;         // median of the camera's turn from frame to frame
  double step_m = 0.0;           // and of its way
  double hidden_share = 0.0;     // hidden objects / objects in the view, over all frames
  double appearing_share = 0.0;  // objects hidden in the last frame and seen now / hidden then

  /// Least squares by the number of cases, over all t from 1 that have any. NaN if fewer than three
  /// do.
  PersistenceFit fit() const;
};

class PersistenceCounter {
 public:
  /// Times are told apart up to this one, frames.
  static constexpr std::size_t last_time = 31;

  explicit PersistenceCounter(std::size_t object_count);

  /// The frames of one path in their order, and the objects that are seen (ascending). O(objects).
  void add(const Frame& frame, std::span<const ObjectId> visible);

  PersistenceCounts counts() const;

 private:
  struct Past {
    bool in_view = false;      // in the frame before
    bool seen_before = false;  // was visible in the view since it came into it
    std::uint32_t hidden = 0;  // frames without a break, up to the frame before
  };

  std::vector<Past> past_;         // by object
  std::vector<std::uint8_t> now_;  // by object: 1 shown, 2 visible
  std::vector<StillHidden> after_, after_seen_;
  std::vector<double> turns_deg_, steps_m_;
  bool have_camera_ = false;
  Camera camera_;
  std::uint64_t in_view_ = 0, hidden_ = 0;
};

/// How long things stayed hidden on one scene and path, as the report and the files beside it name
/// it.
struct PersistenceRow {
  std::string scene, path;
  Viewport viewport;
  int frames = 0;
  PersistenceCounts counts;
};

/// All counts as JSON, an object a row, with the lecture's formula beside them.
std::string to_json(const std::vector<PersistenceRow>& rows);

}  // namespace vislab
