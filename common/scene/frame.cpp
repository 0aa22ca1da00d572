#include "common/scene/frame.h"

#include <algorithm>

#include "common/scene/error.h"
#include "common/scene/transform.h"

namespace vislab {
namespace {

/// Throws unless `ids` are ascending, unique and in range.
void require_ids(const std::vector<ObjectId>& ids, std::size_t count, const std::string& what) {
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] >= count) {
      throw InputError("changes, " + what + ": object " + std::to_string(ids[i]) +
                       " is out of range; the scene has " + std::to_string(count));
    }
    if (i > 0 && ids[i] <= ids[i - 1]) {
      throw InputError("changes, " + what + ": ids must be ascending and unique, but " +
                       std::to_string(ids[i]) + " follows " + std::to_string(ids[i - 1]));
    }
  }
}

}  // namespace

SceneState::SceneState(const Scene& scene) : scene_(&scene) { reset(); }

void SceneState::reset() {
  const std::size_t count = scene_->object_count();
  transforms_.resize(count);
  bounds_.resize(count);
  is_shown_.assign(count, 1);
  shown_.resize(count);
  for (ObjectId id = 0; id < count; ++id) {
    transforms_[id] = scene_->objects[id].transform;
    bounds_[id] = transformed(scene_->mesh_of(id).bounds, transforms_[id]);
    shown_[id] = id;
  }
}

void SceneState::apply(const Changes& changes) {
  // Everything is checked before anything changes, so that a refused change leaves the state whole.
  const std::size_t count = scene_->object_count();
  require_ids(changes.moved, count, "moved");
  require_ids(changes.shown, count, "shown");
  require_ids(changes.hidden, count, "hidden");
  if (changes.moved.size() != changes.transforms.size()) {
    throw InputError("changes: " + std::to_string(changes.moved.size()) + " objects moved, but " +
                     std::to_string(changes.transforms.size()) + " transforms are given");
  }
  for (std::size_t i = 0; i < changes.moved.size(); ++i) {
    require_placing_transform(changes.transforms[i],
                              "changes, object " + std::to_string(changes.moved[i]));
  }
  for (const ObjectId id : changes.shown) {
    if (is_shown_[id] != 0) {
      throw InputError("changes: object " + std::to_string(id) + " is shown already");
    }
  }
  for (const ObjectId id : changes.hidden) {
    if (is_shown_[id] == 0) {
      throw InputError("changes: object " + std::to_string(id) + " is hidden already");
    }
  }

  for (std::size_t i = 0; i < changes.moved.size(); ++i) {
    const ObjectId id = changes.moved[i];
    transforms_[id] = changes.transforms[i];
    bounds_[id] = transformed(scene_->mesh_of(id).bounds, transforms_[id]);
  }
  if (changes.shown.empty() && changes.hidden.empty()) return;
  for (const ObjectId id : changes.shown) is_shown_[id] = 1;
  for (const ObjectId id : changes.hidden) is_shown_[id] = 0;
  shown_.clear();
  for (ObjectId id = 0; id < count; ++id) {
    if (is_shown_[id] != 0) shown_.push_back(id);
  }
}

}  // namespace vislab
