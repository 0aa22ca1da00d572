// The image judge: draws what was kept, in canonical id order, and compares it with the full scene
// drawn the same way on the same device; and compares truth with the full scene's image.
#pragma once

#include <memory>
#include <span>

#include "common/culler/visible_set.h"
#include "common/judge/disputed.h"
#include "common/judge/metrics.h"

namespace vislab {

class ImageJudge {
 public:
  /// Uses a device of its own, made here. The scene outlives the judge.
  explicit ImageJudge(const Scene& scene);
  ~ImageJudge();
  ImageJudge(const ImageJudge&) = delete;
  ImageJudge& operator=(const ImageJudge&) = delete;

  /// Draws the full scene (all that is shown) and keeps its ids and the truth of the same frame,
  /// which outlives the calls of judge() and error_floor(). Once a frame, before them.
  void start(const Frame& frame, const FrameTruth& truth);

  /// Who owns each pixel of the full image; none_id for the background. Valid until the next
  /// start().
  ShownImage full_image() const;

  /// Differences between the image of `kept` and the full image. The device leaves out the backs of
  /// `one_sided` objects (RenderDevice::one_sided), as it did for the culler. A differing pixel is
  /// excused if it is disputed between its two triangles; or, where the full image itself differs
  /// from truth, if truth's triangle is disputed with either of them: at its edge the rasteriser
  /// may see what lies behind it. Here and below the device's depth buffer counts (DepthSteps).
  ImageVerdict judge(const Frame& frame, const VisibleSet& kept,
                     std::span<const ObjectId> one_sided = {});

  /// Differences between truth at the pixel centres and the full image: how many are disputed (the
  /// error floor), and how many are not (a fault of the judge itself).
  struct Floor {
    std::uint64_t disputed_px = 0;
    std::uint64_t undisputed_px = 0;
    friend bool operator==(const Floor&, const Floor&) = default;
  };
  Floor error_floor(const Frame& frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What a method is held to beside an edge: the image that it painted (ICuller::surface_image), or,
/// if it promises the device's image, the full one of `device` (null: nothing is drawn), which was
/// started on the frame; no image for other methods.
ShownImage shown_image(Guarantee guarantee, std::span<const TriangleId> painted,
                       const ImageJudge* device);

}  // namespace vislab
