// Rays beside the truth's own: what would be known of visibility if they were aimed, counted or
// traced otherwise. With them the truth itself is put to the test; for oracles only.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/culler/culler.h"

namespace vislab {

/// Where rays go through the window, and how they are traced.
struct RaySampling {
  enum class Aim {
    jittered,  // stratified and jittered in every pixel, as the truth's, with another seed
    lattice    // at the same place of every square of pixels
  };

  Aim aim = Aim::jittered;
  int samples = 16;             // jittered: in each pixel, 1 to 4096
  int every_px = 1;             // lattice: edge of a square, pixels
  double offset_x_px = 0.5;     // lattice: from a square's lower left corner to the right, and
  double offset_y_px = 0.5;     // upward
  bool every_nearest = false;   // several triangles that a ray meets at the least depth are all
                                // seen; else the one that the tracer names
  bool robust = true;           // the tracer's test of triangles
  std::string instruction_set;  // "sse2", "avx" or "avx2"; empty: that of the truth
  std::uint64_t seed = 2;       // jittered
};

/// What the rays of one frame told.
struct RayFindings {
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;       // rays that met anything
  std::uint64_t triangles = 0;  // that were met first
  std::uint64_t seen_once = 0;  // triangles that one ray met: Good and Turing's singletons
  std::uint64_t ties = 0;       // rays that met several triangles at the least depth, if every one
                                // of these is asked for
  std::uint64_t other = 0;      // lattice: rays for which the truth's tracer names another triangle
};

/// A truth of other rays. What is visible in a frame can be asked after look() at it.
class RayProbe : public TruthSource {
 public:
  /// Traces the frame, the first time. Later calls for the same index repeat the answer, so that a
  /// probe serves one path. Valid as long as the probe.
  virtual const RayFindings& look(const Frame& frame) = 0;
};

/// A truth that can be had with other rays as well.
class ProbingTruth : public TruthSource {
 public:
  /// The scene of this truth outlives the probe. Throws InputError for settings that are out of
  /// range or that this machine cannot do.
  virtual std::unique_ptr<RayProbe> probe(const RaySampling& sampling) const = 0;
};

}  // namespace vislab
