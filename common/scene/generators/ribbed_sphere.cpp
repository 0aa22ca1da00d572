#include <cmath>
#include <numbers>

#include "common/scene/generators/generators.h"

namespace vislab {

Mesh ribbed_sphere_mesh(std::uint32_t meridians, std::uint32_t parallels, std::uint32_t ribs) {
  constexpr double flatness = 0.75;
  constexpr double furrow = 0.15;
  Mesh mesh;
  mesh.name = "ribbed sphere";
  mesh.positions.emplace_back(0.0, flatness, 0.0);
  for (std::uint32_t j = 1; j <= parallels; ++j) {
    const double polar = std::numbers::pi * j / (parallels + 1);
    for (std::uint32_t i = 0; i < meridians; ++i) {
      const double longitude = 2.0 * std::numbers::pi * i / meridians;
      const double bulge = std::abs(std::cos(0.5 * ribs * longitude));
      const double radius = 1.0 - furrow * std::sin(polar) * (1.0 - bulge);
      const double flat = radius * std::sin(polar);
      mesh.positions.emplace_back(flat * std::cos(longitude), radius * flatness * std::cos(polar),
                                  -flat * std::sin(longitude));
    }
  }
  const auto south = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.emplace_back(0.0, -flatness, 0.0);
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) {
    return 1 + j * meridians + i % meridians;
  };
  for (std::uint32_t i = 0; i < meridians; ++i) {
    mesh.triangles.emplace_back(0, vertex(i, 0), vertex(i + 1, 0));
    for (std::uint32_t j = 0; j + 1 < parallels; ++j) {
      mesh.triangles.emplace_back(vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1));
      mesh.triangles.emplace_back(vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j));
    }
    mesh.triangles.emplace_back(vertex(i, parallels - 1), south, vertex(i + 1, parallels - 1));
  }
  return mesh;
}

}  // namespace vislab
