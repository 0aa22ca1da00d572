#include "algorithms/portal/object_places.h"

#include <algorithm>

namespace vislab::portal_culling {

void ObjectPlaces::build(const Scene& scene, const PortalGraph& graph) {
  scene_ = &scene;
  graph_ = &graph;
  state_.assign(scene.object_count(), 0);
  cells_of_.assign(scene.object_count(), {});
  visitors_.assign(graph.cell_count() + 1, {});
  changed_ = false;
}

void ObjectPlaces::reset() {
  if (!changed_) return;
  std::ranges::fill(state_, std::uint8_t{0});
  for (auto& cells : cells_of_) cells.clear();
  for (auto& objects : visitors_) objects.clear();
  changed_ = false;
}

void ObjectPlaces::update(const Frame& frame, const Changes& changes) {
  if (changes.empty()) return;
  changed_ = true;
  for (const ObjectId object : changes.hidden) state_[object] |= is_hidden;
  for (const ObjectId object : changes.shown) {
    state_[object] = static_cast<std::uint8_t>(state_[object] & ~is_hidden);
  }
  for (const ObjectId object : changes.moved) {
    bring_home(object);
    if (frame.objects.transforms[object] != scene_->objects[object].transform) {
      put(object, frame.objects.bounds[object]);
    }
  }
}

void ObjectPlaces::bring_home(ObjectId object) {
  for (const CellId cell : cells_of_[object]) {
    std::vector<ObjectId>& visitors = visitors_[cell];
    visitors.erase(std::ranges::lower_bound(visitors, object));
  }
  cells_of_[object].clear();
  state_[object] = static_cast<std::uint8_t>(state_[object] & ~is_away);
}

void ObjectPlaces::put(ObjectId object, const Aabb& box) {
  std::vector<CellId>& cells = cells_of_[object];
  if (box.valid()) graph_->cells_of(box, cells);
  if (cells.empty()) cells.push_back(static_cast<CellId>(graph_->cell_count()));
  for (const CellId cell : cells) {
    std::vector<ObjectId>& visitors = visitors_[cell];
    visitors.insert(std::ranges::lower_bound(visitors, object), object);
  }
  state_[object] |= is_away;
}

std::size_t ObjectPlaces::bytes() const {
  std::size_t total = state_.capacity();
  const auto add = [&](const std::vector<std::vector<std::uint32_t>>& lists) {
    total += lists.capacity() * sizeof(lists[0]);
    for (const auto& list : lists) total += list.capacity() * sizeof(std::uint32_t);
  };
  add(cells_of_);
  add(visitors_);
  return total;
}

}  // namespace vislab::portal_culling
