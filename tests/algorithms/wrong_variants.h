// Cullers that are wrong in known ways and claim to be conservative: the judge and the contract
// check have to find them out. Test-only: they are not in the lab's registry.
#pragma once

#include <algorithm>
#include <memory>

#include "algorithms/all_cullers.h"
#include "common/culler/registry.h"
#include "common/geometry/frustum.h"

namespace vislab {

/// What all wrong variants share: a declaration that claims to be right.
inline CullerInfo claimed_conservative(const std::string& variant, Granularity granularity) {
  CullerInfo info;
  info.name = "wrong." + variant;
  info.family = "wrong";
  info.summary = "A negative control.";
  info.granularity = granularity;
  info.cost = "O(candidates)";
  info.limits = "Leaves out visible things, but says that it does not.";
  info.sources = {"Kowalka 2016, 4.3.2"};
  return info;
}

/// A frustum test on boxes in which the sign of the left plane is wrong.
class FlippedLeftPlane : public ICuller {
 public:
  explicit FlippedLeftPlane(CullerInfo info) : info_(std::move(info)) {}

  const CullerInfo& info() const override { return info_; }
  void build(const Scene& scene, const BuildContext&) override {
    kept_.reserve(scene.object_count());
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    Frustum frustum = frustum_of(frame.camera);
    Plane& left = frustum.planes[Frustum::left];
    left = {-left.normal, -left.d, left.magnitude};
    kept_.clear();
    for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
      for (const ObjectId object : run) {
        const Aabb& box = frame.objects.bounds[object];
        if (std::ranges::none_of(frustum.span(),
                                 [&](const Plane& plane) { return surely_outside(plane, box); })) {
          kept_.push_back(object);
        }
      }
    });
    out.objects(kept_);
  }

 private:
  CullerInfo info_;
  std::vector<ObjectId> kept_;
};

/// A culler of the lab under a declaration that claims more than it holds.
class Claimed : public ICuller {
 public:
  Claimed(CullerInfo info, const CullerEntry& entry, const std::string& error)
      : info_(std::move(info)),
        inner_(entry.make(
            ParameterValues(entry.info.name, entry.info.parameters, {{"error", error}}))) {}

  const CullerInfo& info() const override { return info_; }
  void build(const Scene& scene, const BuildContext& context) override {
    inner_->build(scene, context);
  }
  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    inner_->cull(frame, candidates, out);
  }

 private:
  CullerInfo info_;
  std::unique_ptr<ICuller> inner_;
};

/// A back-face test whose normals point the wrong way: keeps the backs of closed meshes.
class FlippedBackface : public ICuller {
 public:
  const CullerInfo& info() const override { return info_; }
  void build(const Scene& scene, const BuildContext&) override { scene_ = &scene; }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    kept_.clear();
    for_each_range(candidates, frame, *scene_, [&](const TriangleRange& range) {
      const Mesh& mesh = scene_->mesh_of(range.object);
      for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
        const auto [a, b, c] = world_triangle(mesh, frame.objects.transforms[range.object], i);
        const bool front = glm::dot(glm::cross(b - a, c - a), frame.camera.pose.eye - a) > 0.0;
        if (!mesh.closed || !front) kept_.push_back({range.object, i, 1});
      }
    });
    out.ranges(kept_);
  }

 private:
  CullerInfo info_ = claimed_conservative("normals_flipped", Granularity::triangle);
  const Scene* scene_ = nullptr;
  std::vector<TriangleRange> kept_;
};

/// Adds wrong.left_plane_flipped, wrong.all_corners_inside, wrong.any_corner_inside,
/// wrong.normals_flipped, and wrong.image, which has a plane flipped and claims to be image_exact.
inline void add_wrong_variants(Registry& registry) {
  const auto claimed = [](const std::string& variant) {
    return claimed_conservative(variant, Granularity::object);
  };
  const auto add_flipped = [&](const CullerInfo& info) {
    registry.add({info, [info](const ParameterValues&) {
                    return std::make_unique<FlippedLeftPlane>(info);
                  }});
  };
  add_flipped(claimed("left_plane_flipped"));
  CullerInfo image = claimed("image");
  image.guarantee = Guarantee::image_exact;
  add_flipped(image);
  Registry all;
  register_all_cullers(all);
  const CullerEntry wrong = all.entry("frustum.wrong");
  for (const std::string error : {"all_corners_inside", "any_corner_inside"}) {
    const CullerInfo info = claimed(error);
    registry.add({info, [info, wrong, error](const ParameterValues&) {
                    return std::make_unique<Claimed>(info, wrong, error);
                  }});
  }
  registry.add({claimed_conservative("normals_flipped", Granularity::triangle),
                [](const ParameterValues&) { return std::make_unique<FlippedBackface>(); }});
}

}  // namespace vislab
