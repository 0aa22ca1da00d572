#include "algorithms/surface/surface_culler.h"

namespace vislab::surface {

void SurfaceCuller::build(const Scene& scene, const BuildContext&) {
  scene_ = &scene;
  owns_.assign(scene.triangle_count(), 0);
  prepare();
}

void SurfaceCuller::cull(const Frame& frame, const Candidates& candidates, DrawSink& out) {
  image_.clear(frame.viewport);
  paint(frame, candidates);
  for (const TriangleId owner : image_.owners()) {
    if (owner != none_id) owns_[owner] = 1;
  }
  kept_.clear();
  for_each_range(candidates, frame, *scene_, [&](const TriangleRange& range) {
    const TriangleId first = scene_->first_triangle(range.object);
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
      if (owns_[first + i] == 0) continue;
      if (!kept_.empty() && kept_.back().object == range.object &&
          kept_.back().first + kept_.back().count == i) {
        ++kept_.back().count;
      } else {
        kept_.push_back({range.object, i, 1});
      }
    }
  });
  for (const TriangleId owner : image_.owners()) {
    if (owner != none_id) owns_[owner] = 0;
  }
  order(kept_);
  out.ranges(kept_);
}

std::size_t SurfaceCuller::bytes() const {
  return image_.bytes() + owns_.capacity() + kept_.capacity() * sizeof(TriangleRange) + own_bytes();
}

}  // namespace vislab::surface
