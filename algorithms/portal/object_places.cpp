#include "algorithms/portal/object_places.h"

#include <algorithm>

#include "algorithms/portal/closing_objects.h"

namespace vislab::portal_culling {

void ObjectPlaces::build(const Scene& scene, const PortalGraph& graph) {
  scene_ = &scene;
  graph_ = &graph;
  state_ = find_closing_objects(scene);
  for (std::uint8_t& state : state_) state = state != 0 ? is_closing : std::uint8_t{0};
  const SceneState home(scene);
  home_boxes_.assign(home.view().bounds.begin(), home.view().bounds.end());
  gap_count_ = 0;
  cells_of_.assign(scene.object_count(), {});
  visitors_.assign(graph.cell_count() + 1, {});
  changed_ = false;
}

void ObjectPlaces::reset() {
  if (!changed_) return;
  for (std::uint8_t& state : state_) state &= is_closing;
  gap_count_ = 0;
  for (auto& cells : cells_of_) cells.clear();
  for (auto& objects : visitors_) objects.clear();
  changed_ = false;
}

void ObjectPlaces::update(const Frame& frame, const Changes& changes) {
  if (changes.empty()) return;
  changed_ = true;
  for (const ObjectId object : changes.hidden) set_state(object, is_hidden, true);
  for (const ObjectId object : changes.shown) set_state(object, is_hidden, false);
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
  set_state(object, is_away, false);
}

void ObjectPlaces::set_state(ObjectId object, std::uint8_t bit, bool is_set) {
  gap_count_ -= leaves_gap(object) ? 1 : 0;
  state_[object] = static_cast<std::uint8_t>(is_set ? state_[object] | bit : state_[object] & ~bit);
  gap_count_ += leaves_gap(object) ? 1 : 0;
}

void ObjectPlaces::put(ObjectId object, const Aabb& box) {
  std::vector<CellId>& cells = cells_of_[object];
  if (box.valid()) graph_->cells_of(box, cells);
  if (cells.empty()) cells.push_back(static_cast<CellId>(graph_->cell_count()));
  for (const CellId cell : cells) {
    std::vector<ObjectId>& visitors = visitors_[cell];
    visitors.insert(std::ranges::lower_bound(visitors, object), object);
  }
  set_state(object, is_away, true);
}

std::size_t ObjectPlaces::bytes() const {
  std::size_t total = state_.capacity() + home_boxes_.capacity() * sizeof(Aabb);
  const auto add = [&](const std::vector<std::vector<std::uint32_t>>& lists) {
    total += lists.capacity() * sizeof(lists[0]);
    for (const auto& list : lists) total += list.capacity() * sizeof(std::uint32_t);
  };
  add(cells_of_);
  add(visitors_);
  return total;
}

}  // namespace vislab::portal_culling
