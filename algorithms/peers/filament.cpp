// peer.filament: the frustum culler of Google's Filament 1.9.25, as Debian packages it.
//
// Idea: boxes as centres and half sizes in structure-of-arrays order, compared with six planes in a
//   loop without branches that the compiler vectorises; a byte an object.
// Guarantee: approximate. Everything is float in world coordinates, without an error bound: boxes
//   within rounding of a plane may go. The scene's boxes lose up to an ulp when they become centres
//   and half sizes.
// Cost: O(objects), also for a few candidates.
// Limits: none of its errors grows beyond float rounding, which is large far from the origin.
// Source: github.com/google/filament, filament/src/Culler.cpp (called, not copied).

#include "algorithms/peers/filament_boxes.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

CullerInfo describe() {
  CullerInfo info;
  info.name = "peer.filament";
  info.family = "peer";
  info.summary =
      "The box culler of Google's Filament 1.9.25 (Debian's libfilament1.9): one vectorised loop "
      "over centres and half sizes against six planes.";
  info.guarantee = Guarantee::approximate;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::object;
  info.culls = Culls::outside_frustum;
  info.space = Space::object;
  info.stage = PipelineStage::application;
  info.cost = "O(objects): six planes each, whatever the candidates";
  info.limits =
      "Float without an error bound: boxes that touch the frustum within rounding may be left out, "
      "the more so the farther the scene is from the origin.";
  info.sources = {"Filament 1.9.25, https://github.com/google/filament"};
  return info;
}

class Filament : public ICuller {
 public:
  Filament() : info_(describe()) {}
  const CullerInfo& info() const override { return info_; }

  void build(const Scene& scene, const BuildContext&) override {
    scene_ = &scene;
    kept_.reserve(scene.object_count());
    place_as_built();
  }

  void reset(std::uint64_t) override {
    if (moved_) place_as_built();
  }

  void update(const Frame& frame, const Changes& changes) override {
    moved_ = moved_ || !changes.moved.empty();
    for (const ObjectId object : changes.moved) boxes_.move(object, frame.objects.bounds[object]);
  }

  void cull(const Frame& frame, const Candidates& candidates, DrawSink& out) override {
    const std::span<const std::uint8_t> in = boxes_.cull(frame.camera);
    kept_.clear();
    for_each_object_run(candidates, frame, [&](std::span<const ObjectId> run) {
      for (const ObjectId object : run) {
        if (in[object] != 0) kept_.push_back(object);
      }
    });
    out.objects(kept_);
  }

  std::size_t bytes() const override {
    return kept_.capacity() * sizeof(ObjectId) + boxes_.bytes();
  }

 private:
  void place_as_built() {
    std::vector<Aabb> bounds(scene_->object_count());
    for (ObjectId object = 0; object < bounds.size(); ++object) {
      bounds[object] =
          transformed(scene_->mesh_of(object).bounds, scene_->objects[object].transform);
    }
    boxes_.build(bounds);
    moved_ = false;
  }

  CullerInfo info_;
  const Scene* scene_ = nullptr;
  peers::FilamentBoxes boxes_;
  bool moved_ = false;  // since the scene was as built
  std::vector<ObjectId> kept_;
};

}  // namespace

namespace cullers {

CullerEntry peer_filament() {
  return {describe(), [](const ParameterValues&) { return std::make_unique<Filament>(); }};
}

}  // namespace cullers
}  // namespace vislab
