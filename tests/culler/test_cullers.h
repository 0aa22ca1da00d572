// Cullers that exercise chains: one that listens, one that emits in mixed forms, one that
// remembers. Test-only.
#pragma once

#include <functional>
#include <memory>

#include "common/culler/registry.h"
#include "common/geometry/frustum.h"

namespace vislab {

inline CullerInfo test_info(const std::string& variant, Granularity granularity,
                            Guarantee guarantee, Repeatability repeatability) {
  CullerInfo info;
  info.name = "test." + variant;
  info.family = "test";
  info.summary = "For tests of chains.";
  info.guarantee = guarantee;
  info.repeatability = repeatability;
  info.granularity = granularity;
  info.cost = "O(candidates)";
  info.limits = "For tests only.";
  info.sources = {"tests"};
  return info;
}

/// Does what a function says; for single cases.
class ScriptedCuller : public ICuller {
 public:
  using Cull = std::function<void(const Frame&, const Candidates&, DrawSink&)>;

  ScriptedCuller(CullerInfo info, Cull cull) : info_(std::move(info)), cull_(std::move(cull)) {}

  const CullerInfo& info() const override { return info_; }
  void build(const Scene&, const BuildContext&) override {}
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    cull_(frame, candidates, out);
  }

 private:
  CullerInfo info_;
  Cull cull_;
};

/// Keeps everything, but emits every second object whole and the others as two ranges, in turn.
class MixedForms : public ICuller {
 public:
  static CullerInfo describe() {
    return test_info("mixed", Granularity::triangle, Guarantee::conservative,
                     Repeatability::stateless);
  }
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    scene_ = &scene;
    ids_.reserve(scene.object_count());
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    ids_.clear();
    ranges_.clear();
    order_.clear();
    for_each_range(candidates, frame, *scene_, [&](const TriangleRange& range) {
      const bool whole = range.count == scene_->triangle_count(range.object);
      if (whole && range.object % 2 == 0) {
        ids_.push_back(range.object);
        order_.push_back(0);
      } else {
        const std::uint32_t half = range.count / 2;  // may be 0: a range without triangles
        ranges_.push_back({range.object, range.first, half});
        ranges_.push_back({range.object, range.first + half, range.count - half});
        order_.push_back(1);
      }
    });
    const std::span<const ObjectId> ids(ids_);
    const std::span<const TriangleRange> ranges(ranges_);
    std::size_t next_id = 0, next_range = 0;
    for (const int form : order_) {
      if (form == 0) {
        out.objects(ids.subspan(next_id++, 1));
      } else {
        out.ranges(ranges.subspan(next_range, 2));
        next_range += 2;
      }
    }
  }

 private:
  CullerInfo info_ = describe();
  const Scene* scene_ = nullptr;
  std::vector<ObjectId> ids_;
  std::vector<TriangleRange> ranges_;
  std::vector<int> order_;
};

/// Leaves out an object if it was offered in the frame before and was outside the frustum then: a
/// frustum culler that is one frame late. Something that was not offered is not taken as invisible.
class OneFrameLate : public ICuller {
 public:
  explicit OneFrameLate(Repeatability declared) {
    info_.name = declared == Repeatability::path ? "test.late" : "test.late_but_stateless";
    info_.repeatability = declared;
  }
  static CullerInfo describe(Repeatability declared) { return OneFrameLate(declared).info_; }
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    outside_in_.assign(scene.object_count(), 0);
    kept_.reserve(scene.object_count());
  }
  void reset(std::uint64_t) override { outside_in_.assign(outside_in_.size(), 0); }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    const Frustum frustum = frustum_of(frame.camera);
    kept_.clear();
    for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
      for (const ObjectId object : run) {
        std::uint64_t& outside_in = outside_in_[object];
        if (frame.index == 0 || outside_in != frame.index) kept_.push_back(object);
        for (const Plane& plane : frustum.span()) {
          if (surely_outside(plane, frame.objects.bounds[object])) outside_in = frame.index + 1;
        }
      }
    });
    out.objects(kept_);
  }

 private:
  CullerInfo info_ =
      test_info("late", Granularity::object, Guarantee::approximate, Repeatability::path);
  std::vector<std::uint64_t> outside_in_;  // by object: index + 1 of the last frame it was outside
  std::vector<ObjectId> kept_;
};

/// Adds test.mixed, test.late and test.late_but_stateless.
inline void add_test_cullers(Registry& registry) {
  registry.add({MixedForms::describe(),
                [](const ParameterValues&) { return std::make_unique<MixedForms>(); }});
  for (const Repeatability declared : {Repeatability::path, Repeatability::stateless}) {
    registry.add({OneFrameLate::describe(declared), [declared](const ParameterValues&) {
                    return std::make_unique<OneFrameLate>(declared);
                  }});
  }
}

}  // namespace vislab
