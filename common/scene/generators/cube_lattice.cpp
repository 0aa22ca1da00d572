#include "common/scene/generators/cube_lattice.h"

#include "common/scene/scene.h"

namespace vislab {
namespace {

/// Numbers the lattice points on a cube's surface from 0 to 6 n^2 + 1: the layers z = 0 and z = n
/// whole, of the others the rings.
std::size_t surface_index(const glm::uvec3& at, std::size_t n) {
  const std::size_t layer = (n + 1) * (n + 1);
  if (at.z == 0) return at.y * (n + 1) + at.x;
  if (at.z == n) return layer + at.y * (n + 1) + at.x;
  std::size_t around = 3 * n + (n - at.y);
  if (at.y == 0) {
    around = at.x;
  } else if (at.x == n) {
    around = n + at.y;
  } else if (at.y == n) {
    around = 2 * n + (n - at.x);
  }
  return 2 * layer + (at.z - 1) * 4 * n + around;
}

}  // namespace

CubeLattice cube_lattice(std::uint32_t n, bool only_top) {
  CubeLattice lattice;
  std::vector<std::uint32_t> numbers(6 * std::size_t{n} * n + 2, none_id);
  const auto vertex = [&](const glm::uvec3& at) {
    std::uint32_t& number = numbers[surface_index(at, n)];
    if (number == none_id) {
      number = static_cast<std::uint32_t>(lattice.vertices.size());
      lattice.vertices.push_back(at);
    }
    return number;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool far_side : {false, true}) {
      if (only_top && (axis != 1 || !far_side)) continue;
      // u, v and the outward normal are right-handed.
      const int u = (axis + (far_side ? 1 : 2)) % 3;
      const int v = (axis + (far_side ? 2 : 1)) % 3;
      for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < n; ++j) {
          glm::uvec3 at(0U);
          at[axis] = far_side ? n : 0;
          at[u] = i;
          at[v] = j;
          const std::uint32_t a = vertex(at);
          at[u] = i + 1;
          const std::uint32_t b = vertex(at);
          at[v] = j + 1;
          const std::uint32_t c = vertex(at);
          at[u] = i;
          const std::uint32_t d = vertex(at);
          lattice.triangles.emplace_back(a, b, c);
          lattice.triangles.emplace_back(a, c, d);
        }
      }
    }
  }
  return lattice;
}

}  // namespace vislab
