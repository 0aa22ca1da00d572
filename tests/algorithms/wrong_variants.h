// Cullers that are wrong in known ways and claim to be conservative: the judge and the contract
// check have to find them out. Test-only: they are not in the lab's registry.
#pragma once

#include <memory>

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

/// A frustum test on boxes that gets something wrong.
class WrongFrustum : public ICuller {
 public:
  enum class Mistake {
    left_plane_flipped,  // the sign of one plane is wrong
    all_corners_inside,  // an object is kept only if all its corners are inside
    any_corner_inside    // an object is kept only if one of its corners is inside
  };

  WrongFrustum(CullerInfo info, Mistake mistake) : info_(std::move(info)), mistake_(mistake) {}

  const CullerInfo& info() const override { return info_; }
  void build(const Scene& scene, const BuildContext&) override {
    kept_.reserve(scene.object_count());
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    Frustum frustum = frustum_of(frame.camera);
    if (mistake_ == Mistake::left_plane_flipped) {
      Plane& left = frustum.planes[Frustum::left];
      left = {-left.normal, -left.d, left.magnitude};
    }
    kept_.clear();
    for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
      for (const ObjectId object : run) {
        if (keeps(frustum, frame.objects.bounds[object])) kept_.push_back(object);
      }
    });
    out.objects(kept_);
  }

 private:
  bool keeps(const Frustum& frustum, const Aabb& box) const {
    if (mistake_ == Mistake::left_plane_flipped) {
      for (const Plane& plane : frustum.span()) {
        if (surely_outside(plane, box)) return false;
      }
      return true;
    }
    int corners_inside = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 p((corner & 1) != 0 ? box.max.x : box.min.x,
                         (corner & 2) != 0 ? box.max.y : box.min.y,
                         (corner & 4) != 0 ? box.max.z : box.min.z);
      bool inside = true;
      for (const Plane& plane : frustum.span()) inside &= plane.signed_distance(p) >= 0.0;
      corners_inside += inside ? 1 : 0;
    }
    return mistake_ == Mistake::all_corners_inside ? corners_inside == 8 : corners_inside > 0;
  }

  CullerInfo info_;
  Mistake mistake_;
  std::vector<ObjectId> kept_;
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
  using Mistake = WrongFrustum::Mistake;
  const auto add_frustum = [&](const CullerInfo& info, Mistake mistake) {
    registry.add({info, [info, mistake](const ParameterValues&) {
                    return std::make_unique<WrongFrustum>(info, mistake);
                  }});
  };
  const auto claimed = [](const std::string& variant) {
    return claimed_conservative(variant, Granularity::object);
  };
  add_frustum(claimed("left_plane_flipped"), Mistake::left_plane_flipped);
  add_frustum(claimed("all_corners_inside"), Mistake::all_corners_inside);
  add_frustum(claimed("any_corner_inside"), Mistake::any_corner_inside);
  CullerInfo image = claimed("image");
  image.guarantee = Guarantee::image_exact;
  add_frustum(image, Mistake::left_plane_flipped);
  registry.add({claimed_conservative("normals_flipped", Granularity::triangle),
                [](const ParameterValues&) { return std::make_unique<FlippedBackface>(); }});
}

}  // namespace vislab
