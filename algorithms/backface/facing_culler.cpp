#include "algorithms/backface/facing_culler.h"

#include <algorithm>
#include <optional>

#include "common/geometry/frustum.h"

namespace vislab::backface_culling {

ParameterSpec open_parameter() {
  return ParameterSpec::choice(
      "open", "two_sided", {"two_sided", "cull"}, ParameterSpec::Stage::build,
      "what to do with meshes that are not solid (open, or crossing themselves): two_sided keeps "
      "them whole; cull tests them too and loses what is seen from behind");
}

bool culls_open(const ParameterValues& values) { return values.choice("open") == "cull"; }

FacingCuller::FacingCuller(CullerInfo info, bool cull_open)
    : cull_open_(cull_open), info_(std::move(info)) {
  if (cull_open_) info_.guarantee = std::max(info_.guarantee, Guarantee::approximate);
}

void FacingCuller::build(const Scene& scene, const BuildContext& context) {
  scene_ = &scene;
  meshes_.clear();
  clear();
  for (MeshId id = 0; id < scene.meshes.size(); ++id) {
    const Mesh& mesh = scene.meshes[id];
    meshes_.push_back({mesh.solid || cull_open_, MeshFrame(mesh)});
    if (meshes_.back().tested) add_mesh(id, mesh, meshes_.back().frame, context);
  }
  finish();
}

void FacingCuller::cull(const Frame& frame, const Candidates& candidates, DrawSink& out) {
  kept_.clear();
  begin(frame);
  ObjectId object = none_id;
  std::optional<ObjectView> view;
  std::span<const std::uint64_t> whole;
  for_each_range(candidates, frame, *scene_, [&](const TriangleRange& offered) {
    if (offered.object != object) {
      object = offered.object;
      view.reset();
      const MeshId mesh = scene_->objects[object].mesh;
      if (meshes_[mesh].tested &&
          !touches_near_region(frame.camera, frame.objects.bounds[object])) {
        const std::optional<MeshEye> eye =
            eye_in_mesh(frame.camera, frame.objects.transforms[object], meshes_[mesh].frame);
        if (eye) {
          view.emplace(frame, object, mesh, *eye);
          whole = mark_mesh(*view);
        }
      }
    }
    if (!view) {
      kept_.push_back(offered);
    } else if (!whole.empty()) {
      append_kept(offered, whole, 0, kept_);
    } else {
      back_.resize(std::max(back_.size(), words_of(offered.count)));
      mark_range(*view, offered.first, offered.count, back_.data());
      append_kept(offered, back_, offered.first, kept_);
    }
  });
  out.ranges(kept_);
}

std::size_t FacingCuller::bytes() const {
  return meshes_.capacity() * sizeof(TestedMesh) + mesh_bytes();
}

}  // namespace vislab::backface_culling
