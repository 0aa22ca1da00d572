// Convex polygons in space: planar, corners in order, double precision.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "common/geometry/bounds.h"

namespace vislab {

using ConvexPolygon = std::vector<glm::dvec3>;

/// A square on the plane, counter-clockwise seen from its inside: its middle is the point of the
/// plane that is nearest to `around`, its sides are 2 `reach` long.
ConvexPolygon square_on(const Plane& plane, const glm::dvec3& around, double reach);

/// The two sides of a divided polygon. A side without a corner beyond the tolerance is empty; both
/// are if the polygon lies in the plane.
struct PolygonHalves {
  ConvexPolygon inside, outside;
};

/// Divides a polygon by a plane. Corners within `tolerance` (metres) of the plane count as lying on
/// it and belong to both sides. O(corners).
PolygonHalves divided(const ConvexPolygon& polygon, const Plane& plane, double tolerance);

/// Twice the area times the unit normal towards the side from which the corners run
/// counter-clockwise (Newell); metres squared.
glm::dvec3 area_vector(const ConvexPolygon& polygon);

/// Metres squared.
inline double area(const ConvexPolygon& polygon) { return 0.5 * glm::length(area_vector(polygon)); }

}  // namespace vislab
