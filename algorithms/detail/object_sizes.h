// How large the objects of a scene are in the image, by the measure that a detail culler goes by.
#pragma once

#include <vector>

#include "algorithms/detail/projected_area.h"
#include "common/scene/frame.h"

namespace vislab::detail_culling {

enum class SizeMeasure {
  sphere,            // exact, of a sphere around the mesh
  box,               // exact, of the object's world box
  printed,           // the lecture's estimate from the same sphere, taken to pixels
  near_plane_units,  // the lecture's estimate as printed: square metres on the near plane
  inner_sphere       // exact, of the sphere within the world box: of nothing if the box is flat
};

/// Spheres are Ritter's around the mesh's vertices, carried along with the object.
class ObjectSizes {
 public:
  explicit ObjectSizes(SizeMeasure measure) : measure_(measure) {}

  void build(const Scene& scene);  // the scene outlives it; ready for its first frame afterwards
  void reset();                    // the objects are back where they were built
  void update(const Frame& frame, const Changes& changes);

  /// In pixels (near_plane_units: as if they were). Never less than what the object covers for
  /// `sphere` and `box`.
  double of(ObjectId object, const Frame& frame, const ProjectedArea& areas) const;

  std::size_t bytes() const;

 private:
  bool has_spheres() const;

  SizeMeasure measure_;
  const Scene* scene_ = nullptr;
  std::vector<Sphere> mesh_spheres_;  // mesh frame
  std::vector<Sphere> spheres_;       // world
  bool moved_ = false;                // since build() or reset()
};

}  // namespace vislab::detail_culling
