#include "common/judge/stability.h"

#include <algorithm>

namespace vislab {

ObjectVisibility object_visibility(const Scene& scene, const FrameTruth& truth) {
  ObjectVisibility result;
  result.pixels.assign(scene.object_count(), 0);
  result.visible.assign(scene.object_count(), 0);
  // Neighbouring samples mostly hit the same object.
  ObjectId object = 0;
  const auto find = [&](TriangleId triangle) {
    const TriangleId first = scene.first_triangle(object);
    if (triangle < first || triangle - first >= scene.triangle_count(object)) {
      object = scene.object_of(triangle);
    }
    return object;
  };
  for (const TriangleId id : truth.ids) {
    if (id == none_id) continue;
    ++result.pixels[find(id)];
    result.visible[object] = 1;
  }
  for (const TriangleHits& hit : truth.hits) result.visible[find(hit.triangle)] = 1;
  return result;
}

StabilityJudge::StabilityJudge(const Scene& scene) : scene_(&scene), past_(scene.object_count()) {}

void StabilityJudge::add(const ObjectVisibility& truth, const VisibleSet& kept) {
  for (ObjectId object = 0; object < past_.size(); ++object) {
    Past& past = past_[object];
    const bool is_kept =
        kept.intersects(scene_->first_triangle(object), scene_->triangle_count(object));
    const bool is_visible = truth.visible[object] != 0;
    const bool owns_pixels = truth.pixels[object] > 0;
    if (!first_ && is_kept != past.kept && is_visible == past.visible) ++verdict_.toggles;
    const bool appeared = owns_pixels && (first_ || !past.owned_pixels);
    if (is_kept || !owns_pixels || (past.missing_frames == 0 && !appeared)) {
      past.missing_frames = 0;
    } else {
      ++past.missing_frames;
      verdict_.pop_px_frames += truth.pixels[object];
      verdict_.latency_frames =
          std::max<std::uint64_t>(verdict_.latency_frames, past.missing_frames);
    }
    past.kept = is_kept;
    past.visible = is_visible;
    past.owned_pixels = owns_pixels;
  }
  first_ = false;
}

}  // namespace vislab
