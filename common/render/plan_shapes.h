// Shapes of cells, portals and objects in a plan: seen from above, or cut at a height. Points are
// (x, z) of the world, metres.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "common/scene/scene.h"

namespace vislab {

using PlanPolygon = std::vector<glm::dvec2>;
using PlanLine = std::array<glm::dvec2, 2>;

inline glm::dvec2 seen_from_above(const glm::dvec3& p) { return {p.x, p.z}; }

/// The convex hull of points, counter-clockwise with x to the right and z up; fewer than three
/// corners if all lie on a line. O(n log n).
PlanPolygon convex_hull(PlanPolygon points);

/// A region's outline from above; empty for a region without an inside. O(planes^2).
PlanPolygon outline_of(const ConvexRegion& region);

/// What a horizontal plane at `height` cuts out of a region; empty if it misses it. O(planes^2).
PlanPolygon cut_at(const ConvexRegion& region, double height);

/// Where a horizontal plane at `height` cuts a convex polygon. False if it does not, or if the
/// polygon lies in it.
bool cut_at(std::span<const glm::dvec3> polygon, double height, PlanLine& line);

}  // namespace vislab
