// A mesh cut in two, again and again: the boxes of its parts.
//
// Idea: the part with the largest surface is cut along an axis of the mesh, at the one of 15 places
//   an axis that leaves the two boxes the least surface, and of equals the most even ones.
//   Triangles that the cut goes through are cut too, so that long ones do not stretch the boxes.
// Guarantee: every point of every triangle lies in the box of one of a part's two halves, if it
// lies
//   in the part's box: cuts overlap, and cut triangles are grown, by far more than rounding.
// Cost: O(t) a cut for the t triangles of the part, so about O(t log parts); for preprocessing.
// Limits: places are tried by the boxes of the triangles' pieces, not by the pieces themselves.
// Source: after Mattausch, Bittner, Wimmer 2008, section 5.2; cutting triangles as Stich, Friedrich
//   and Dietrich 2009 (spatial splits) do.
#pragma once

#include <cstdint>
#include <vector>

#include "common/scene/scene.h"

namespace vislab::occlusion_culling {

struct MeshPart {
  Aabb box;                      // mesh frame
  std::uint32_t first_half = 0;  // index of one half, the other follows it; 0: not cut
};

/// Appends the parts of a mesh, at most `max_leaves` uncut ones, and returns the index of the
/// whole. Indices are those in `parts`, which must not be empty (0 is no half).
std::uint32_t cut_mesh(const Mesh& mesh, std::uint32_t max_leaves, std::vector<MeshPart>& parts);

}  // namespace vislab::occlusion_culling
