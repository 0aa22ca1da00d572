// Convex regions: the stones that cells are made of (scene.h).
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/convex_polygon.h"
#include "common/scene/scene.h"

namespace vislab {

/// Of unit normals that point inward. Its box holds the region; a region without an inside, or that
/// is not bounded within max_scene_coordinate_m, is none. O(planes^2).
std::optional<ConvexRegion> region_inside(std::vector<Plane> planes);

/// An axis-aligned box; min < max on every axis.
ConvexRegion box_region(const glm::dvec3& min, const glm::dvec3& max);

/// The block between a convex polygon moved along `reach` times its unit normal and the polygon
/// itself; the normal is on the side from which the corners run counter-clockwise. A negative reach
/// is the other side.
ConvexRegion prism_region(const ConvexPolygon& polygon, double reach);

/// Is the point inside all planes moved outward by `slack`, metres?
bool contains(const ConvexRegion& region, const glm::dvec3& point, double slack);

/// The polygons of the surface, counter-clockwise seen from inside; none for planes without an
/// inside. `reach` (metres) is farther than any corner from `around`. O(planes^2).
std::vector<ConvexPolygon> surface_of(const std::vector<Plane>& planes, const glm::dvec3& around,
                                      double reach);

/// A point of what two regions share if it is at least `depth` (metres) thick, by both regions'
/// planes moved inward by half of it.
std::optional<glm::dvec3> shared_point(const ConvexRegion& a, const ConvexRegion& b, double depth);

/// Cuts a polygon to what lies inside the planes moved outward by `slack`; empty if nothing does.
ConvexPolygon clipped(ConvexPolygon polygon, const ConvexRegion& region, double slack);

}  // namespace vislab
