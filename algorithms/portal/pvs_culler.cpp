#include "algorithms/portal/pvs_culler.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "algorithms/portal/closing_objects.h"
#include "common/geometry/frustum.h"

namespace vislab::portal_culling {
namespace {

bool outside(const Frustum& frustum, const Aabb& box) {
  return std::ranges::any_of(frustum.span(),
                             [&](const Plane& plane) { return surely_outside(plane, box); });
}

}  // namespace

void ObjectsByPlace::assign(std::size_t places,
                            std::vector<std::pair<std::uint32_t, ObjectId>> pairs) {
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  first.assign(places + 1, 0);
  objects.clear();
  objects.reserve(pairs.size());
  for (const auto& [place, object] : pairs) {
    ++first[place + 1];
    objects.push_back(object);
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
}

void PvsCuller::build(const Scene& scene, const BuildContext& context) {
  scene_ = &scene;
  objects_ = build_sets(scene, context);
  const std::size_t places = objects_.first.empty() ? 0 : objects_.first.size() - 1;
  lies_in_a_place_.assign(scene.object_count(), 0);
  for (const ObjectId object : objects_.objects) lies_in_a_place_[object] = 1;
  is_closing_ = find_closing_objects(scene);
  is_hidden_.assign(scene.object_count(), 0);
  gaps_.clear();
  gaps_.reserve(scene.object_count());
  is_free_.resize(scene.object_count());
  any_moved_ = true;
  reset(0);
  seen_.assign(words_for(places), 0);
  marked_places_ = seen_;
  marked_.assign(scene.object_count(), 0);
  kept_.clear();
  kept_.reserve(scene.object_count());
}

void PvsCuller::reset(std::uint64_t) {
  // So that the first frame counts as it did before.
  std::ranges::fill(marked_places_, std::uint64_t{0});
  std::ranges::fill(marked_, std::uint8_t{0});
  std::ranges::fill(is_hidden_, std::uint8_t{0});
  gaps_.clear();
  if (!any_moved_) return;
  for (std::size_t i = 0; i < is_free_.size(); ++i) is_free_[i] = lies_in_a_place_[i] ? 0 : 1;
  any_moved_ = false;
}

void PvsCuller::update(const Frame& frame, const Changes& changes) {
  for (const ObjectId object : changes.moved) {
    const bool away = is_away(frame, object);
    is_free_[object] = away || !lies_in_a_place_[object] ? 1 : 0;
    set_gap(object, is_hidden_[object] != 0, away);
  }
  for (const ObjectId object : changes.hidden) set_gap(object, true, is_away(frame, object));
  for (const ObjectId object : changes.shown) set_gap(object, false, is_away(frame, object));
  any_moved_ = any_moved_ || !changes.moved.empty();
  const SetSizes sizes = set_sizes();
  set_bytes_ += sizes.stored;
  set_raw_bytes_ += sizes.raw;
}

bool PvsCuller::is_away(const Frame& frame, ObjectId object) const {
  return frame.objects.transforms[object] != scene_->objects[object].transform;
}

void PvsCuller::set_gap(ObjectId object, bool is_hidden, bool is_away) {
  is_hidden_[object] = is_hidden ? 1 : 0;
  if (is_closing_[object] == 0) return;
  std::erase(gaps_, object);
  if (is_hidden || is_away) gaps_.push_back(object);
}

/// Marks the objects of the places seen. Most frames see what the one before saw.
void PvsCuller::mark() {
  if (seen_ == marked_places_) return;
  std::ranges::fill(marked_, std::uint8_t{0});
  for (std::size_t word = 0; word < seen_.size(); ++word) {
    for (std::uint64_t bits = seen_[word]; bits != 0; bits &= bits - 1) {
      const std::size_t place = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
      for (const ObjectId object : objects_.of(place)) marked_[object] = 1;
    }
  }
  marked_places_ = seen_;
  ++sets_changed_;
}

void PvsCuller::cull(const Frame& frame, const Candidates& candidates, DrawSink& out) {
  std::ranges::fill(seen_, std::uint64_t{0});
  bool inside = add_seen(frame.camera, seen_);
  if (inside) {
    mark();
    inside = std::ranges::none_of(gaps_, [&](ObjectId wall) { return marked_[wall] != 0; });
  }
  if (!inside) ++frames_outside_;
  const Frustum frustum = frustum_of(frame.camera);
  kept_.clear();
  for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
    for (const ObjectId object : run) {
      if (inside && !marked_[object] && !is_free_[object]) continue;
      ++objects_tested_;
      if (!outside(frustum, frame.objects.bounds[object])) kept_.push_back(object);
    }
  });
  out.objects(kept_);
}

bool PvsCuller::region(CellId cell, DrawSink& out) {
  std::ranges::fill(seen_, std::uint64_t{0});
  if (!add_seen_from(cell, seen_)) return false;
  mark();
  kept_.clear();
  for (ObjectId object = 0; object < marked_.size(); ++object) {
    if (marked_[object] || is_free_[object]) kept_.push_back(object);
  }
  out.objects(kept_);
  return true;
}

std::size_t PvsCuller::bytes() const {
  return bytes_of_sets() + objects_.first.capacity() * sizeof(std::uint32_t) +
         objects_.objects.capacity() * sizeof(ObjectId) + lies_in_a_place_.capacity() +
         is_free_.capacity() + marked_.capacity() + is_closing_.capacity() + is_hidden_.capacity() +
         gaps_.capacity() * sizeof(ObjectId) +
         (seen_.capacity() + marked_places_.capacity()) * sizeof(std::uint64_t) +
         kept_.capacity() * sizeof(ObjectId);
}

Counters PvsCuller::counters() const {
  return {{"objects_tested", objects_tested_},
          {"sets_changed", sets_changed_},
          {"frames_outside", frames_outside_},
          {"set_bytes", set_bytes_},
          {"set_raw_bytes", set_raw_bytes_}};
}

}  // namespace vislab::portal_culling
