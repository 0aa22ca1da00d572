// depth.hzb: the hierarchical Z-buffer.
//
// Idea: three hierarchies meet: an octree over the objects, a Z-pyramid over the image, and the
// list
//   of what was visible in the last frame. The list is drawn into the buffer first, because most of
//   it is visible again. Then the octree is walked front to back: a node whose box the pyramid
//   hides is dropped with all that is in it; objects of the others are tested by their boxes, and
//   what may be visible is emitted, and drawn into the buffer unless it has been drawn already. The
//   pyramid follows texel by texel.
// Guarantee: image_exact at the frame's viewport: boxes are enlarged and depths of occluders
// lowered
//   by more than what a device snaps and rounds (box_window.h). What the near plane may cut is
//   kept.
// Cost: O(nodes and objects that are not below a hidden node) questions, O(triangles drawn) for the
//   buffer, O(tiles drawn into) for the pyramid. What is hidden costs nothing by itself.
// Differs from the source: each object is at one node, so that no polygon needs a flag against
// being
//   drawn twice; nodes have the boxes of what is in them, not of their cells; whole objects are
//   emitted, not polygons, because that is what a draw costs by; last frame's list is tested as
//   well, so that what has become hidden is not drawn; visible objects smaller than `occluder_px`
//   are not drawn into the buffer.
// Limits: objects are as visible as their boxes: slanted ones and those with holes are kept more
//   often. Where little is hidden it costs more than it saves: then it sleeps (worth.h).
// Sources: Greene, Kass, Miller 1993, Hierarchical Z-Buffer Visibility; Kowalka 2016 (thesis, HAW
//   Hamburg), 2.4.2, whose rule for updates of the pyramid is backwards (depth_pyramid.h).

#include "algorithms/depth/tree_culler.h"

namespace vislab {
namespace {

CullerInfo describe() {
  CullerInfo info = depth_culling::tree_culler_info("depth.hzb", "octree");
  info.summary =
      "Walks an octree front to back against a Z-pyramid that follows what is drawn, after last "
      "frame's visible objects have been drawn into it.";
  info.cost =
      "O(nodes and objects that are not below a hidden node) + O(triangles drawn into the buffer); "
      "update O(objects) for the octree if anything changes";
  info.limits =
      "Objects are tested by their boxes. Sleeps while it does not pay: then it keeps everything "
      "that it is offered as a list, and what is in the view of everything.";
  info.sources = {"Greene, Kass, Miller 1993, Hierarchical Z-Buffer Visibility",
                  "Kowalka 2016 (thesis, HAW Hamburg), 2.4.2"};
  return info;
}

template <typename Structure>
class HzbCuller final : public depth_culling::TreeCuller<Structure> {
 public:
  using depth_culling::TreeCuller<Structure>::TreeCuller;

 private:
  void find_visible(const Frame& frame, const Candidates& candidates) override {
    this->draw_seen_before(frame, candidates);
    this->walk(frame, candidates,
               [&](ObjectId object, depth_culling::BoxVerdict verdict, const BoxWindow& place) {
                 this->kept().push_back(object);
                 this->draw_later(object, verdict, place, frame);
                 this->draw_now();
               });
  }
};

std::unique_ptr<ICuller> make(const ParameterValues& values) {
  return depth_culling::make_tree_culler<HzbCuller>(describe(), values);
}

}  // namespace

namespace cullers {

CullerEntry depth_hzb() { return {describe(), make}; }

}  // namespace cullers
}  // namespace vislab
