// What all cullers by portals share: cells and objects, the camera's frustum, what is kept and in
// which order.
//
// Objects outside of one of the frustum's planes are never kept. In a camera whose near plane's
// window is not covered by cells ("outside") all others are kept, as they are where the view shows
// the place of a wall that is hidden or has moved away ("gap"); and always those that lie in no
// cell. What is kept comes in the order of how many portals lie before it, then objects without a
// cell.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "algorithms/portal/object_places.h"
#include "algorithms/portal/portal_walk.h"
#include "common/culler/cell_walker.h"
#include "common/culler/culler.h"
#include "common/culler/stamps.h"
#include "common/geometry/frustum.h"

namespace vislab::portal_culling {

/// The parts of the declaration that they have in common.
CullerInfo portal_culler_info(std::string name);

/// What is to be said of the limits of every walk.
inline constexpr const char* limits_of_walks =
    "Only walls hide, and only where cells and portals are known: outside of all cells, and where "
    "the view shows a place that a wall has left, it keeps all that is in the frustum. It takes "
    "every wall for drawn: what a scene lets be seen through solid without a surface it leaves "
    "out.";

class PortalCuller : public ICuller, public CellWalker {
 public:
  explicit PortalCuller(CullerInfo info) : info_(std::move(info)) {}

  const CullerInfo& info() const override { return info_; }
  void build(const Scene& scene, const BuildContext& context) override;
  void reset(std::uint64_t) override {
    places_.reset();
    last_outside_ = no_frame;
  }
  void update(const Frame& frame, const Changes& changes) override {
    places_.update(frame, changes);
  }
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override;
  std::size_t bytes() const override;
  Counters counters() const override;
  bool append_reached_cells(std::vector<CellId>& cells) const override;

 protected:
  /// Visits the cells that are seen from the start cells, with visit_cell().
  virtual void walk(const Frame& frame, std::span<const CellId> start_cells) = 0;
  /// Where the view begins; false if that is not known. By default as PortalGraph::start_cells.
  virtual bool find_start(const Camera& camera, std::vector<CellId>& cells) const {
    return graph_.start_cells(camera, cells);
  }

  const PortalGraph& graph() const { return graph_; }

  /// Keeps the cell's objects that are in the frustum and of whose boxes `meets` says that they
  /// reach into what is left of the view; it is asked no more of those that are kept.
  template <typename Meets>
  void visit_cell(CellId cell, std::uint32_t depth, const Frame& frame, Meets&& meets) {
    reached_[cell] = cull_;
    places_.for_each_gap(cell, [&](const Aabb& gap) { sees_gap_ = sees_gap_ || meets(gap); });
    places_.for_each_in(cell, [&](ObjectId object) {
      Mark& mark = mark_of(object, frame);
      if (mark.state == State::left_out) return;
      if (mark.state == State::kept) {
        kept_[mark.place].depth = std::min(kept_[mark.place].depth, depth);
        return;
      }
      ++objects_tested_;
      const Aabb& box = frame.objects.bounds[object];
      if (meets(box) || !box.valid()) keep(object, mark, depth);
    });
  }

 private:
  static constexpr std::uint64_t no_frame = ~std::uint64_t{0};

  enum class State : std::uint32_t { left_out, in_frustum, kept };
  struct Mark {
    std::uint32_t cull = 0;  // in which it was made
    State state = State::left_out;
    std::uint32_t place = 0;  // in kept_, if kept
  };
  struct Kept {
    ObjectId object;
    std::uint32_t depth;
  };

  Mark& mark_of(ObjectId object, const Frame& frame) {
    Mark& mark = marks_[object];
    if (mark.cull != cull_) mark = {cull_, first_state(object, frame), 0};
    return mark;
  }
  State first_state(ObjectId object, const Frame& frame) {
    const bool offered = everything_ ? places_.shown(object) : offered_.contains(object);
    return offered && in_frustum(object, frame) ? State::in_frustum : State::left_out;
  }
  bool in_frustum(ObjectId object, const Frame& frame) {
    ++objects_tested_;
    for (const Plane& plane : frustum_.span()) {
      if (surely_outside(plane, frame.objects.bounds[object])) return false;
    }
    return true;
  }
  void keep(ObjectId object, Mark& mark, std::uint32_t depth) {
    mark.state = State::kept;
    mark.place = static_cast<std::uint32_t>(kept_.size());
    kept_.push_back({object, depth});
  }
  void start_marks();
  bool keep_by_portals(const Frame& frame, const Candidates& candidates);
  void keep_in_frustum(const Frame& frame, const Candidates& candidates);
  void sort_kept();

  CullerInfo info_;
  PortalGraph graph_;
  ObjectPlaces places_;
  Frustum frustum_;
  std::vector<CellId> start_cells_;
  std::uint32_t cull_ = 0;
  bool everything_ = true;              // is offered
  ObjectStamps offered_;                // otherwise
  std::vector<Mark> marks_;             // by object
  std::vector<std::uint32_t> reached_;  // by cell: the last cull that came to it
  std::vector<Kept> kept_;
  std::vector<std::uint32_t> place_of_depth_;
  std::vector<ObjectId> sorted_;
  bool sees_gap_ = false;
  std::uint64_t objects_tested_ = 0;
  std::uint64_t outside_ = 0;  // frames
  std::uint64_t last_outside_ = no_frame;
};

/// A culler that walks by a rule (portal_walk.h), which also has
///   void prepare(const View&);         before it is asked
///   bool meets(const Aabb&) const;     of the view that it was prepared for
template <typename Rule>
class WalkingCuller : public PortalCuller {
 public:
  explicit WalkingCuller(CullerInfo info, const WalkLimits& limits = {})
      : PortalCuller(std::move(info)), walk_(limits) {}

  void build(const Scene& scene, const BuildContext& context) override {
    PortalCuller::build(scene, context);
    rule_.build(graph());
    walk_.build(graph());
  }
  std::size_t bytes() const override {
    return PortalCuller::bytes() + walk_.bytes() + rule_.bytes();
  }
  Counters counters() const override {
    Counters counters = PortalCuller::counters();
    counters.emplace_back("cells_visited", walk_.cells_visited());
    counters.emplace_back("portals_clipped", walk_.portals_clipped());
    return counters;
  }

 protected:
  void walk(const Frame& frame, std::span<const CellId> start_cells) override {
    rule_.start(frame.camera);
    walk_.run(frame.camera, start_cells, rule_,
              [&](CellId cell, const typename Rule::View& view, std::uint32_t depth) {
                bool prepared = false;
                visit_cell(cell, depth, frame, [&](const Aabb& box) {
                  if (!prepared) rule_.prepare(view);
                  prepared = true;
                  return rule_.meets(box);
                });
              });
  }

 private:
  Rule rule_;
  PortalWalk<Rule> walk_;
};

}  // namespace vislab::portal_culling
