// What a software depth buffer draws of a scene's objects: their meshes, and which of them are
// worth drawing.
#pragma once

#include <cstdint>
#include <vector>

#include "common/culler/parameters.h"
#include "common/raster/depth_raster.h"
#include "common/scene/frame.h"

namespace vislab::depth_culling {

/// One RasterMesh for each mesh of a scene, shared by its instances.
class OccluderMeshes {
 public:
  /// The scene outlives this.
  void build(const Scene& scene);
  /// All triangles of an object, as it lies in this frame; ids are those of the scene. Of solid
  /// meshes front faces only: nobody outside sees others, and to draw less is always right.
  RasterDraw of(ObjectId object, const Frame& frame) const {
    const MeshId mesh = scene_->objects[object].mesh;
    return {&meshes_[mesh],
            &frame.objects.transforms[object],
            0,
            scene_->triangle_count(object),
            scene_->first_triangle(object),
            scene_->meshes[mesh].solid};
  }
  std::size_t bytes() const;

 private:
  const Scene* scene_ = nullptr;
  std::vector<RasterMesh> meshes_;
};

/// Which visible objects are drawn into the buffer: those whose boxes cover enough of the image, as
/// long as there are triangles to spend.
class OccluderBudget {
 public:
  /// The parameters `occluder_px` and `occluder_triangles`.
  static std::vector<ParameterSpec> parameters();
  explicit OccluderBudget(const ParameterValues& values);

  double least_px() const { return least_px_; }
  /// Once a frame.
  void start() { left_ = triangles_; }
  /// May an object be drawn whose box covers so many pixels? Takes its triangles from the budget if
  /// so. Pixels are the frame's, whatever the buffer's size.
  bool take(double box_px, std::uint32_t triangles) {
    if (box_px < least_px_ || triangles > left_) return false;
    left_ -= triangles;
    return true;
  }

 private:
  double least_px_;
  std::uint64_t triangles_;
  std::uint64_t left_ = 0;
};

}  // namespace vislab::depth_culling
