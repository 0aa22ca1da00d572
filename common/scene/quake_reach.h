// Which leaves of a Quake III world's tree triangles reach into.
//
// The file lists faces by leaf, but a world's objects are drawn otherwise than its compiler saw
// them: patches are cut into triangles here, and corners were rounded to fractions of a unit after
// the tree was made. So triangles are pushed down the tree once more.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "common/scene/quake_world.h"

namespace vislab {

/// A triangle that lies this near to a plane of the tree, all of it, is on both sides: an eighth of
/// a Quake unit, to which compilers round corners.
inline constexpr double on_plane_m = quake_unit_m / 8.0;

/// Adds the leaves that are not solid and that a triangle in the world reaches into; in no order,
/// some of them more than once. O(depth) if it is small.
void add_leaves_reached(const QuakeWorld& world, const std::array<glm::dvec3, 3>& triangle,
                        std::vector<std::uint32_t>& leaves);

}  // namespace vislab
