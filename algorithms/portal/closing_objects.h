// Objects that cells are closed by where they have no portal: walls, floors, ceilings.
//
// What portals and sets say holds while these stand where the scene puts them. Where one has been
// taken away, a view of its place may show anything.
#pragma once

#include <cstdint>
#include <vector>

#include "common/scene/scene.h"

namespace vislab::portal_culling {

/// By object: has it a triangle in or behind a boundary of a cell that lists it, and not turned
/// away from that cell? Furniture has none: what it stands on the floor with faces the floor. Of
/// meshes that are not closed both sides count. O(triangles of the listed objects * planes of their
/// cells).
std::vector<std::uint8_t> find_closing_objects(const Scene& scene);

}  // namespace vislab::portal_culling
