// One moment of a scene: where the objects are, which are shown, and who looks at them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/camera.h"
#include "common/scene/scene.h"

namespace vislab {

/// What differs between a frame and the one before it. Ids are sorted and unique.
struct Changes {
  std::vector<ObjectId> moved;           // got a new transform
  std::vector<glm::dmat4x3> transforms;  // of `moved`, in the same order
  std::vector<ObjectId> shown;           // were hidden, or are new
  std::vector<ObjectId> hidden;          // are no longer candidates; removed objects stay hidden

  bool empty() const { return moved.empty() && shown.empty() && hidden.empty(); }
};

/// A view of all objects at one moment; never a copy. Valid until the state changes.
struct ObjectsView {
  std::span<const glm::dmat4x3> transforms;  // by object id, hidden ones included
  std::span<const Aabb> bounds;              // world boxes by object id, rounded outward
  std::span<const ObjectId> shown;           // ascending ids of the objects that are candidates
};

/// The objects' transforms, boxes and visibility as they change along a path.
class SceneState {
 public:
  explicit SceneState(const Scene& scene);  // the scene outlives the state

  /// Back to the scene as built: everything shown, original transforms.
  void reset();
  /// Throws InputError for ids out of range or order, singular transforms, objects
  /// shown that are shown already, or hidden that are hidden; the state is then as it was.
  /// O(changes), plus O(objects) if anything is shown or hidden.
  void apply(const Changes& changes);

  const Scene& scene() const { return *scene_; }
  ObjectsView view() const { return {transforms_, bounds_, shown_}; }

 private:
  const Scene* scene_;
  std::vector<glm::dmat4x3> transforms_;
  std::vector<Aabb> bounds_;
  std::vector<std::uint8_t> is_shown_;
  std::vector<ObjectId> shown_;
};

/// A picture to be taken: what a culler, a device and the judge are given.
struct Frame {
  std::uint64_t index = 0;  // counts along a path from 0; cullers key their per-frame state on it
  Camera camera;
  Viewport viewport;
  ObjectsView objects;
  double last_frame_ms =
      0.0;  // how long the frame before took, as the harness measured it; 0 first
};

/// Consecutive triangles of one object: indices into its mesh.
struct TriangleRange {
  ObjectId object = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;

  friend bool operator==(const TriangleRange&, const TriangleRange&) = default;
};

}  // namespace vislab
