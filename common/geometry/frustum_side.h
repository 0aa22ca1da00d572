// Where bounding volumes lie to a view frustum, by the different tests of the literature.
//
// All tests are conservative under rounding: `outside` and `inside` are only said if they are sure,
// and what is not valid (NaN, infinite, empty) is `intersecting`. The tests on planes say `outside`
// only for volumes that are outside of one single plane; what lies outside of the frustum beyond an
// edge or a corner is `intersecting` for them. Only the exact test of boxes has no such cases.
#pragma once

#include <vector>

#include "common/geometry/bounds.h"
#include "common/geometry/frustum.h"
#include "common/geometry/oriented_box.h"

namespace vislab {

enum class Side { outside, intersecting, inside };

/// One plane. At most 8, 2 and 1 distances.
Side side_by_corners(const Plane& plane, const Aabb& box);   // Kowalka 2016, 4.3.2
Side side_by_vertices(const Plane& plane, const Aabb& box);  // Assarsson and Moeller 2000
Side side_of(const Plane& plane, const Sphere& sphere);
Side side_of(const Plane& plane, const OrientedBox& box);

/// All planes of the frustum. `planes_tested`, if given, grows by the number of planes looked at.
Side side_by_corners(const Frustum& frustum, const Aabb& box,
                     std::uint64_t* planes_tested = nullptr);
Side side_by_vertices(const Frustum& frustum, const Aabb& box,
                      std::uint64_t* planes_tested = nullptr);
Side side_of(const Frustum& frustum, const Sphere& sphere, std::uint64_t* planes_tested = nullptr);
Side side_of(const Frustum& frustum, const OrientedBox& box,
             std::uint64_t* planes_tested = nullptr);

/// The exact test: separating axes of two convex bodies (the frustum's planes, the box's axes, and
/// all cross products of their edges). `outside` exactly if box and frustum have no point in common
/// by more than rounding.
/// Source: Gottschalk, Lin and Manocha 1996 (separating axes), for frusta Greene 1994.
class ExactFrustum {
 public:
  explicit ExactFrustum(const Camera& camera);
  /// `axes_tested`, if given, grows by the number of axes looked at.
  Side side(const Aabb& box, std::uint64_t* axes_tested = nullptr) const;
  const Frustum& planes() const { return planes_; }

 private:
  struct Axis {
    glm::dvec3 direction;  // unit length
    double low, high;      // extent of the frustum along it, widened by its rounding; may be infinite
  };
  Frustum planes_;
  std::vector<Axis> axes_;
};

}  // namespace vislab
