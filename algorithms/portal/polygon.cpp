// portal.polygon: sees through each portal exactly what its outline leaves of the view.
//
// Idea: what is left of the image behind a chain of portals is the intersection of their images, a
//   convex polygon. Objects of a cell are tested against the planes through the eye and the
//   polygon's edges.
// Guarantee: conservative, for portals that are all the ways out of their cells and objects that
//   are listed in all cells that they reach into.
// Cost: as the walk (portal_walk.h), with one clip of a polygon by a polygon for each portal whose
//   rectangle meets the view's.
// Limits: portals only: furniture hides nothing. An object is kept if its box reaches into the
//   view, not it itself.
// Sources: Luebke and Georges 1995 with polygons instead of rectangles; Teller and Séquin 1991
//   (eye-to-cell visibility).

#include "algorithms/portal/polygon_rule.h"
#include "algorithms/portal/portal_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace portal_culling;

CullerInfo describe() {
  CullerInfo info = portal_culler_info("portal.polygon");
  info.summary =
      "Follows portals from cell to cell with what their exact outlines leave of the image, and "
      "keeps the objects whose boxes reach into it.";
  info.cost =
      "a clip of two polygons for each way through a portal that is open to the view, and "
      "a test of the box for each object of the cells beyond";
  info.limits = limits_of_walks;
  info.sources.emplace_back(
      "Teller and Séquin 1991, Visibility Preprocessing for Interactive "
      "Walkthroughs");
  return info;
}

}  // namespace

namespace cullers {

CullerEntry portal_polygon() {
  return {describe(), [](const ParameterValues&) {
            return std::make_unique<WalkingCuller<PolygonRule>>(describe());
          }};
}

}  // namespace cullers
}  // namespace vislab
