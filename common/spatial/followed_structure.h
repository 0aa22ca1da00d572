// A spatial structure that follows a scene's changes from frame to frame.
#pragma once

#include <cstdint>
#include <vector>

#include "common/scene/frame.h"
#include "common/spatial/spatial_structure.h"

namespace vislab {

/// A spatial structure that holds exactly the objects that are shown, where they lie now.
template <typename Structure>
class FollowedStructure {
 public:
  explicit FollowedStructure(const typename Structure::Limits& limits) : structure_(limits) {}

  const Structure& structure() const { return structure_; }
  /// Is the object shown? One whose box is not valid is held too, unplaced.
  bool holds(ObjectId object) const { return is_in_[object] != 0; }

  /// The scene outlives this.
  void build(const Scene& scene) {
    scene_ = &scene;
    build_as_loaded();
  }

  /// Back to the scene as built. False if it is so already.
  bool reset() {
    if (!changed_) return false;
    build_as_loaded();
    return true;
  }

  /// What is in `changes` moves, comes and goes. False if nothing of it concerns the structure.
  bool update(const Frame& frame, const Changes& changes) {
    if (changes.empty()) return false;
    for (const ObjectId object : changes.hidden) {
      if (is_in_[object] == 0) continue;
      structure_.remove(object);
      is_in_[object] = 0;
    }
    for (const ObjectId object : changes.moved) {
      if (is_in_[object] != 0) structure_.move(object, frame.objects.bounds[object]);
    }
    for (const ObjectId object : changes.shown) {
      if (is_in_[object] != 0) continue;
      structure_.insert(object, frame.objects.bounds[object]);
      is_in_[object] = 1;
    }
    structure_.finish_changes();
    changed_ = true;
    return true;
  }

  std::size_t bytes() const { return structure_.bytes() + is_in_.capacity(); }

 private:
  void build_as_loaded() {
    std::vector<Aabb> boxes;
    boxes.reserve(scene_->object_count());
    for (ObjectId object = 0; object < scene_->object_count(); ++object) {
      boxes.push_back(
          transformed(scene_->mesh_of(object).bounds, scene_->objects[object].transform));
    }
    structure_.build(boxes);
    is_in_.assign(boxes.size(), 1);
    changed_ = false;
  }

  Structure structure_;
  const Scene* scene_ = nullptr;
  std::vector<std::uint8_t> is_in_;  // by object
  bool changed_ = false;             // since the scene was as built
};

}  // namespace vislab
