// peer.bullet: frustum culling with the dynamic bounding-volume tree of the Bullet physics engine.
//
// Idea: a binary tree of boxes, optimised top down once; planes that a node is inside of are not
//   asked again, and the leaves below a node that is inside of all are enumerated. What moves is
//   taken out and put back in near where it was.
// Guarantee: approximate. Float in world coordinates without an error bound: boxes within rounding
//   of a plane may go.
// Cost: O(nodes that the frustum's surface passes through + kept objects), whatever the candidates.
//   A moved object O(depth).
// Limits: each query allocates its stack. Objects without a valid box are kept beside the tree.
// Source: github.com/bulletphysics/bullet3, btDbvt (called, not copied).

#include "algorithms/peers/bullet_tree.h"
#include "common/culler/registry.h"
#include "common/culler/stamps.h"

namespace vislab {
namespace {

CullerInfo describe() {
  CullerInfo info;
  info.name = "peer.bullet";
  info.family = "peer";
  info.summary =
      "The dynamic bounding-volume tree of the Bullet physics engine (Debian's libbullet-dev), "
      "queried with the planes of the frustum.";
  info.guarantee = Guarantee::approximate;
  info.repeatability = Repeatability::path;
  info.granularity = Granularity::object;
  info.culls = Culls::outside_frustum;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.cost =
      "O(nodes at the frustum's surface + kept objects), whatever the candidates; O(depth) for "
      "each "
      "moved object";
  info.limits =
      "Float without an error bound: boxes that touch the frustum within rounding may be left out, "
      "the more so the farther the scene is from the origin. Allocates in every query.";
  info.sources = {"Bullet 3.24, btDbvt::collideKDOP, https://github.com/bulletphysics/bullet3"};
  return info;
}

class Bullet : public ICuller {
 public:
  Bullet() : info_(describe()) {}
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    scene_ = &scene;
    kept_.reserve(scene.object_count());
    offered_.resize(scene.object_count());
    hidden_.resize(scene.object_count());
    place_as_built();
  }

  void reset(std::uint64_t) override {
    if (changed_) place_as_built();
  }

  void update(const Frame& frame, const Changes& changes) override {
    changed_ = changed_ || !changes.empty();
    const std::span<const Aabb> bounds = frame.objects.bounds;
    for (const ObjectId object : changes.hidden) {
      tree_.remove(object);
      hidden_[object] = 1;
    }
    for (const ObjectId object : changes.moved) {
      if (hidden_[object] == 0) tree_.move(object, bounds[object]);
    }
    for (const ObjectId object : changes.shown) {
      tree_.insert(object, bounds[object]);
      hidden_[object] = 0;
    }
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    kept_.clear();
    tree_.cull(frustum_of(frame.camera), kept_);
    if (candidates.form() != Candidates::Form::everything) {
      offered_.clear();
      for (const auto run : candidates.object_runs()) {
        for (const ObjectId object : run) offered_.insert(object);
      }
      std::erase_if(kept_, [&](ObjectId object) { return !offered_.contains(object); });
    }
    out.objects(kept_);
  }

  std::size_t bytes() const override {
    return kept_.capacity() * sizeof(ObjectId) + offered_.bytes() + hidden_.capacity() +
           tree_.bytes();
  }

 private:
  void place_as_built() {
    std::vector<Aabb> bounds(scene_->object_count());
    for (ObjectId object = 0; object < bounds.size(); ++object) {
      bounds[object] =
          transformed(scene_->mesh_of(object).bounds, scene_->objects[object].transform);
    }
    tree_.build(bounds);
    hidden_.assign(hidden_.size(), 0);
    changed_ = false;
  }

  CullerInfo info_;
  const Scene* scene_ = nullptr;
  peers::BulletTree tree_;
  bool changed_ = false;  // since the scene was as built
  ObjectStamps offered_;
  std::vector<std::uint8_t> hidden_;  // by object
  std::vector<ObjectId> kept_;
};

}  // namespace

namespace cullers {

CullerEntry peer_bullet() {
  return {describe(), [](const ParameterValues&) { return std::make_unique<Bullet>(); }};
}

}  // namespace cullers
}  // namespace vislab
