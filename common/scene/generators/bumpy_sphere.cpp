#include <cmath>
#include <utility>

#include "common/scene/generators/cube_lattice.h"
#include "common/scene/generators/generators.h"

namespace vislab {
namespace {

double radius_at(const glm::dvec3& p, Bumps bumps) {
  switch (bumps) {
    case Bumps::low:
      return 1.0 +
             0.05 * (std::sin(9.0 * p.x) * std::sin(8.0 * p.y + 1.0) * std::sin(7.0 * p.z + 2.0) +
                     0.4 * std::sin(23.0 * p.x + 3.0) * std::sin(21.0 * p.y));
    case Bumps::high:
      return 1.0 +
             0.02 * std::sin(60.0 * p.x) * std::sin(60.0 * p.y + 1.0) * std::sin(60.0 * p.z + 2.0);
    case Bumps::none:
      break;
  }
  return 1.0;
}

/// A part of a mesh, without the vertices that its triangles do not use.
Mesh part_of(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles) {
  Mesh part;
  std::vector<std::uint32_t> renumbered(positions.size(), none_id);
  for (glm::uvec3 triangle : triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      std::uint32_t& number = renumbered[triangle[corner]];
      if (number == none_id) {
        number = static_cast<std::uint32_t>(part.positions.size());
        part.positions.push_back(positions[triangle[corner]]);
      }
      triangle[corner] = number;
    }
    part.triangles.push_back(triangle);
  }
  return part;
}

}  // namespace

Mesh bumpy_sphere_mesh(const BumpySphereParameters& parameters) {
  CubeLattice lattice = cube_lattice(parameters.subdivisions);
  std::vector<glm::dvec3> directions;
  std::vector<glm::vec3> positions;
  directions.reserve(lattice.vertices.size());
  positions.reserve(lattice.vertices.size());
  for (const glm::uvec3& at : lattice.vertices) {
    const glm::dvec3 on_cube = 2.0 * glm::dvec3(at) / double(parameters.subdivisions) - 1.0;
    directions.push_back(on_cube / glm::length(on_cube));
    const double radius = radius_at(directions.back(), parameters.bumps);
    positions.emplace_back(radius * directions.back() + parameters.mesh_offset);
  }
  Mesh mesh;
  if (parameters.hole > 0.0) {
    // Archimedes: a cap's share of the sphere is that of its height.
    const double rim = 1.0 - 2.0 * parameters.hole;
    std::erase_if(lattice.triangles, [&](const glm::uvec3& t) {
      const glm::dvec3 middle = directions[t.x] + directions[t.y] + directions[t.z];
      return middle.x > rim * glm::length(middle);
    });
    mesh = part_of(positions, lattice.triangles);
  } else {
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(lattice.triangles);
  }
  mesh.name = "bumpy sphere";
  return mesh;
}

Scene make_bumpy_sphere(const BumpySphereParameters& parameters) {
  Scene scene;
  scene.meshes.push_back(bumpy_sphere_mesh(parameters));
  scene.objects.push_back({0, box_transform(-parameters.mesh_offset, glm::dvec3(1.0)), none_id});
  return scene;
}

}  // namespace vislab
