// frustum.flat: leaves out objects whose bounding volume lies outside one plane of the view
// frustum.
//
// Idea: a box is outside a plane exactly if its corner farthest along the inward normal (the
//   p-vertex) is; a sphere, if its centre is farther behind the plane than its radius. All objects
//   are looked at, without a tree: boxes 64 at a time with SIMD (flat_boxes.h), other volumes and
//   the accelerations that need memory or branches one by one (object_tester.h).
// Guarantee: conservative. A distance that is negative only by rounding excludes nothing: what is
//   near a plane is decided in double, by surely_outside with its error bound.
// Cost: O(candidates), at most 6 plane tests each; with early_out=group, O(objects / 64) and the
//   boxes near the frustum's surface.
// Limits: with tests on planes, a volume that is outside the frustum, but not outside any single
//   plane (a big box off a corner), is kept. Objects that hide each other are kept.
// Sources: Clark 1976; Assarsson and Moeller 2000 (n- and p-vertex); Zachmann slides 30-38; Kowalka
//   2016, 3.2.1-3.2.2.

#include <optional>

#include "algorithms/frustum/flat_boxes.h"
#include "algorithms/frustum/object_tester.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using frustum_culling::FlatBoxes;
using frustum_culling::FrustumTester;
using frustum_culling::ObjectTester;
using frustum_culling::ObjectTestOptions;
using frustum_culling::Switches;

CullerInfo describe() {
  CullerInfo info;
  info.name = "frustum.flat";
  info.family = "frustum";
  info.summary =
      "Tests each object's bounding volume against the planes of the view frustum and leaves out "
      "what lies outside one of them; boxes 64 at a time.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.culls = Culls::outside_frustum;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.parameters = frustum_culling::object_test_parameters();
  info.parameters.push_back(frustum_culling::object_intersecting_parameter());
  info.parameters.push_back(ParameterSpec::choice(
      "kernel", "simd", {"simd", "scalar"}, ParameterSpec::Stage::build,
      "boxes 64 at a time, or one by one; the answers are the same. Anything but test=vertex with "
      "intersecting=keep and no other acceleration goes one by one in any case"));
  info.parameters.push_back(ParameterSpec::choice(
      "early_out", "group", {"off", "group"}, ParameterSpec::Stage::build,
      "kernel=simd: all boxes against all planes, or first the boxes around groups of 64 "
      "neighbours, which decide about most of them at once"));
  for (ParameterSpec& spec : frustum_culling::switch_parameters(false)) {
    info.parameters.push_back(std::move(spec));
  }
  info.cost =
      "O(candidates): at most 6 plane tests each; with early_out=group 6 for each 64 objects and a "
      "few for those near the frustum's surface";
  info.limits =
      "Keeps volumes that are outside the frustum but not outside any single plane (but for "
      "test=exact); does not see that objects hide each other.";
  info.sources = {"Clark 1976, Hierarchical Geometric Models for Visible Surface Algorithms",
                  "Assarsson and Moeller 2000, Optimized View Frustum Culling Algorithms for "
                  "Bounding Boxes",
                  "Zachmann, Computer-Graphik 2, SS 2012, slides 30-38",
                  "Kowalka 2016 (thesis, HAW Hamburg), 3.2.1-3.2.2"};
  return info;
}

/// Every candidate by itself.
class FlatOneByOne : public ICuller {
 public:
  FlatOneByOne(const ObjectTestOptions& options, const Switches& switches)
      : info_(describe()), tester_(switches), objects_(options) {
    info_.repeatability = switches.repeatability();
  }
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    objects_.build(scene);
    tester_.resize(scene.object_count());
    kept_.reserve(scene.object_count());
  }

  void reset(std::uint64_t) override {
    objects_.reset();
    tester_.forget();
  }

  void update(const Frame& frame, const Changes& changes) override {
    objects_.update(frame, changes);
    for (const ObjectId object : changes.moved) tester_.forget(object);
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    tester_.start(frame);
    objects_.start(frame);
    kept_.clear();
    for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
      objects_tested_ += run.size();
      for (const ObjectId object : run) {
        if (objects_.keeps(object, frame, tester_, object, tester_.all_planes())) {
          kept_.push_back(object);
        }
      }
    });
    out.objects(kept_);
  }

  std::size_t bytes() const override {
    return kept_.capacity() * sizeof(ObjectId) + tester_.bytes() + objects_.bytes();
  }
  Counters counters() const override {
    Counters counters{{"objects_tested", objects_tested_}};
    objects_.append_counters(tester_, counters);
    return counters;
  }

 private:
  CullerInfo info_;
  FrustumTester tester_;
  ObjectTester objects_;
  std::vector<ObjectId> kept_;
  std::uint64_t objects_tested_ = 0;
};

/// Boxes by p-vertices, 64 at a time.
class FlatBySimd : public ICuller {
 public:
  explicit FlatBySimd(FlatBoxes::Order order) : info_(describe()), order_(order) {}
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext& context) override {
    scene_ = &scene;
    boxes_.emplace(order_, context.threads);
    kept_.resize(scene.object_count());
    arrange_as_built();
  }

  void reset(std::uint64_t) override {
    if (changed_) arrange_as_built();
  }

  void update(const Frame& frame, const Changes& changes) override {
    changed_ = changed_ || !changes.empty();
    boxes_->update(frame.objects.bounds, changes);
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    const std::span<const Aabb> bounds = frame.objects.bounds;
    const Frustum frustum = frustum_of(frame.camera);
    std::size_t kept = 0;
    if (candidates.form() == Candidates::Form::everything) {
      objects_tested_ += boxes_->shown_count();
      const std::span<const std::uint64_t> words = boxes_->cull(frustum, bounds);
      kept = frustum_culling::select_ids(words, boxes_->objects_by_slot(), kept_.data());
    } else {
      std::size_t count = 0;
      for (const auto run : candidates.object_runs()) count += run.size();
      objects_tested_ += count;
      // All at once is that much faster than one by one.
      constexpr std::size_t gain = 16;
      const bool all = count >= boxes_->object_count() / gain;
      const auto words = all ? boxes_->cull(frustum, bounds) : std::span<const std::uint64_t>();
      for (const std::span<const ObjectId> run : candidates.object_runs()) {
        for (const ObjectId object : run) {
          const std::uint32_t slot = boxes_->slot_of(object);
          const bool keep = all ? ((words[slot / 64] >> (slot % 64)) & 1) != 0
                                : !outside(frustum, bounds[object]);
          kept_[kept] = object;
          kept += keep ? 1 : 0;
        }
      }
    }
    out.objects(std::span(kept_).first(kept));
  }

  std::size_t bytes() const override {
    return kept_.capacity() * sizeof(ObjectId) + (boxes_ ? boxes_->bytes() : 0);
  }
  Counters counters() const override {
    return {{"objects_tested", objects_tested_},
            {"plane_tests", plane_tests_ + (boxes_ ? boxes_->plane_tests() : 0)}};
  }

 private:
  void arrange_as_built() {
    std::vector<Aabb> bounds(scene_->object_count());
    for (ObjectId object = 0; object < bounds.size(); ++object) {
      bounds[object] =
          transformed(scene_->mesh_of(object).bounds, scene_->objects[object].transform);
    }
    boxes_->build(bounds);
    changed_ = false;
  }

  bool outside(const Frustum& frustum, const Aabb& box) {
    for (const Plane& plane : frustum.span()) {
      ++plane_tests_;
      if (surely_outside(plane, box)) return true;
    }
    return false;
  }

  CullerInfo info_;
  FlatBoxes::Order order_;
  const Scene* scene_ = nullptr;
  std::optional<FlatBoxes> boxes_;
  bool changed_ = false;  // since the scene was as built
  std::vector<ObjectId> kept_;
  std::uint64_t plane_tests_ = 0;
  std::uint64_t objects_tested_ = 0;
};

std::unique_ptr<ICuller> make(const ParameterValues& values) {
  const ObjectTestOptions options = frustum_culling::read_object_test(values, true);
  const Switches switches = frustum_culling::read_switches(values);
  const bool by_p_vertex = options.test == ObjectTestOptions::Test::vertex && !options.refine;
  if (values.choice("kernel") == "scalar" || !by_p_vertex || !switches.plain()) {
    return std::make_unique<FlatOneByOne>(options, switches);
  }
  return std::make_unique<FlatBySimd>(
      values.choice("early_out") == "group" ? FlatBoxes::Order::groups : FlatBoxes::Order::ids);
}

}  // namespace

namespace cullers {

CullerEntry frustum_flat() { return {describe(), make}; }

}  // namespace cullers
}  // namespace vislab
