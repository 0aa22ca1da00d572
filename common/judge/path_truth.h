// Truth of all frames of a path, as the oracles and the judge use it.
#pragma once

#include <functional>
#include <vector>

#include "common/culler/culler.h"
#include "common/culler/ray_probe.h"
#include "common/judge/truth.h"
#include "common/scene/path.h"

namespace vislab {

/// Triangles of a frame that are seen, in the forms that oracles ask for.
struct SeenParts {
  std::vector<ObjectId> objects;
  std::vector<TriangleRange> triangles;
};

/// `seen` is ascending. O(seen log objects).
SeenParts seen_parts(const Scene& scene, std::span<const TriangleId> seen);

/// Truth frame by frame, with the visible objects and triangles that the oracles ask for. Spans and
/// references stay valid until the next add().
class PathTruth : public ProbingTruth {
 public:
  /// The scene outlives this.
  explicit PathTruth(const Scene& scene) : scene_(&scene) {}

  /// Adds the truth of the next frame, which gets the next index, from 0. O(pixels + visible).
  void add(FrameTruth truth);

  std::size_t frame_count() const { return frames_.size(); }
  const FrameTruth& frame(std::uint64_t index) const { return frames_.at(index).truth; }

  std::span<const ObjectId> visible_objects(std::uint64_t frame_index) const override {
    return frames_.at(frame_index).parts.objects;
  }
  std::span<const TriangleRange> visible_triangles(std::uint64_t frame_index) const override {
    return frames_.at(frame_index).parts.triangles;
  }
  /// By one thread; 0.3 microseconds a ray, twice that for lattices and where every nearest
  /// triangle is asked for.
  std::unique_ptr<RayProbe> probe(const RaySampling& sampling) const override;

 private:
  struct Entry {
    FrameTruth truth;
    SeenParts parts;
  };
  const Scene* scene_;
  std::vector<Entry> frames_;
};

/// Truth of a path: frames that `store` has are loaded, the others are traced by `caster` and saved
/// (null: all are traced, none is saved). `settings` are the caster's. `progress`, if any, is
/// called after each frame with the number of frames done. Throws InputError if the store cannot be
/// written.
PathTruth trace_path(const Path& path, const Viewport& viewport, const TruthSettings& settings,
                     RayCaster& caster, const TruthStore* store,
                     const std::function<void(std::size_t)>& progress = {});

}  // namespace vislab
