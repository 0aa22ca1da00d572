#include "common/judge/surface_judge.h"

#include <stdexcept>

#include "common/judge/disputed.h"

namespace vislab {

SurfaceVerdict judge_surface(const Frame& frame, const Scene& scene, const FrameTruth& truth,
                             std::span<const TriangleId> owners) {
  if (owners.size() != truth.ids.size()) {
    throw std::logic_error("an image of another size than truth's was handed to the judge");
  }
  SurfaceVerdict verdict;
  Disputes disputes(frame, scene);
  const auto width = static_cast<std::size_t>(truth.viewport.width);
  for (std::size_t i = 0; i < owners.size(); ++i) {
    if (owners[i] == truth.ids[i]) continue;
    const glm::dvec2 window_px(static_cast<double>(i % width) + 0.5,
                               static_cast<double>(i / width) + 0.5);
    const bool excused = disputes(window_px, owners[i], truth.ids[i]);
    ++(excused ? verdict.disputed_surface_px : verdict.surface_px);
  }
  return verdict;
}

}  // namespace vislab
