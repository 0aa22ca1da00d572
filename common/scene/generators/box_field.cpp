#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/geometry/random.h"
#include "common/scene/generators/cube_lattice.h"
#include "common/scene/generators/generators.h"
#include "common/scene/orientation.h"

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

namespace {

/// Places from -1 to 1 whose distances grow from the first to the last by `growth`.
std::vector<double> cuts(std::uint32_t subdivisions, double growth) {
  std::vector<double> places{0.0};
  for (std::uint32_t i = 0; i < subdivisions; ++i) {
    const double share = subdivisions > 1 ? i / (subdivisions - 1.0) : 0.0;
    places.push_back(places.back() + std::pow(growth, share));
  }
  const double length = places.back();
  for (double& place : places) place = 2.0 * place / length - 1.0;
  places.back() = 1.0;
  return places;
}

/// A box of the shape, in a random place and, if it is wanted, orientation, clear of the origin.
/// `shape` are half sizes before scaling; `uniform` scales all axes alike.
glm::dmat4x3 random_box(const BoxFieldParameters& parameters, const glm::dvec3& shape, bool uniform,
                        Random& random) {
  while (true) {
    glm::dvec3 center;
    glm::dvec3 scale;
    for (int axis = 0; axis < 3; ++axis) {
      center[axis] = random.uniform(-parameters.extent_m, parameters.extent_m);
    }
    for (int axis = 0; axis < 3; ++axis) {
      scale[axis] = random.uniform(parameters.min_half_size_m, parameters.max_half_size_m);
    }
    if (uniform) scale = glm::dvec3(scale.x);
    const glm::dvec3 half = shape * scale;
    const double nearest = parameters.rotated ? glm::length(center) - glm::length(half)
                                              : glm::length(glm::max(glm::abs(center) - half, 0.0));
    if (nearest < parameters.clear_radius_m) continue;
    glm::dmat4x3 transform = box_transform(center, scale);
    if (parameters.rotated) {
      const glm::dmat3 turn = random_rotation(random);
      for (int axis = 0; axis < 3; ++axis) transform[axis] = turn[axis] * scale[axis];
    }
    return transform;
  }
}

}  // namespace

Mesh box_mesh(const glm::dvec3& half_size, std::uint32_t subdivisions, double density_ratio) {
  const std::vector<double> places = cuts(subdivisions, std::sqrt(density_ratio));
  CubeLattice lattice = cube_lattice(subdivisions, half_size.y == 0.0);
  Mesh mesh;
  mesh.name = "box";
  for (const glm::uvec3& at : lattice.vertices) {
    mesh.positions.emplace_back(half_size.x * places[at.x], half_size.y * places[at.y],
                                half_size.z * places[at.z]);
  }
  mesh.triangles = std::move(lattice.triangles);
  return mesh;
}

Mesh dense_cube_mesh(std::uint32_t min_triangles) {
  std::uint32_t subdivisions = 1;
  while (12 * subdivisions * subdivisions < min_triangles) ++subdivisions;
  return box_mesh(glm::dvec3(1.0), subdivisions, 1.0);
}

/// The instances' mirrors and shears, from a sequence of their own: their places do not depend on
/// it.
class Distortion {
 public:
  explicit Distortion(const BoxFieldParameters& parameters)
      : parameters_(parameters), random_(~parameters.seed) {}

  /// Half sizes of a box around a sheared one.
  glm::dvec3 reach(const glm::dvec3& half_size) const {
    return half_size + glm::dvec3(parameters_.shear * half_size.y, 0.0, 0.0);
  }
  void apply_to_next(glm::dmat4x3& transform) {
    if (parameters_.shear > 0.0) transform[1] += transform[0] * parameters_.shear;
    if (random_.uniform() < parameters_.mirrored) transform[0] = -transform[0];
  }

 private:
  const BoxFieldParameters& parameters_;
  Random random_;
};

Scene make_box_field(const BoxFieldParameters& parameters) {
  const glm::dvec3 shape(parameters.elongation, parameters.thickness, 1.0 / parameters.elongation);
  const bool plain = shape == glm::dvec3(1.0) && parameters.subdivisions == 1;
  Scene scene;
  scene.meshes.push_back(
      plain ? cube_mesh() : box_mesh(shape, parameters.subdivisions, parameters.density_ratio));
  scene.objects.reserve(parameters.count);
  Random random(parameters.seed);
  Distortion distortion(parameters);
  while (scene.objects.size() < parameters.count) {
    glm::dmat4x3 transform = random_box(parameters, distortion.reach(shape), false, random);
    distortion.apply_to_next(transform);
    scene.objects.push_back({0, transform, none_id});
  }
  return scene;
}

Scene make_mesh_field(Mesh mesh, const BoxFieldParameters& parameters) {
  const Aabb box = bounds_of(mesh.positions);
  const glm::dvec3 half = box.half_size();
  const double unit = 1.0 / std::max({half.x, half.y, half.z});
  Scene scene;
  scene.meshes.push_back(std::move(mesh));
  scene.objects.reserve(parameters.count);
  Random random(parameters.seed);
  Distortion distortion(parameters);
  while (scene.objects.size() < parameters.count) {
    glm::dmat4x3 transform = random_box(parameters, distortion.reach(half * unit), true, random);
    for (int axis = 0; axis < 3; ++axis) transform[axis] *= unit;
    distortion.apply_to_next(transform);
    transform[3] -= glm::dmat3(transform) * box.center();
    scene.objects.push_back({0, transform, none_id});
  }
  return scene;
}

}  // namespace vislab
