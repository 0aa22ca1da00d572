// The walk through portals that all variants share.
//
// Idea: the image's rays begin in the start cells, with the whole view. Every portal that leads out
//   of a cell and shows its other side in what is left of the view is gone through, with what is
//   left of the view behind it, to the cell beyond, depth first. What remains of a view behind a
//   portal, and what that shows, is the variant's rule.
// Guarantee: every cell that a ray goes through is visited with a view that holds the ray, if the
//   rule loses none. A ray crosses a plane once, so a portal that the walk came through is not gone
//   through again; a portal whose plane the eye lies in, or which shows its back, is crossed by
//   none. Nothing relies on cells being convex or apart.
// Cost: a visit for each way into a cell that is open to the view. Where there are many ways (cells
//   in rings, many portals between two rooms), the number of ways grows as a power of their length;
//   so a cell that was visited visits_per_cell times is visited once more with the whole view, as a
//   start cell is, and then no more in this frame: at most cells * (visits_per_cell + 1) visits.
// Source: Luebke and Georges 1995, Portals and Mirrors.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/portal/portal_graph.h"

namespace vislab::portal_culling {

inline constexpr std::uint32_t visits_per_cell = 512;

struct WalkLimits {
  std::uint32_t visits = visits_per_cell;
  /// What was seen of a cell when its visits are used up is all that is seen of it. A mistake.
  bool forget_more = false;
};

/// Does any ray of the camera cross the opening's plane in the direction in which it leads?
inline bool leads_on(const Opening& opening, const Camera& camera) {
  if (camera.lens.projection == Projection::orthographic) {
    return glm::dot(opening.plane.normal, camera.pose.back) > 0.0;
  }
  return opening.plane.signed_distance(camera.pose.eye) > 0.0;
}

/// `Rule` has a type View and
///   void start(const Camera&);                        a frame begins
///   void whole(View& view);                           of the whole image
///   bool narrow(opening id, const View&, View& left); what is left of it behind the opening
template <typename Rule>
class PortalWalk {
 public:
  using View = typename Rule::View;

  explicit PortalWalk(const WalkLimits& limits) : limits_(limits) {}

  void build(const PortalGraph& graph) {
    graph_ = &graph;
    visits_.assign(graph.cell_count(), {});
    on_way_.assign(graph.opening_count(), 0);
    starts_.reserve(graph.cell_count());
    levels_.resize(1);
    frame_ = 0;
  }

  /// Calls visit(cell, const View&, portals gone through) for every visit.
  template <typename Visit>
  void run(const Camera& camera, std::span<const CellId> start_cells, Rule& rule, Visit&& visit) {
    next_frame();
    starts_.clear();
    for (const CellId cell : start_cells) make_start(cell, 0);
    for (std::size_t i = 0; i < starts_.size(); ++i) {
      const Start start = starts_[i];
      rule.whole(levels_[0].view);
      levels_[0].enter(start.cell, none_id, *graph_);
      visit(start.cell, levels_[0].view, start.depth);
      descend(camera, start.depth, rule, visit);
    }
  }

  std::uint64_t cells_visited() const { return cells_visited_; }
  std::uint64_t portals_clipped() const { return portals_clipped_; }
  std::size_t bytes() const {
    return levels_.capacity() * sizeof(Level) + visits_.capacity() * sizeof(Visits) +
           on_way_.capacity() + starts_.capacity() * sizeof(Start);
  }

 private:
  struct Level {
    std::uint32_t next, end;  // openings to be tried
    std::uint32_t came_through;
    View view;

    void enter(CellId cell, std::uint32_t through, const PortalGraph& graph) {
      next = graph.first_opening(cell);
      end = graph.end_opening(cell);
      came_through = through;
    }
  };
  struct Visits {
    std::uint32_t frame = 0;
    std::uint32_t count = 0;
  };
  struct Start {
    CellId cell;
    std::uint32_t depth;
  };

  void next_frame() {
    if (++frame_ != 0) return;
    for (Visits& visits : visits_) visits = {};
    frame_ = 1;
  }

  Visits& visits_of(CellId cell) {
    Visits& visits = visits_[cell];
    if (visits.frame != frame_) visits = {frame_, 0};
    return visits;
  }

  void make_start(CellId cell, std::uint32_t depth) {
    visits_of(cell).count = limits_.visits + 1;
    starts_.push_back({cell, depth});
    ++cells_visited_;
  }

  template <typename Visit>
  void descend(const Camera& camera, std::uint32_t depth, Rule& rule, Visit& visit) {
    std::size_t top = 0;
    while (true) {
      Level& level = levels_[top];
      if (level.next == level.end) {
        if (top == 0) return;
        on_way_[level.came_through] = 0;
        --top;
        continue;
      }
      const std::uint32_t id = level.next++;
      const Opening& opening = graph_->opening(id);
      if (on_way_[id] != 0 || !leads_on(opening, camera)) continue;
      Visits& visits = visits_of(opening.to);
      if (visits.count > limits_.visits) continue;
      if (top + 1 == levels_.size()) levels_.resize(2 * levels_.size());
      Level& next = levels_[top + 1];
      ++portals_clipped_;
      if (!rule.narrow(id, levels_[top].view, next.view)) continue;
      const auto depth_there = depth + static_cast<std::uint32_t>(top) + 1;
      if (visits.count == limits_.visits) {
        if (!limits_.forget_more) make_start(opening.to, depth_there);
        continue;
      }
      ++visits.count;
      ++cells_visited_;
      on_way_[id] = 1;
      next.enter(opening.to, id, *graph_);
      ++top;
      visit(opening.to, next.view, depth_there);
    }
  }

  WalkLimits limits_;
  const PortalGraph* graph_ = nullptr;
  std::vector<Level> levels_;
  std::vector<Visits> visits_;        // by cell
  std::vector<std::uint8_t> on_way_;  // by opening: gone through to where the walk is
  std::vector<Start> starts_;         // cells to be visited with the whole view
  std::uint32_t frame_ = 0;
  std::uint64_t cells_visited_ = 0;
  std::uint64_t portals_clipped_ = 0;
};

}  // namespace vislab::portal_culling
