// Small meshes and frames for the tests of the drawing layer.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "common/scene/frame.h"

namespace vislab::test {

/// A cube of side 1 around the origin, 12 triangles, outward.
inline Mesh cube_mesh() {
  Mesh mesh;
  mesh.name = "cube";
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back(
        {(i & 1) != 0 ? 0.5F : -0.5F, (i & 2) != 0 ? 0.5F : -0.5F, (i & 4) != 0 ? 0.5F : -0.5F});
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

/// A square of side 1 in the plane z = 0, facing +z, of 2 * cells * cells triangles.
inline Mesh square_mesh(std::uint32_t cells = 1) {
  Mesh mesh;
  mesh.name = "square";
  const auto step = 1.0F / static_cast<float>(cells);
  for (std::uint32_t y = 0; y <= cells; ++y) {
    for (std::uint32_t x = 0; x <= cells; ++x) {
      mesh.positions.push_back(
          {static_cast<float>(x) * step - 0.5F, static_cast<float>(y) * step - 0.5F, 0.0F});
    }
  }
  for (std::uint32_t y = 0; y < cells; ++y) {
    for (std::uint32_t x = 0; x < cells; ++x) {
      const std::uint32_t a = y * (cells + 1) + x;
      const std::uint32_t b = a + cells + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  }
  return mesh;
}

inline Object object_at(MeshId mesh, const glm::dvec3& position, double scale = 1.0) {
  Object object;
  object.mesh = mesh;
  object.transform = glm::dmat4x3(scale);
  object.transform[3] = position;
  return object;
}

/// Looks from the origin along -z with a 60 degree lens.
inline Frame frame_of(const SceneState& state, const Viewport& viewport) {
  Frame frame;
  frame.viewport = viewport;
  frame.camera.lens = perspective_lens(1.0471975511965976, viewport.aspect(), 0.1, 100.0);
  frame.objects = state.view();
  return frame;
}

/// A wall of squares at z = -4, a cube before it and one behind it.
inline Scene wall_and_cubes() {
  Scene scene;
  scene.meshes = {square_mesh(4), cube_mesh()};
  scene.objects = {object_at(0, {0.0, 0.0, -4.0}, 2.0), object_at(1, {0.3, 0.2, -3.0}, 0.5),
                   object_at(1, {0.0, 0.0, -6.0}, 0.5), object_at(1, {2.0, 0.0, -6.0}, 0.7)};
  scene.finish();
  return scene;
}

}  // namespace vislab::test
