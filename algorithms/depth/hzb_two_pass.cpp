// depth.hzb_two_pass: last frame's visible objects first, everything else against them.
//
// Idea: what was visible in the last frame is drawn into the buffer at once, and the pyramid is
//   built from it at once: no drawing waits for an answer. All objects are then tested against it.
//   What appears (passes, though it was not drawn) is drawn in a second pass, as soon as it amounts
//   to a good part of the image, and the pyramid is built again. In the end what passed is asked
//   once more, so that what appears may hide what appears. Both passes draw in bulk, as suits wide
//   machines.
// Guarantee: image_exact at the frame's viewport, as depth.hzb: last frame is but a guess at
//   occluders, which are drawn where they are now.
// Cost: O(nodes and objects not hidden by last frame's objects) questions, O(triangles drawn) for
//   the buffer, O(tiles) for the pyramid, twice if anything appears.
// Limits: as depth.hzb. In the first frame, and after a cut of the camera, the first pass has
//   nothing to draw, and the second does the work.
// Sources: Greene, Kass, Miller 1993 (temporal coherence by the list of visible objects); Haar and
//   Aaltonen 2015, GPU-Driven Rendering Pipelines (two passes).

#include "algorithms/depth/tree_culler.h"

namespace vislab {
namespace {

using depth_culling::BoxVerdict;

CullerInfo describe() {
  CullerInfo info = depth_culling::tree_culler_info("depth.hzb_two_pass", "bvh");
  info.summary =
      "Draws last frame's visible objects into the buffer, builds the Z-pyramid, tests everything "
      "against it, draws what appears, and tests again what is left.";
  info.cost =
      "O(nodes and objects that last frame's objects do not hide) + O(triangles drawn into the "
      "buffer) + O(tiles); update O(movers and their ancestors), for the octree O(objects) if "
      "anything changes";
  info.limits =
      "Objects are tested by their boxes. In the first frame and after cuts of the camera only the "
      "second pass finds anything. Sleeps while it does not pay: then it keeps everything that it "
      "is offered as a list, and what is in the view of everything.";
  info.sources = {"Greene, Kass, Miller 1993, Hierarchical Z-Buffer Visibility",
                  "Haar and Aaltonen 2015, GPU-Driven Rendering Pipelines"};
  return info;
}

template <typename Structure>
class TwoPassCuller final : public depth_culling::TreeCuller<Structure> {
 public:
  using depth_culling::TreeCuller<Structure>::TreeCuller;

  void build(const Scene& scene, const BuildContext& context) override {
    depth_culling::TreeCuller<Structure>::build(scene, context);
    passed_.reserve(scene.object_count());
  }
  std::size_t bytes() const override {
    return depth_culling::TreeCuller<Structure>::bytes() + passed_.capacity() * sizeof(Passed);
  }

 private:
  struct Passed {
    ObjectId object;
    BoxVerdict verdict;
    BoxWindow place;
  };

  void find_visible(const Frame& frame, const Candidates& candidates) override {
    passed_.clear();
    this->draw_seen_before(frame, candidates);
    bool again = false;
    this->walk(frame, candidates, [&](ObjectId object, BoxVerdict verdict, const BoxWindow& place) {
      passed_.push_back({object, verdict, place});
      this->draw_later(object, verdict, place, frame);
      if (this->draw_if_much()) again = true;
    });
    if (this->draw_now()) again = true;
    for (const Passed& object : passed_) {
      const bool hidden = again && object.verdict == BoxVerdict::visible &&
                          this->hides_now(object.object, object.place);
      if (!hidden) this->kept().push_back(object.object);
    }
  }

  std::vector<Passed> passed_;  // the first test, in order
};

std::unique_ptr<ICuller> make(const ParameterValues& values) {
  return depth_culling::make_tree_culler<TwoPassCuller>(describe(), values);
}

}  // namespace

namespace cullers {

CullerEntry depth_hzb_two_pass() { return {describe(), make}; }

}  // namespace cullers
}  // namespace vislab
