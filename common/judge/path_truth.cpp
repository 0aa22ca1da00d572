#include "common/judge/path_truth.h"

#include "common/judge/ray_probes.h"

namespace vislab {

SeenParts seen_parts(const Scene& scene, std::span<const TriangleId> seen) {
  SeenParts parts;
  ObjectId object = none_id;
  for (const TriangleId id : seen) {
    if (object == none_id || id - scene.first_triangle(object) >= scene.triangle_count(object)) {
      object = scene.object_of(id);
      parts.objects.push_back(object);
    }
    const std::uint32_t triangle = id - scene.first_triangle(object);
    if (!parts.triangles.empty()) {
      TriangleRange& last = parts.triangles.back();
      if (last.object == object && last.first + last.count == triangle) {
        ++last.count;
        continue;
      }
    }
    parts.triangles.push_back({object, triangle, 1});
  }
  return parts;
}

void PathTruth::add(FrameTruth truth) {
  SeenParts parts = seen_parts(*scene_, truth.visible());
  frames_.push_back({std::move(truth), std::move(parts)});
}

std::unique_ptr<RayProbe> PathTruth::probe(const RaySampling& sampling) const {
  return make_ray_probe(*scene_, sampling);
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
