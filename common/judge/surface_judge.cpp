#include "common/judge/surface_judge.h"

#include <stdexcept>

#include "common/judge/disputed.h"

namespace vislab {

namespace {

/// Calls f(pixel, excused) for every pixel that differs.
template <typename Function>
void for_each_difference(const Frame& frame, const Scene& scene, const FrameTruth& truth,
                         std::span<const TriangleId> owners, Function&& f) {
  if (owners.size() != truth.ids.size()) {
    throw std::logic_error("an image of another size than truth's was handed to the judge");
  }
  Disputes disputes(frame, scene);
  const auto width = static_cast<std::size_t>(truth.viewport.width);
  for (std::size_t i = 0; i < owners.size(); ++i) {
    if (owners[i] == truth.ids[i]) continue;
    const glm::dvec2 window_px(static_cast<double>(i % width) + 0.5,
                               static_cast<double>(i / width) + 0.5);
    f(i, disputes(window_px, owners[i], truth.ids[i]));
  }
}

}  // namespace

SurfaceVerdict judge_surface(const Frame& frame, const Scene& scene, const FrameTruth& truth,
                             std::span<const TriangleId> owners) {
  SurfaceVerdict verdict;
  for_each_difference(frame, scene, truth, owners, [&](std::size_t, bool excused) {
    ++(excused ? verdict.disputed_surface_px : verdict.surface_px);
  });
  return verdict;
}

std::vector<std::uint8_t> wrong_surface_pixels(const Frame& frame, const Scene& scene,
                                               const FrameTruth& truth,
                                               std::span<const TriangleId> owners) {
  std::vector<std::uint8_t> wrong(owners.size(), 0);
  for_each_difference(frame, scene, truth, owners, [&](std::size_t pixel, bool excused) {
    if (!excused) wrong[pixel] = 1;
  });
  return wrong;
}

}  // namespace vislab
