// skeleton.example: a culler to copy. It leaves out objects that lie wholly behind the viewer.
//
// (This comment is the method's manual page. Keep these five headings in every culler.)
//
// Idea: what lies behind the near plane cannot be in the image, and an object is behind it if its
//   box is.
// Guarantee: conservative; the test of the box carries an error bound (surely_outside).
// Cost: O(candidates), one plane test each.
// Limits: keeps everything in front of the viewer, seen or not.
// Source: one of the six planes of Clark 1976; frustum.flat tests all of them.

#include "common/culler/registry.h"
#include "common/geometry/frustum.h"

namespace vislab {
namespace {

// 1. The declaration. `vislab list` and `describe`, the report and the contract tests read it: no
//    text field stays empty, and the guarantee is held against ray casts.
CullerInfo describe() {
  CullerInfo info;
  info.name = "skeleton.example";  // family.variant: folder name, then file name
  info.family = "skeleton";
  info.summary = "Leaves out objects that lie wholly behind the near plane: an example to copy.";
  info.guarantee = Guarantee::conservative;       // nothing visible is ever left out
  info.repeatability = Repeatability::stateless;  // the same frame always gives the same answer
  info.granularity = Granularity::object;         // decides about whole objects
  info.culls = Culls::outside_frustum;            // what recall measures it against
  info.space = Space::object;                     // compares geometry, not pixels
  info.stage = PipelineStage::application;
  // A parameter is declared here once; listing, validation and documentation follow from that.
  info.parameters = {ParameterSpec::real(
      "margin_m", 0.0, 0.0, 1000.0, "m", ParameterSpec::Stage::query,
      "objects that reach to within this distance behind the near plane are kept too; more keeps "
      "more")};
  info.cost = "O(candidates): one plane test each";
  info.limits = "Keeps everything in front of the viewer, seen or not.";
  info.sources = {"Clark 1976, Hierarchical Geometric Models for Visible Surface Algorithms"};
  return info;
}

class Example : public ICuller {
 public:
  explicit Example(double margin_m) : margin_m_(margin_m) {}

  const CullerInfo& info() const override { return info_; }

  // 2. Preprocessing, timed. Memory that cull() needs is taken here, because cull() must not
  // allocate
  //    when a path is walked a second time.
  void build(const Scene& scene, const BuildContext&) override {
    kept_.reserve(scene.object_count());
  }

  // 3. The culler itself: goes through what is offered, and emits what is to be drawn.
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    Plane plane = frustum_of(frame.camera).planes[Frustum::near];
    plane.d += margin_m_;          // moves the plane back
    plane.magnitude += margin_m_;  // what d is made of bounds its rounding
    kept_.clear();
    // Candidates are everything that is shown now, or runs of object ids; this loop serves both.
    for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
      for (const ObjectId object : run) {
        // The world box is that of this frame: objects may move. "Surely" takes care of rounding.
        if (!surely_outside(plane, frame.objects.bounds[object])) kept_.push_back(object);
      }
      tested_ += run.size();
    });
    // One emission with many ids is better than many emissions. The memory behind it must stay as
    // it is until the next call of cull(): that is why kept_ is a member.
    out.objects(kept_);
  }

  // 4. Optional: how much memory build() took, and what was counted.
  std::size_t bytes() const override { return kept_.capacity() * sizeof(ObjectId); }
  Counters counters() const override { return {{"plane_tests", tested_}}; }

 private:
  CullerInfo info_ = describe();
  double margin_m_;
  std::vector<ObjectId> kept_;
  std::uint64_t tested_ = 0;
};

}  // namespace

// 5. The one function that CMake's list of cullers calls: FAMILY_NAME.
namespace cullers {

CullerEntry skeleton_example() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<Example>(values.real("margin_m"));
          }};
}

}  // namespace cullers
}  // namespace vislab
