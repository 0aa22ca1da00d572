// The image judge: draws what was kept, in canonical id order, and compares it with the full scene
// drawn the same way on the same device; and compares truth with the full scene's image.
#pragma once

#include "common/judge/metrics.h"
#include "common/render/osmesa_device.h"

namespace vislab {

/// Why a differing pixel is excused: it lies within 1/128 pixel of an edge of either triangle, or the
/// two depths at its centre differ by less than 1e-4 relative. `a` and `b` are triangles (none_id for
/// background: only the other's edges count then).
bool is_disputed(const Frame& frame, const Scene& scene, const glm::dvec2& window_px, TriangleId a,
                 TriangleId b);

class ImageJudge {
 public:
  /// Uses a device of its own. The scene outlives the judge.
  explicit ImageJudge(const Scene& scene);
  ~ImageJudge();

  /// Draws the full scene and keeps its ids for judge() and error_floor(). Once a frame.
  void start(const Frame& frame);

  /// Differences between the image of `kept` and the full image.
  ImageVerdict judge(const Frame& frame, const VisibleSet& kept);

  /// Differences between truth at the pixel centres and the full image: how many are disputed (the
  /// error floor), and how many are not (a fault of the judge itself).
  struct Floor {
    std::uint64_t disputed_px = 0;
    std::uint64_t undisputed_px = 0;
  };
  Floor error_floor(const Frame& frame, const FrameTruth& truth);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vislab
