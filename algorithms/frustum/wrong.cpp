// frustum.wrong: the mistakes that sources and engines made with view frusta, as negative controls.
//
// Idea: each variant makes one documented mistake and does everything else right, so that its
// damage
//   can be measured, and so that the judge is seen to find it.
// Guarantee: none (erroneous). The table below says of each what its source says or does, what is
//   wrong with it, and what comes of it.
// Cost: O(candidates), as a flat test.
// Limits: that is what they are for.
// Sources: in the table.

#include <array>

#include "algorithms/frustum/wrong_rules.h"
#include "common/culler/mistakes.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace frustum_culling;

struct FrustumMistake : Mistake {
  Repeatability repeatability;
  MakeWrongRule make;
};

constexpr auto stateless = Repeatability::stateless;
constexpr auto path = Repeatability::path;

constexpr std::array mistakes{
    FrustumMistake{"all_corners_inside", "A box is inside only if all eight corners are",
                   "a box that straddles a plane has corners outside",
                   "leaves out everything that the border of the image cuts",
                   "Kowalka 2016, 4.3.2, first attempt", stateless, all_corners_inside},
    FrustumMistake{"any_corner_inside", "A box is inside if at least one corner is",
                   "a box around or through the frustum has no corner in it",
                   "leaves out what is larger than the frustum or pierces it",
                   "Zachmann slide 36; Kowalka 2016, 4.3.2, fig. 4.3", stateless,
                   any_corner_inside},
    FrustumMistake{
        "outward_vertex", "A box is outside if its n-vertex is behind a plane",
        "that is written for normals that point outward, and used with inward ones: the wrong "
        "corner is asked",
        "leaves out everything that the border of the image cuts",
        "Zachmann slides 35-38 against Kowalka 2016, 3.2", stateless, outward_vertex},
    FrustumMistake{
        "behind_all_planes", "What is behind all planes is invisible",
        "behind any one of them is enough, and nothing is behind two that face each other",
        "leaves out nothing at all", "Engine report 2.2.3", stateless, behind_all_planes},
    FrustumMistake{
        "degrees", "The half width is the distance times tan(angle / 2)",
        "the tangent takes radians and is given degrees",
        "a frustum of 58.3 degrees instead of 45 and of 162 instead of 60, but of 1 degree "
        "instead of 44: keeps too much, or leaves out nearly everything",
        "Kowalka 2016, fig. 3.4", stateless, tangent_of_degrees},
    FrustumMistake{
        "direction", "The plane's centre is eye + (ref - eye) * distance",
        "ref - eye is not a unit vector; here it is 5 m long",
        "near and far plane five times too far away: leaves out what is near and at the sides",
        "Kowalka 2016, eq. 4.1", stateless, direction_not_normalised},
    FrustumMistake{
        "thesis_up", "right = up x (eye - ref), and corners lie along up as given",
        "up is not perpendicular to the view, and right is then too short",
        "the more the camera is pitched the more the frustum is skewed and narrowed: leaves out "
        "what is at the borders and keeps what is not seen",
        "Kowalka 2016, eqs. 4.3-4.4", stateless, up_as_given},
    FrustumMistake{"symmetric_lens", "One half angle stands for both sides of the window",
                   "off-centre lenses (headsets, tiled displays) have two",
                   "leaves out what is at the wider side and keeps as much beyond the other",
                   "niagara issue 5; fs2open issue 6673", stateless, symmetric_lens},
    FrustumMistake{
        "one_eye", "Both images of a stereo pair are culled with the left eye's frustum",
        "the right eye, whose image this is, sees past it by the distance of the eyes (amount)",
        "leaves out what only the right eye sees, at the right border",
        "playcanvas pull request 8889; three.js issue 13236", stateless, one_eye},
    FrustumMistake{
        "float_planes", "Planes and distances are float, in the coordinates of the world",
        "far from the origin the rounding of a plane's d is larger than the objects",
        "an error of about a metre at 1e7 m: leaves out what is smaller at the borders, from "
        "one frame to the next",
        "o3de issue 11856; castle-engine issue 503; filament pull request 913", stateless,
        float_planes},
    FrustumMistake{
        "nan_outside", "An oriented box is kept if its distance plus its reach is at least 0",
        "normalised axes of a flat box are 0 / 0, and every comparison with NaN is false",
        "leaves out all flat boxes", "FUSEE issues 652 and 658", stateless, nan_outside},
    FrustumMistake{
        "half_turn",
        "A box behind a side plane stays out while the camera turns away by less than 180 "
        "degrees",
        "that holds only below 180 degrees less the field of view; then it comes in at the "
        "other side",
        "leaves out what comes into view from behind during a long turn", "Kowalka 2016, 3.2.2",
        path, half_turn},
    FrustumMistake{
        "fixed_root", "A tree is skipped if its root is outside",
        "objects that left the root's box are still in the tree",
        "leaves out objects that moved out of the scene's first bounds when only those are "
        "looked away from",
        "o3de pull request 20115", stateless, fixed_root},
    FrustumMistake{"stale_bounds", "Boxes are made once, when the scene is built", "objects move",
                   "leaves out what moved into view and keeps what moved out of it",
                   "three.js issues 18412 and 27733; Godot issue 28933", stateless, stale_bounds},
    FrustumMistake{
        "small_parents", "A node outside or inside decides for all that is below it",
        "its box does not hold its children: it is too small by a share of its size (amount)",
        "leaves out children that stick out of nodes at the border of the image",
        "GearVRf issue 787 and pull request 380; OpenSceneGraph pull request 393", stateless,
        small_parents},
    FrustumMistake{"drops_on_remove", "The last object of a list takes the place of a removed one",
                   "it is not told its new place, so that its own removal takes out another",
                   "each pair of removals can lose an object for good",
                   "UnityOctree issues 8 and 29", path, drops_on_remove},
};

CullerInfo describe() {
  CullerInfo info;
  info.name = "frustum.wrong";
  info.family = "frustum";
  info.summary =
      "A negative control: a test of boxes against the view frustum that makes one of the mistakes "
      "found in the sources and in engines.";
  info.guarantee = Guarantee::erroneous;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.culls = Culls::outside_frustum;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.parameters = {
      error_parameter(mistakes),
      ParameterSpec::real("amount", 0.5, 0.0, 10.0, "", ParameterSpec::Stage::build,
                          "one_eye: distance of the eyes in metres; small_parents: by what share "
                          "of their size parents are too small; the others do without")};
  info.cost = "O(candidates): at most 6 plane tests each";
  info.limits = "Wrong on purpose: leaves out visible things, or keeps what is plainly outside.";
  info.sources = {"Kowalka 2016 (thesis, HAW Hamburg)", "Zachmann, Computer-Graphik 2, SS 2012",
                  "issues of engines, named with each mistake"};
  return info;
}

CullerInfo describe(const FrustumMistake& mistake) {
  CullerInfo info = info_of(describe(), mistake);
  info.repeatability = mistake.repeatability;
  return info;
}

class Wrong : public ICuller {
 public:
  Wrong(const FrustumMistake& mistake, double amount)
      : info_(describe(mistake)), rule_(mistake.make(amount)) {}

  const CullerInfo& info() const override { return info_; }
  void build(const Scene& scene, const BuildContext&) override {
    kept_.reserve(scene.object_count());
    rule_->build(scene);
  }
  void reset(std::uint64_t) override { rule_->reset(); }
  void update(const Frame& frame, const Changes& changes) override {
    rule_->update(frame, changes);
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    kept_.clear();
    rule_->start(frame);
    for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
      for (const ObjectId object : run) {
        if (!rule_->culls(object, frame)) kept_.push_back(object);
      }
      tested_ += run.size();
    });
    out.objects(kept_);
  }

  std::size_t bytes() const override { return kept_.capacity() * sizeof(ObjectId); }
  Counters counters() const override { return {{"objects_tested", tested_}}; }

 private:
  CullerInfo info_;
  std::unique_ptr<WrongRule> rule_;
  std::vector<ObjectId> kept_;
  std::uint64_t tested_ = 0;
};

}  // namespace

namespace cullers {

CullerEntry frustum_wrong() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<Wrong>(chosen_mistake(mistakes, values), values.real("amount"));
          }};
}

}  // namespace cullers
}  // namespace vislab
