// Which objects lie in a cell now: where the scene puts them, until they move; then by their boxes.
//
// An object that comes back to where the scene has it is where the scene puts it again, so that
// nothing depends on where objects were before.
// Where something that closes cells is hidden or away (closing_objects.h), portals no longer tell
// what is seen through its place.
// Cost of a moved object: a search in the tree of regions, and its place in the lists of the cells
//   that it leaves and enters.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/portal/portal_graph.h"

namespace vislab::portal_culling {

class ObjectPlaces {
 public:
  /// Scene and graph outlive this.
  void build(const Scene& scene, const PortalGraph& graph);
  /// Everything is as the scene has it.
  void reset();
  void update(const Frame& frame, const Changes& changes);

  bool shown(ObjectId object) const { return (state_[object] & is_hidden) == 0; }
  /// Calls act(ObjectId) for all that lie in the cell, hidden ones too.
  template <typename Act>
  void for_each_in(CellId cell, Act&& act) const {
    for_each_home(graph_->objects_of(cell), act);
    for (const ObjectId object : visitors_[cell]) act(object);
  }
  /// Those that lie in no cell.
  template <typename Act>
  void for_each_free(Act&& act) const {
    for_each_home(graph_->free_objects(), act);
    for (const ObjectId object : visitors_.back()) act(object);
  }

  /// Calls act(box) for the places in the cell that something which closed it has left.
  template <typename Act>
  void for_each_gap(CellId cell, Act&& act) const {
    if (gap_count_ == 0) return;
    for (const ObjectId object : graph_->objects_of(cell)) {
      if (leaves_gap(object)) act(home_boxes_[object]);
    }
  }

  std::size_t bytes() const;

 private:
  static constexpr std::uint8_t is_hidden = 1;
  static constexpr std::uint8_t is_away = 2;
  static constexpr std::uint8_t is_closing = 4;

  bool leaves_gap(ObjectId object) const {
    return (state_[object] & is_closing) != 0 && (state_[object] & (is_hidden | is_away)) != 0;
  }
  void set_state(ObjectId object, std::uint8_t bit, bool is_set);

  template <typename Act>
  void for_each_home(std::span<const ObjectId> objects, Act& act) const {
    for (const ObjectId object : objects) {
      if ((state_[object] & is_away) == 0) act(object);
    }
  }
  void bring_home(ObjectId object);
  void put(ObjectId object, const Aabb& box);

  const Scene* scene_ = nullptr;
  const PortalGraph* graph_ = nullptr;
  std::vector<std::uint8_t> state_;              // by object
  std::vector<Aabb> home_boxes_;                 // by object: where the scene puts it
  std::size_t gap_count_ = 0;                    // objects that leave one
  std::vector<std::vector<CellId>> cells_of_;    // by object: those away
  std::vector<std::vector<ObjectId>> visitors_;  // by cell, then those in none; ascending
  bool changed_ = false;                         // since the scene was as built
};

}  // namespace vislab::portal_culling
