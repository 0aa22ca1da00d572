// The surface of a cube as a grid on each of its sides, for what is bent out of cubes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace vislab {

/// Counter-clockwise seen from outside; sides share the vertices of their edges. Sides are in the
/// order -x, +x, -y, +y, -z, +z, squares in rows within a side, two triangles a square. Vertices
/// are numbered as the triangles come to them.
struct CubeLattice {
  std::vector<glm::uvec3> vertices;   // coordinates from 0 to n; 6 n^2 + 2 of a whole cube
  std::vector<glm::uvec3> triangles;  // 12 n^2 of a whole cube
};

/// Each edge of the cube is cut into `n` > 0; of the sides only +y if `only_top`. O(n^2).
CubeLattice cube_lattice(std::uint32_t n, bool only_top = false);

}  // namespace vislab
