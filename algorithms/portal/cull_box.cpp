// portal.cull_box: Luebke and Georges' portals: the rectangle around a portal's image.
//
// Idea: what is left of the image behind a chain of portals lies in the intersection of the upright
//   rectangles around their images (the "cull box"), which costs four comparisons to cut.
// Guarantee: conservative; keeps all that portal.polygon keeps.
// Cost: as the walk (portal_walk.h), with four comparisons for each portal.
// Limits: a rectangle around a portal that is rolled or seen at an angle is larger than the portal:
//   up to twice for a square rolled by 45 degrees, and more the longer the chain.
// Source: Luebke and Georges 1995, Portals and Mirrors.

#include <algorithm>

#include "algorithms/portal/portal_culler.h"
#include "algorithms/portal/portal_images.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace portal_culling;

class CullBoxRule {
 public:
  using View = Rectangle;

  void build(const PortalGraph& graph) { images_.build(graph); }
  void start(const Camera& camera) { images_.start(camera); }
  void whole(View& view) const { view = images_.map().whole(); }
  bool narrow(std::uint32_t opening, const View& view, View& left) {
    const ImagePolygon* image = images_.image(opening);
    if (image == nullptr || !image->bounds().overlaps(view)) return false;
    left.min = glm::max(view.min, image->bounds().min - window_slack);
    left.max = glm::min(view.max, image->bounds().max + window_slack);
    return true;
  }
  void prepare(const View& view) { planes_.set(images_.map(), view); }
  bool meets(const Aabb& box) const { return planes_.meets(box); }
  std::size_t bytes() const { return images_.bytes(); }

 private:
  PortalImages images_;
  WindowPlanes planes_;
};

CullerInfo describe() {
  CullerInfo info = portal_culler_info("portal.cull_box");
  info.summary =
      "Follows portals from cell to cell with the intersection of the upright rectangles around "
      "their images, and keeps the objects whose boxes reach into it.";
  info.cost =
      "a comparison of two rectangles for each way through a portal that is open to the "
      "view, and a test of the box for each object of the cells beyond";
  info.limits = std::string(
                    "The rectangle around a portal that is rolled or seen at an angle shows more "
                    "than the portal. ") +
                limits_of_walks;
  return info;
}

}  // namespace

namespace cullers {

CullerEntry portal_cull_box() {
  return {describe(), [](const ParameterValues&) {
            return std::make_unique<WalkingCuller<CullBoxRule>>(describe());
          }};
}

}  // namespace cullers
}  // namespace vislab
