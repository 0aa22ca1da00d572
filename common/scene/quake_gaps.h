// Gaps in what a Quake III world draws: solid leaves that can be looked through.
//
// Portals, and the file's own visible sets, take it that what is solid hides. Compilers leave out
// faces that nobody should see, and worlds have mistakes: where a solid leaf has bare faces on
// several sides, sight goes in here and out there, past all portals.
#pragma once

#include <cstddef>

#include "common/scene/quake_leaves.h"

namespace vislab {

/// How many solid leaves have, in two planes or more, faces towards open leaves that triangles of
/// the world cover but for more than ten square centimetres. Gaps through several solid leaves are
/// not found. O(faces · triangles near them).
std::size_t count_see_through_leaves(const Scene& scene, const QuakeWorld& world,
                                     const LeafShapes& shapes);

}  // namespace vislab
