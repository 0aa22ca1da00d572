// oracle: keeps exactly what truth says is visible. The upper anchor of every chart: what a
// perfect method of this granularity could save.
//
// Idea: the visible set of each frame is prepared by ray casts before anything is timed;
//   culling is its intersection with the candidates. At the level of nodes all units of a
//   hierarchy (query_hierarchy.h) are kept that hold something visible, with all in them that
//   may be in the view, near first: what a method could keep at best that asks about these
//   units, and asks nothing.
// Guarantee: image_exact. Truth is sampled (at the pixel centres and at jittered positions), so
//   what falls between all samples is left out.
// Cost: O(1) for the whole scene, O(visible + what is kept) at node level. For a part of it
//   O(visible + candidates) at object level, and O(candidates * log(visible)) at triangle
//   level.
// Limits: cannot be had outside of the lab; knows only the path for which truth was prepared.
// Source: this lab.

#include <algorithm>

#include "common/culler/registry.h"
#include "common/culler/stamps.h"
#include "common/geometry/frustum.h"
#include "common/scene/error.h"
#include "common/spatial/query_hierarchy.h"

namespace vislab {
namespace {

CullerInfo describe() {
  CullerInfo info;
  info.name = "oracle";
  info.family = "oracle";
  info.summary =
      "Keeps exactly what ray casts found visible beforehand: the upper anchor of every chart.";
  info.guarantee = Guarantee::image_exact;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.space = Space::image;
  info.stage = PipelineStage::application;
  info.needs_truth = true;
  info.parameters = {
      ParameterSpec::choice("level", "object", {"node", "object", "triangle"},
                            ParameterSpec::Stage::build,
                            "keeps units of a hierarchy that hold something visible, visible "
                            "objects, or only their visible triangles; a finer level saves more"),
      ParameterSpec::integer("leaf_triangles", 100, 1, 100'000'000, "triangles",
                             ParameterSpec::Stage::build,
                             "level=node: nodes with so many triangles, a draw counting as 20, are "
                             "units, as in occlusion.chcpp")};
  info.cost =
      "O(1) for the whole scene; else O(visible + candidates) at object level and "
      "O(candidates log visible) at triangle level";
  info.limits =
      "Knows only the path whose truth was prepared; leaves out what falls between all samples of "
      "truth.";
  info.sources = {"This lab: ray-cast truth at pixel centres and jittered samples"};
  return info;
}

/// What both levels share: where truth comes from.
class Oracle : public ICuller {
 public:
  explicit Oracle(Granularity level, Repeatability repeatability = Repeatability::stateless) {
    info_ = describe();
    info_.granularity = level;
    info_.repeatability = repeatability;
  }
  const CullerInfo& info() const override { return info_; }

  void build(const Scene&, const BuildContext& context) override {
    if (context.truth == nullptr) {
      throw InputError(
          "oracle: there is no truth to draw from; it needs a run that prepares truth by ray "
          "casts");
    }
    truth_ = context.truth;
  }

 protected:
  const TruthSource& truth() const { return *truth_; }

 private:
  CullerInfo info_;
  const TruthSource* truth_ = nullptr;
};

class ObjectOracle : public Oracle {
 public:
  ObjectOracle() : Oracle(Granularity::object) {}

  void build(const Scene& scene, const BuildContext& context) override {
    Oracle::build(scene, context);
    stamps_.resize(scene.object_count());
    kept_.reserve(scene.object_count());
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    const std::span<const ObjectId> visible = truth().visible_objects(frame.index);
    if (candidates.form() == Candidates::Form::everything) {
      out.objects(visible);
      return;
    }
    // The visible objects are marked and the candidates filtered, not the other way round: the
    // order in which an earlier stage wants things drawn is kept.
    stamps_.clear();
    for (const ObjectId object : visible) stamps_.insert(object);
    kept_.clear();
    for (const std::span<const ObjectId> run : candidates.object_runs()) {
      for (const ObjectId object : run) {
        if (stamps_.contains(object)) kept_.push_back(object);
      }
    }
    out.objects(kept_);
  }

  std::size_t bytes() const override {
    return stamps_.bytes() + kept_.capacity() * sizeof(ObjectId);
  }

 private:
  ObjectStamps stamps_;
  std::vector<ObjectId> kept_;
};

/// Keeps the units of a hierarchy in which something is visible.
class NodeOracle : public Oracle {
 public:
  /// Which objects share a unit depends on where they were before.
  explicit NodeOracle(std::uint32_t leaf_triangles)
      : Oracle(Granularity::object, Repeatability::path), hierarchy_(leaf_triangles) {}

  void build(const Scene& scene, const BuildContext& context) override {
    Oracle::build(scene, context);
    hierarchy_.build(scene);
    marked_.assign(hierarchy_.node_count(), 0);
    units_.reserve(scene.object_count());
    kept_.reserve(scene.object_count());
  }
  void reset(std::uint64_t) override { hierarchy_.reset(); }
  void update(const Frame& frame, const Changes& changes) override {
    hierarchy_.update(frame, changes);
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    find_units(frame);
    const Frustum frustum = frustum_of(frame.camera);
    const auto keep = [&](ObjectId object) {
      const Aabb& box = frame.objects.bounds[object];
      for (const Plane& plane : frustum.span()) {
        if (surely_outside(plane, box)) return;
      }
      kept_.push_back(object);
    };
    kept_.clear();
    if (candidates.form() == Candidates::Form::everything) {
      for (const ObjectId object : hierarchy_.unplaced()) kept_.push_back(object);
      std::ranges::sort(units_);
      for (const Unit& unit : units_) {
        for (const ObjectId object : hierarchy_.objects(unit.node)) keep(object);
      }
    } else {
      for (const std::span<const ObjectId> run : candidates.object_runs()) {
        for (const ObjectId object : run) {
          const QueryHierarchy::NodeIndex unit = hierarchy_.unit_of(object);
          if (unit == QueryHierarchy::nowhere || marked_[unit] == call_) keep(object);
        }
      }
    }
    out.objects(kept_);
  }

  std::size_t bytes() const override {
    return hierarchy_.bytes() + marked_.capacity() * sizeof(std::uint32_t) +
           units_.capacity() * sizeof(Unit) + kept_.capacity() * sizeof(ObjectId);
  }

 private:
  struct Unit {
    double distance_squared = 0.0;  // of the box from the eye
    QueryHierarchy::NodeIndex node = 0;
    auto operator<=>(const Unit&) const = default;
  };

  /// Those that hold something visible, each once.
  void find_units(const Frame& frame) {
    if (marked_.size() < hierarchy_.node_count() || ++call_ == 0) {
      marked_.assign(hierarchy_.node_count(), 0);
      call_ = 1;
    }
    units_.clear();
    for (const ObjectId object : truth().visible_objects(frame.index)) {
      const QueryHierarchy::NodeIndex unit = hierarchy_.unit_of(object);
      if (unit == QueryHierarchy::nowhere || marked_[unit] == call_) continue;
      marked_[unit] = call_;
      units_.push_back({distance_squared(hierarchy_.node(unit).box, frame.camera.pose.eye), unit});
    }
  }

  QueryHierarchy hierarchy_;
  std::vector<std::uint32_t> marked_;  // by node: the call that marked it
  std::uint32_t call_ = 0;
  std::vector<Unit> units_;
  std::vector<ObjectId> kept_;
};

class TriangleOracle : public Oracle {
 public:
  TriangleOracle() : Oracle(Granularity::triangle) {}

  void build(const Scene& scene, const BuildContext& context) override {
    Oracle::build(scene, context);
    scene_ = &scene;
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    const std::span<const TriangleRange> visible = truth().visible_triangles(frame.index);
    if (candidates.form() == Candidates::Form::everything) {
      out.ranges(visible);
      return;
    }
    kept_.clear();
    for_each_range(candidates, frame, *scene_,
                   [&](const TriangleRange& offered) { intersect(offered, visible); });
    out.ranges(kept_);
  }

 private:
  /// Adds the parts of `offered` that lie in `visible`, which is sorted by object and triangle.
  void intersect(const TriangleRange& offered, std::span<const TriangleRange> visible) {
    const auto ends_before = [&](const TriangleRange& range) {
      return range.object < offered.object ||
             (range.object == offered.object && range.first + range.count <= offered.first);
    };
    const std::uint32_t offered_end = offered.first + offered.count;
    for (auto range = std::ranges::partition_point(visible, ends_before);
         range != visible.end() && range->object == offered.object && range->first < offered_end;
         ++range) {
      const std::uint32_t first = std::max(range->first, offered.first);
      const std::uint32_t end = std::min(range->first + range->count, offered_end);
      if (first < end) kept_.push_back({offered.object, first, end - first});
    }
  }

  const Scene* scene_ = nullptr;
  std::vector<TriangleRange> kept_;
};

}  // namespace

namespace cullers {

CullerEntry oracle() {
  return {describe(), [](const ParameterValues& values) -> std::unique_ptr<ICuller> {
            if (values.choice("level") == "triangle") return std::make_unique<TriangleOracle>();
            if (values.choice("level") == "node") {
              return std::make_unique<NodeOracle>(
                  static_cast<std::uint32_t>(values.integer("leaf_triangles")));
            }
            return std::make_unique<ObjectOracle>();
          }};
}

}  // namespace cullers
}  // namespace vislab
