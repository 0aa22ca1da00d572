// Says in exact arithmetic where volumes lie to the frustum of a camera. For property tests.
#pragma once

#include <array>
#include <glm/mat4x3.hpp>
#include <memory>

#include "common/geometry/bounds.h"
#include "common/geometry/camera.h"
#include "common/geometry/oriented_box.h"

namespace vislab::test {

/// The frustum is exact in the doubles of pose and lens: the half-spaces of the planes
/// (right * near - forward * left) . (p - eye) >= 0 and so on, of any length. Touching is neither
/// outside nor disjoint, and is inside. Volumes must be valid.
///
/// Intervals decide first, rational numbers what they leave open. Asking for disjointness first
/// costs about a millisecond. Not for several threads at once.
class ExactJudge {
 public:
  explicit ExactJudge(const Camera& camera);
  ~ExactJudge();

  /// Is every point of the volume outside of one plane?
  bool outside_of_a_plane(const Aabb& box) const;
  bool outside_of_a_plane(const Sphere& sphere) const;
  bool outside_of_a_plane(const OrientedBox& box) const;
  /// Of a triangle whose vertices the transform takes to the world, in exact arithmetic too.
  bool outside_of_a_plane(const std::array<glm::vec3, 3>& triangle,
                          const glm::dmat4x3& transform) const;

  /// Is every point of the volume inside of all planes?
  bool inside(const Aabb& box) const;
  bool inside(const Sphere& sphere) const;
  bool inside(const OrientedBox& box) const;

  /// Do box and frustum have no point in common? Asked of two frusta: the planes' and the one that
  /// the rays through the window's corners span, which differs by the rounding of the pose's axes.
  bool disjoint(const Aabb& box) const;

  /// Is some plane farther from the whole box (outside it, inside it) than `margin`, metres?
  bool clearly_outside_of_a_plane(const Aabb& box, double margin) const;
  bool clearly_inside(const Aabb& box, double margin) const;
  /// Is there an axis along which box and frustum are farther apart than `margin`, metres?
  bool clearly_disjoint(const Aabb& box, double margin) const;

 private:
  struct Frusta;
  std::unique_ptr<Frusta> frusta_;
};

}  // namespace vislab::test
