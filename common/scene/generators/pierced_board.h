// Boards with openings: what walls and floors of generated buildings are made of.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "common/scene/scene.h"

namespace vislab {

/// Corners of an opening in the board's plane, counter-clockwise; convex.
using BoardOpening = std::vector<glm::dvec2>;

/// A board about the origin: its sides are at z = +-half_thickness, and it reaches from `min` to
/// `max` in x and y. It is closed, and solid but where openings have no area. The openings must lie
/// inside the board and, sorted along x, be divided by upright lines. O(openings^2).
Mesh pierced_board_mesh(const glm::dvec2& min, const glm::dvec2& max, double half_thickness,
                        std::vector<BoardOpening> openings);

/// Triangles that fill what lies between a convex outline and a convex opening inside of it, both
/// counter-clockwise; counter-clockwise too. Corner i of the outline has the number i, corner j of
/// the opening the outline's size + j. No triangle has an edge on an edge of both.
std::vector<std::array<std::size_t, 3>> triangles_between(const std::vector<glm::dvec2>& outline,
                                                          const BoardOpening& opening);

}  // namespace vislab
