// Vertices at equal positions.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace vislab {

/// For each vertex the lowest vertex at the same position. Positions are the same if their bits
/// are, or if they differ in the sign of a zero only; nothing is rounded. O(n log n).
std::vector<std::uint32_t> weld_positions(const std::vector<glm::vec3>& positions);

}  // namespace vislab
