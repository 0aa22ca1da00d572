// What occlusion.chc and occlusion.chcpp share: a front-to-back walk over a hierarchy of
// queries, in which the method decides node by node whether to open, draw or ask about it.
//
// Idea: what waits is a heap by distance from the eye. A node that is surely outside of the
//   view is dropped with all below it; planes that a node is surely inside of are not asked
//   about again.
// Guarantee: nothing is drawn twice in a frame and nothing that was not offered; objects whose
//   box is not valid are drawn. What the method opens or draws is complete.
// Cost: O(log n) for each node that waits, up to six plane tests a node.
// Limits: nodes that overlap are ordered by their nearest points only.
// Sources: Bittner et al. 2004, section 4; Assarsson and Moeller 2000 (planes that need no
//   test).
#pragma once

#include <cstdint>
#include <vector>

#include "common/culler/culler.h"
#include "common/culler/stamps.h"
#include "common/geometry/frustum.h"
#include "common/spatial/query_hierarchy.h"

namespace vislab::occlusion_culling {

class NodeWalk {
 public:
  using NodeIndex = QueryHierarchy::NodeIndex;
  /// A node to decide about.
  struct Visit {
    NodeIndex node = 0;
    std::uint32_t planes = 0;  // bits: those of the frustum that it may be cut by
  };

  explicit NodeWalk(std::uint32_t leaf_triangles) : hierarchy_(leaf_triangles) {}

  void build(const Scene& scene);
  bool reset() { return hierarchy_.reset(); }
  void update(const Frame& frame, const Changes& changes) { hierarchy_.update(frame, changes); }
  const QueryHierarchy& hierarchy() const { return hierarchy_; }

  enum class Order { near_first, any };

  /// At the start of cull(): only the root waits, and objects that no node holds are drawn.
  void start(const Frame& frame, const Candidates& candidates, Order order = Order::near_first);
  /// Takes a node, the nearest if the order says so, that may be in the view and holds something
  /// that is offered. False if none waits.
  bool next(Visit& visit);
  /// The node's children wait. Only for nodes that are no units.
  void open(const Visit& visit);
  /// What is offered of a unit and may be in the view is kept. Returns how many triangles.
  std::uint64_t draw(const Visit& visit);

  /// What a walk goes by (box_queries.h).
  double nearness(NodeIndex node) const;

  /// Emits what was kept since the last time. False if there was nothing.
  bool hand_over(DrawSink& out);
  /// Objects kept since start().
  std::size_t kept_count() const { return kept_.size(); }

  std::uint64_t nodes_visited() const { return nodes_visited_; }
  std::size_t bytes() const;

 private:
  struct Item {
    double nearness;
    Visit visit;
  };

  void take(const Candidates& candidates);
  void push(NodeIndex node, std::uint32_t planes);
  bool outside(const Aabb& box, std::uint32_t& planes) const;
  bool offered(ObjectId object) const { return everything_ || offered_.contains(object); }
  static bool later(const Item& a, const Item& b) {
    return a.nearness != b.nearness ? a.nearness > b.nearness : a.visit.node > b.visit.node;
  }

  QueryHierarchy hierarchy_;
  const Scene* scene_ = nullptr;
  const Frame* frame_ = nullptr;  // of the call of cull()
  Frustum frustum_;
  Order order_ = Order::near_first;
  std::vector<Item> heap_;  // a stack, if any order will do
  std::vector<ObjectId> kept_;
  std::size_t handed_over_ = 0;  // of kept_

  bool everything_ = true;
  ObjectStamps offered_;                      // unless it is everything
  std::vector<std::uint32_t> offered_below_;  // by node: the call that marked it
  std::uint32_t call_ = 0;

  std::uint64_t nodes_visited_ = 0;
};

}  // namespace vislab::occlusion_culling
