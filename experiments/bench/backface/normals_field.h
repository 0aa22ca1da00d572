// A scene to measure normal masks on: normals in all directions, spread evenly over the view.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "common/geometry/camera.h"
#include "common/geometry/random.h"
#include "common/scene/scene.h"

namespace vislab {

struct NormalsField {
  Scene scene;
  Camera camera;
};

/// A turn, all of them equally likely.
inline glm::dmat3 random_turn(Random& random) {
  // A unit quaternion from a point of the ball.
  glm::dvec4 q;
  double length = 0.0;
  do {
    for (int k = 0; k < 4; ++k) q[k] = random.uniform(-1.0, 1.0);
    length = glm::length(q);
  } while (length > 1.0 || length < 1e-3);
  q /= length;
  const glm::dvec3 axis(q);
  glm::dmat3 turn(1.0);
  for (int column = 0; column < 3; ++column) {
    glm::dvec3& v = turn[column];
    v += 2.0 * glm::cross(axis, glm::cross(axis, v) + q.w * v);
  }
  return turn;
}

/// A solid mesh of `tetrahedra` regular tetrahedra, each turned at random, in a lattice about 1e-4
/// wide: seen from afar it is a point with normals in all directions.
inline Mesh turned_tetrahedra(int tetrahedra, Random& random) {
  const int edge = static_cast<int>(std::ceil(std::cbrt(tetrahedra)));
  const double pitch = 1e-4 / edge;
  const std::array<glm::dvec3, 4> corners{glm::dvec3(1, 1, 1), glm::dvec3(1, -1, -1),
                                          glm::dvec3(-1, 1, -1), glm::dvec3(-1, -1, 1)};
  Mesh mesh;
  for (int i = 0; i < tetrahedra; ++i) {
    const glm::dmat3 turn = random_turn(random);
    const glm::dvec3 middle =
        pitch * (glm::dvec3(i % edge, i / edge % edge, i / edge / edge) - 0.5 * (edge - 1));
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::dvec3& corner : corners) {
      mesh.positions.emplace_back(middle + 0.25 * pitch * (turn * corner));
    }
    for (const glm::uvec3 triangle :
         {glm::uvec3(0, 1, 2), glm::uvec3(0, 3, 1), glm::uvec3(0, 2, 3), glm::uvec3(1, 3, 2)}) {
      mesh.triangles.push_back(triangle + first);
    }
  }
  return mesh;
}

/// That mesh, turned at random and moved somewhere into each of cells x cells parts of a square
/// view of `fov_deg`: all places of the image count the same, and so do all directions of normals
/// and all ways that the classes of normals can lie to the view.
inline NormalsField normals_field(double fov_deg, int cells, int tetrahedra, std::uint64_t seed) {
  Random random(seed);
  NormalsField field;
  const double half = std::tan(fov_deg * std::numbers::pi / 360.0);
  const double near_m = 0.1;
  field.camera.lens = {Projection::perspective, -half * near_m, half * near_m, -half * near_m,
                       half * near_m,           near_m,         100.0};
  field.scene.meshes = {turned_tetrahedra(tetrahedra, random)};
  for (int i = 0; i < cells * cells; ++i) {
    const glm::dmat3 turn = random_turn(random);
    const double x = half * (2.0 * (i % cells + random.uniform()) / cells - 1.0);
    const double y = half * (2.0 * (i / cells + random.uniform()) / cells - 1.0);
    const glm::dvec3 place = glm::dvec3(x, y, -1.0) * random.uniform(1.0, 2.0);
    field.scene.objects.push_back({0, {turn[0], turn[1], turn[2], place}, none_id});
  }
  field.scene.finish();
  return field;
}

}  // namespace vislab
