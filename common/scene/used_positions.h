#pragma once

#include <vector>

#include "common/scene/scene.h"

namespace vislab {

/// The vertices that triangles use, in the mesh's frame and order: others may lie anywhere.
std::vector<glm::vec3> used_positions(const Mesh& mesh);

}  // namespace vislab
