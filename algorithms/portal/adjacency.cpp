// portal.adjacency: the lecture's rule to the letter: one's own cell, and those that share a portal
// with it.
//
// Idea: rooms see each other only through doors, so what may be seen is in one's own room and in
//   those next door.
// Guarantee: none; a negative control. Two doors in a line show the room after the next.
// Cost: O(objects of the cell and its neighbours).
// Limits: leaves out everything beyond the next cell; keeps neighbours whose portal is not in view.
// Source: Zachmann slides 77-78.

#include <algorithm>
#include <vector>

#include "algorithms/portal/portal_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace portal_culling;

CullerInfo describe() {
  CullerInfo info = portal_culler_info("portal.adjacency");
  info.summary =
      "Keeps what is in the frustum of the viewer's cell and of the cells that share a portal with "
      "it, as the lecture says. Wrong: what lies beyond the next cell may be seen too.";
  info.guarantee = Guarantee::erroneous;
  info.cost = "O(objects of the cell and of its neighbours)";
  info.limits = "Wrong on purpose: leaves out everything that is seen through two portals.";
  info.sources = {"Zachmann, Computer-Graphik 2, SS 2012, slides 77-78"};
  return info;
}

class Adjacency : public PortalCuller {
 public:
  Adjacency() : PortalCuller(describe()) {}

 protected:
  void walk(const Frame& frame, std::span<const CellId> start_cells) override {
    const auto all = [](const Aabb&) { return true; };
    for (const CellId cell : start_cells) visit_cell(cell, 0, frame, all);
    for (const CellId cell : start_cells) {
      for (std::uint32_t i = graph().first_opening(cell); i < graph().end_opening(cell); ++i) {
        visit_cell(graph().opening(i).to, 1, frame, all);
      }
    }
  }
};

}  // namespace

namespace cullers {

CullerEntry portal_adjacency() {
  return {describe(), [](const ParameterValues&) { return std::make_unique<Adjacency>(); }};
}

}  // namespace cullers
}  // namespace vislab
