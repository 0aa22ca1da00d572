#include "common/judge/path_truth.h"

namespace vislab {

void PathTruth::add(FrameTruth truth) {
  Entry& entry = frames_.emplace_back();
  entry.truth = std::move(truth);
  ObjectId object = none_id;
  for (const TriangleId id : entry.truth.visible()) {
    if (object == none_id ||
        id - scene_->first_triangle(object) >= scene_->triangle_count(object)) {
      object = scene_->object_of(id);
      entry.objects.push_back(object);
    }
    const std::uint32_t triangle = id - scene_->first_triangle(object);
    if (!entry.triangles.empty()) {
      TriangleRange& last = entry.triangles.back();
      if (last.object == object && last.first + last.count == triangle) {
        ++last.count;
        continue;
      }
    }
    entry.triangles.push_back({object, triangle, 1});
  }
}

PathTruth trace_path(const Path& path, const Viewport& viewport, const TruthSettings& settings,
                     RayCaster& caster, const TruthStore* store,
                     const std::function<void(std::size_t)>& progress) {
  PathTruth truth(caster.scene());
  SceneState state(caster.scene());
  Frame frame;
  frame.viewport = viewport;
  for (const PathFrame& step : path.frames) {
    state.apply(step.changes);
    frame.camera = step.camera;
    frame.objects = state.view();
    std::optional<FrameTruth> found;
    std::string key;
    if (store != nullptr) {
      key = truth_key(frame, caster.scene(), settings);
      found = store->load(key);
    }
    if (!found) {
      found = caster.trace(frame);
      if (store != nullptr) store->save(key, *found);
    }
    truth.add(std::move(*found));
    ++frame.index;
    if (progress) progress(frame.index);
  }
  return truth;
}

}  // namespace vislab
