#include <cmath>

#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"

namespace vislab {

Mesh cube_mesh() {
  Mesh mesh;
  mesh.name = "cube";
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back((i & 1) != 0 ? 1.0F : -1.0F, (i & 2) != 0 ? 1.0F : -1.0F,
                                (i & 4) != 0 ? 1.0F : -1.0F);
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

glm::dmat4x3 box_transform(const glm::dvec3& center, const glm::dvec3& half_size) {
  glm::dmat4x3 transform(0.0);
  for (int axis = 0; axis < 3; ++axis) transform[axis][axis] = half_size[axis];
  transform[3] = center;
  return transform;
}

Scene make_box_field(const BoxFieldParameters& parameters) {
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  scene.objects.reserve(parameters.count);
  Random random(parameters.seed);
  while (scene.objects.size() < parameters.count) {
    glm::dvec3 center;
    glm::dvec3 half_size;
    for (int axis = 0; axis < 3; ++axis) {
      center[axis] = random.uniform(-parameters.extent_m, parameters.extent_m);
    }
    for (int axis = 0; axis < 3; ++axis) {
      half_size[axis] = random.uniform(parameters.min_half_size_m, parameters.max_half_size_m);
    }
    const glm::dvec3 gap = glm::max(glm::abs(center) - half_size, 0.0);
    if (glm::length(gap) < parameters.clear_radius_m) continue;
    scene.objects.push_back({0, box_transform(center, half_size), none_id});
  }
  return scene;
}

}  // namespace vislab
