// Meshes that are the surfaces of solids: closed, outward and free of self-intersection.
#pragma once

#include "common/scene/scene.h"

namespace vislab {

/// Is the surface of a mesh free of self-intersection? For meshes that are closed outward
/// (is_closed_outward) only; others may give either answer. Exact: positions are compared and
/// intersected as they are, vertices at equal positions taken as one.
///
/// Whatever is doubtful counts as an intersection: parts that touch or overlap, vertices at which
/// parts of the surface meet in a point, and triangles without area, unless what is left without
/// them is closed. Deterministic; does not depend on the order of vertices and triangles.
///
/// O(n log n) for the surfaces of usual models; stops at the first intersection. Measured on one
/// core: bunny (75,408 triangles) 155 ms; man (34,986) 25 ms; elephant (5,558) 11 ms; hare (4,968)
/// 10 ms; cow (5,804) 1 ms.
bool is_free_of_self_intersection(const Mesh& mesh);

}  // namespace vislab
