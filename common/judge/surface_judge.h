// Judging the image that a hidden-surface algorithm painted itself. The set of triangles that own a
// pixel does not show that a method gives a pixel to the wrong one of two that are both seen.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/judge/truth.h"

namespace vislab {

struct SurfaceVerdict {
  std::uint64_t surface_px = 0;           // undisputed pixels whose owner is not truth's
  std::uint64_t disputed_surface_px = 0;  // disputed ones
  friend bool operator==(const SurfaceVerdict&, const SurfaceVerdict&) = default;
};

/// Compares the owners of all pixels (ICuller::surface_image) with truth at the pixel centres. A
/// pixel is excused if is_disputed() says so of its owner and truth's triangle. Throws
/// std::logic_error if the sizes differ. O(pixels), and a dispute for each that differs.
SurfaceVerdict judge_surface(const Frame& frame, const Scene& scene, const FrameTruth& truth,
                             std::span<const TriangleId> owners);

/// By pixel: 1 where judge_surface() counts a wrong one, else 0.
std::vector<std::uint8_t> wrong_surface_pixels(const Frame& frame, const Scene& scene,
                                               const FrameTruth& truth,
                                               std::span<const TriangleId> owners);

}  // namespace vislab
