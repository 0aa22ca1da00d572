// A sphere and a box around a view frustum, asked before its planes.
#pragma once

#include "common/geometry/bounds.h"
#include "common/geometry/camera.h"

namespace vislab::frustum_culling {

/// Idea: a box that does not touch the frustum's own bounding box or sphere is outside; that costs
///   six comparisons or one distance. It also finds boxes off the frustum's corners, which no
///   single plane excludes.
/// Guarantee: conservative; both volumes are enlarged by more than their rounding.
/// Limits: a frustum without a far plane has no such volumes: nothing is said then.
/// Source: Zachmann slide 39; Assarsson and Moeller 2000.
class MetaVolumes {
 public:
  MetaVolumes() = default;
  explicit MetaVolumes(const Camera& camera);

  /// The box lies wholly outside of the volume. Boxes that are not valid never do.
  bool outside_sphere(const Aabb& box) const {
    return bounded_ && distance_squared(box, center_) > radius_squared_ && box.valid();
  }
  bool outside_box(const Aabb& box) const {
    return bounded_ &&
           (box.min.x > high_.x || box.min.y > high_.y || box.min.z > high_.z ||
            box.max.x < low_.x || box.max.y < low_.y || box.max.z < low_.z) &&
           box.valid();
  }

 private:
  bool bounded_ = false;
  glm::dvec3 low_{0.0}, high_{0.0};
  glm::dvec3 center_{0.0};
  double radius_squared_ = 0.0;
};

}  // namespace vislab::frustum_culling
