// Triangles of Quake III faces, in the lab's frame.
#pragma once

#include <cstdint>
#include <vector>

#include "common/scene/quake_file.h"
#include "common/scene/scene.h"

namespace vislab::quake {

/// Quake's frame and units to the lab's; exact (see quake_world.h).
glm::vec3 to_lab(const Vector& p);

/// Is the face drawn? Billboards are not, nor are faces that their texture marks.
bool is_drawn(const File& file, std::int32_t face);

/// One mesh of the faces that are drawn: vertices at equal positions joined, triangles in the order
/// of `faces`, counter-clockwise seen from the side that is drawn (in the file they are clockwise).
/// Patches are biquadratic Bezier surfaces, cut into 4 × 4 cells for each 3 × 3 control points.
Mesh mesh_of_faces(const File& file, const std::vector<std::int32_t>& faces);

}  // namespace vislab::quake
