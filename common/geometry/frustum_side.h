// Where bounding volumes lie to a view frustum, by the different tests of the literature.
//
// All tests are conservative under rounding: `outside` and `inside` are only said if they are sure,
// and what is not valid (NaN, infinite, empty) is `intersecting`. The tests on planes say `outside`
// only for volumes that are outside of one single plane; what lies outside of the frustum beyond an
// edge or a corner is `intersecting` for them. Only the exact test of boxes has no such cases.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/geometry/bounds.h"
#include "common/geometry/frustum.h"
#include "common/geometry/oriented_box.h"

namespace vislab {

enum class Side { outside, intersecting, inside };

/// One plane: at most 8 distances, one for each corner. `outside` if all corners surely are, each
/// with the error of its own distance; so it never excludes more than the p-vertex, but in doubt
/// less. Source: Kowalka 2016, 4.3.2.
Side side_by_corners(const Plane& plane, const Aabb& box);

/// One plane, at most 2 distances: `outside` is surely_outside() and `inside` is surely_inside().
/// Source: Assarsson and Moeller 2000.
inline Side side_by_vertices(const Plane& plane, const Aabb& box) {
  if (surely_outside(plane, box)) return Side::outside;
  return surely_inside(plane, box) ? Side::inside : Side::intersecting;
}

/// One plane, one distance.
Side side_of(const Plane& plane, const Sphere& sphere);
Side side_of(const Plane& plane, const OrientedBox& box);

/// All planes of the frustum, in their order; the first that the volume is outside of ends the
/// test. `planes_tested`, if given, grows by the number of planes looked at.
Side side_by_corners(const Frustum& frustum, const Aabb& box,
                     std::uint64_t* planes_tested = nullptr);
Side side_by_vertices(const Frustum& frustum, const Aabb& box,
                      std::uint64_t* planes_tested = nullptr);
Side side_of(const Frustum& frustum, const Sphere& sphere, std::uint64_t* planes_tested = nullptr);
Side side_of(const Frustum& frustum, const OrientedBox& box,
             std::uint64_t* planes_tested = nullptr);

/// The exact test: separating axes of two convex bodies (the frustum's planes, the box's axes, and
/// all cross products of their edges). `outside` exactly if box and frustum have no point in common
/// by more than rounding; everything that is outside of a plane by side_by_vertices() is outside
/// here, and `inside` is the same as there.
///
/// Extents are measured from the eye, so that far from the origin they lose no more than the box's
/// own distance from the eye costs. At most 6 planes and 3 + 18 axes (3 + 9 if orthographic). The
/// pose must be orthonormal but for rounding.
/// Source: Gottschalk, Lin and Manocha 1996 (separating axes), for frusta Greene 1994.
class ExactFrustum {
 public:
  explicit ExactFrustum(const Camera& camera);
  /// `axes_tested`, if given, grows by the number of planes and axes looked at.
  Side side(const Aabb& box, std::uint64_t* axes_tested = nullptr) const;
  const Frustum& planes() const { return planes_; }

 private:
  /// The frustum's points at depth t reach from offset_low + slope_low * t to
  /// offset_high + slope_high * t along the axis, measured from the eye.
  struct Axis {
    glm::dvec3 direction;  // unit length
    double offset_low, offset_high;
    double slope_low, slope_high;
  };
  void add_axis(const glm::dvec3& direction);
  bool separates(const Axis& axis, const glm::dvec3& center, const glm::dvec3& half, double depth,
                 double error) const;

  Frustum planes_;
  Pose pose_;
  Lens lens_;
  // Sizes that the rounding of the extents is measured by: of the terms that the offsets are sums
  // of, metres, and of those that the slopes are sums of.
  double offset_size_ = 0.0;
  double slope_size_ = 1.0;
  std::array<Axis, 3 + 3 * 6> axes_{};  // no allocation: it is made once a frame
  std::size_t axis_count_ = 0;
};

}  // namespace vislab
