// Meshes with fewer triangles.
#pragma once

#include <cstdint>

#include "common/scene/scene.h"

namespace vislab {

/// The mesh brought down to about `triangles` triangles, never more, by meshoptimizer's edge
/// collapse (quadric error); as it is if it has no more. Vertices keep their positions; unused ones
/// go.
Mesh simplified(const Mesh& mesh, std::uint32_t triangles);

}  // namespace vislab
