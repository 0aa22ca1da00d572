// Runs one culler on one moment of a scene. Test-only.
#pragma once

#include <algorithm>
#include <memory>
#include <numbers>

#include "algorithms/all_cullers.h"
#include "common/culler/visible_set.h"

namespace vislab {

inline double degrees(double value) { return value * std::numbers::pi / 180.0; }

inline Camera camera_at(const glm::dvec3& eye, const glm::dvec3& target) {
  return {look_at(eye, target), perspective_lens(degrees(60.0), 1.0, 0.1, 200.0)};
}

/// A culler, built for a scene, and the scene's state.
class CullerRun {
 public:
  CullerRun(const std::string& spec, const Scene& scene, BuildContext context = {})
      : scene_(&scene), state_(scene) {
    register_all_cullers(registry_);
    culler_ = registry_.make(spec);
    context.cullers = &registry_;
    culler_->build(scene, context);
    culler_->reset(1);
  }

  ICuller& culler() { return *culler_; }

  Frame frame(const Camera& camera, const Viewport& viewport = {64, 64}) const {
    return {index_, camera, viewport, state_.view(), 0.0};
  }

  /// Applies changes and calls update().
  void update(const Camera& camera, const Changes& changes) {
    state_.apply(changes);
    culler_->update(frame(camera), changes);
  }

  /// Back to the scene as built.
  void reset() {
    state_.reset();
    culler_->reset(1);
  }

  /// What it emits, in order.
  std::vector<TriangleRange> emitted(const Camera& camera,
                                     const Candidates& candidates = Candidates::everything()) {
    const Frame now = frame(camera);
    sink_.start(*scene_, now);
    culler_->cull(now, candidates, sink_);
    ++index_;
    return sink_.emitted();
  }

  /// The objects that it emits something of, in the order of emission.
  std::vector<ObjectId> objects(const Camera& camera,
                                const Candidates& candidates = Candidates::everything()) {
    std::vector<ObjectId> ids;
    for (const TriangleRange& range : emitted(camera, candidates)) {
      if (ids.empty() || ids.back() != range.object) ids.push_back(range.object);
    }
    return ids;
  }

  std::uint64_t counter(std::string_view name) const {
    for (const auto& [known, count] : culler_->counters()) {
      if (known == name) return count;
    }
    throw std::logic_error("no counter is called " + std::string(name));
  }

 private:
  Registry registry_;
  const Scene* scene_;
  SceneState state_;
  std::unique_ptr<ICuller> culler_;
  RecordingSink sink_;
  std::uint64_t index_ = 0;
};

}  // namespace vislab
