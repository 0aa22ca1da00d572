// What a culler's answer is worth, measured against truth.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/culler/culler.h"
#include "common/judge/disputed.h"
#include "common/judge/truth.h"

namespace vislab {

/// The judge's verdict on one visible set of one frame. Counts are exact.
struct Verdict {
  // Sample set C: pixel centres.
  std::uint64_t pixels = 0;            // samples in C
  std::uint64_t false_px = 0;          // undisputed samples whose triangle was left out
  std::uint64_t max_false_px = 0;      // most of them on one object (object cullers) or triangle
  std::uint64_t disputed_lost_px = 0;  // disputed samples whose triangle was left out: excused
  /// Objects with a lost undisputed sample of C or J and no undisputed sample left, and objects
  /// that have disputed samples only and lost them all.
  std::uint64_t false_objects = 0;
  /// Triangles with at least one lost undisputed sample of C or J.
  std::uint64_t false_triangles = 0;
  /// Undisputed samples of J whose triangle was left out, and the samples of J.
  std::uint64_t false_jittered = 0;
  std::uint64_t jittered = 0;
  // Sizes of sets. An object is kept if any of its triangles is; visible if any sample of C or J,
  // disputed or not, hits it.
  std::uint64_t visible_objects = 0, visible_triangles = 0;          // truth
  std::uint64_t kept_objects = 0, submitted_triangles = 0;           // the culler's
  std::uint64_t over_objects_count = 0, over_triangles_count = 0;    // kept but invisible
  std::uint64_t under_objects_count = 0, under_triangles_count = 0;  // visible but left out
  std::uint64_t scene_objects = 0, scene_triangles = 0;              // shown
  /// Where samples of C were lost wrongly, pixel x and y, the worst object's or triangle's first;
  /// at most 64.
  std::vector<std::array<std::uint16_t, 2>> wrong_px;

  friend bool operator==(const Verdict&, const Verdict&) = default;
};

/// The image that a method is held to where its set alone does not say what lies at a pixel.
struct ShownImage {
  std::span<const TriangleId> owners;  // row by row from the bottom; none: there is no such image
  DepthSteps steps = DepthSteps::none;
};

/// Judges a set. A lost sample whose triangle is A is disputed if is_disputed() says so of A and
/// the first triangle that is hit there among the kept ones. Where an image says what lies there
/// instead of A (shown_image()), a lost sample of C is disputed as well if A and the image's owner
/// are, if that is kept or the background; throws std::logic_error if its size is not truth's.
/// `caster` is that of the truth; it is called only if the set loses samples. `granularity` says
/// whether max_false_px is over objects or triangles. O(visible + runs of the set), plus the
/// tracing of what is lost.
Verdict judge_set(const Frame& frame, const FrameTruth& truth, const VisibleSet& kept,
                  Granularity granularity, RayCaster& caster, const ShownImage& shown = {});

/// The judge's verdict on an image.
struct ImageVerdict {
  std::uint64_t image_px = 0;           // undisputed ids that differ from the unculled image
  std::uint64_t disputed_image_px = 0;  // disputed ids that differ
  friend bool operator==(const ImageVerdict&, const ImageVerdict&) = default;
};

/// A row of the table of metrics.
struct Metric {
  enum class Better { lower, higher, neither };

  std::string_view name;
  std::string_view unit;
  Better better;
  std::string_view meaning;
};

/// All metrics of the lab, in the order of reports.
std::span<const Metric> metrics();

}  // namespace vislab
