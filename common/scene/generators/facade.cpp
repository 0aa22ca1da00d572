// Buildings whose walls are full of windows, as heavy as is wanted.
#include <array>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "common/scene/generators/generators.h"

namespace vislab {
namespace {

/// Collects triangles over vertices that are shared where they are equal.
class Facade {
 public:
  /// Walls of `windows` by `windows` windows, with as much wall between them as they are wide.
  explicit Facade(std::uint32_t windows) : cells_(2 * windows + 1) {
    mesh_.name = "building with windows";
    for (int turns = 0; turns < 4; ++turns) add_side(turns);
  }

  Mesh take() { return std::move(mesh_); }

 private:
  float line(std::uint32_t i) const { return -1.0F + 2.0F * i / static_cast<float>(cells_); }

  /// A point of the wall that faces +z, behind it by `depth`, turned about the vertical by
  /// quarters.
  std::uint32_t vertex(int turns, std::uint32_t along, std::uint32_t up, float depth = 0.0F) {
    const float u = line(along);
    const float y = line(up);
    const float out = 1.0F - depth;
    switch (turns) {
      case 0:
        return number_of({u, y, out});
      case 1:
        return number_of({out, y, -u});
      case 2:
        return number_of({-u, y, -out});
      default:
        return number_of({-out, y, u});
    }
  }

  std::uint32_t number_of(const std::array<float, 3>& p) {
    const auto [found, is_new] =
        numbers_.try_emplace(p, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (is_new) mesh_.positions.emplace_back(p[0], p[1], p[2]);
    return found->second;
  }

  void quad(const std::array<std::uint32_t, 4>& corners) {
    mesh_.triangles.emplace_back(corners[0], corners[1], corners[2]);
    mesh_.triangles.emplace_back(corners[0], corners[2], corners[3]);
  }

  /// A wall, and its quarters of the roof and the floor, fanned to the wall's grid lines.
  void add_side(int turns) {
    for (std::uint32_t j = 0; j < cells_; ++j) {
      for (std::uint32_t i = 0; i < cells_; ++i) add_cell(turns, i, j, i % 2 == 1 && j % 2 == 1);
    }
    const std::uint32_t roof = number_of({0.0F, 1.0F, 0.0F});
    const std::uint32_t floor = number_of({0.0F, -1.0F, 0.0F});
    for (std::uint32_t i = 0; i < cells_; ++i) {
      mesh_.triangles.emplace_back(vertex(turns, i, cells_), vertex(turns, i + 1, cells_), roof);
      mesh_.triangles.emplace_back(floor, vertex(turns, i + 1, 0), vertex(turns, i, 0));
    }
  }

  void add_cell(int turns, std::uint32_t i, std::uint32_t j, bool window) {
    constexpr float sunk = 0.04F;
    const std::array<std::uint32_t, 4> outer{vertex(turns, i, j), vertex(turns, i + 1, j),
                                             vertex(turns, i + 1, j + 1), vertex(turns, i, j + 1)};
    if (!window) return quad(outer);
    const std::array<std::uint32_t, 4> inner{
        vertex(turns, i, j, sunk), vertex(turns, i + 1, j, sunk), vertex(turns, i + 1, j + 1, sunk),
        vertex(turns, i, j + 1, sunk)};
    quad(inner);
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t next = (k + 1) % 4;
      quad({outer[k], outer[next], inner[next], inner[k]});
    }
  }

  std::uint32_t cells_;
  Mesh mesh_;
  std::map<std::array<float, 3>, std::uint32_t> numbers_;
};

}  // namespace

Mesh facade_mesh(std::uint32_t min_triangles) {
  std::uint32_t windows = 1;
  while (64 * windows * windows + 48 * windows + 16 < min_triangles) ++windows;
  return Facade(windows).take();
}

}  // namespace vislab
