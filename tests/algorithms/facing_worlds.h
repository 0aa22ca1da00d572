// Solids, placed in every way, and eyes that are hard for tests of back faces: in the planes of
// triangles, on the lines of edges, at vertices, grazing, far away. The same for the same seed
// everywhere. Test-only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/random.h"
#include "common/scene/generators/generators.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"

namespace vislab::test {

inline glm::dvec3 vector_in(Random& random, double reach) {
  const double x = random.uniform(-reach, reach);
  const double y = random.uniform(-reach, reach);
  return {x, y, random.uniform(-reach, reach)};
}

/// Vertices on a grid, so that points in their triangles' planes can be told exactly.
inline Mesh snapped(Mesh mesh) {
  for (glm::vec3& position : mesh.positions) position = glm::round(position * 1024.0F) / 1024.0F;
  return mesh;
}

/// A random linear map: turned, sheared, scaled, half of them mirrored, some so flat that their
/// inverse loses digits. With `exact`, of few binary digits and not flat.
inline glm::dmat3 linear_map(Random& random, bool exact) {
  glm::dmat3 linear;
  do {
    for (int i = 0; i < 9; ++i) {
      const double value = random.uniform(-2.0, 2.0);
      linear[i / 3][i % 3] = exact ? std::round(value * 4.0) / 4.0 : value;
    }
  } while (std::abs(glm::determinant(linear)) < 0.3);
  if (!exact && random.below(3) == 0) {
    linear[2] = linear[0] * random.uniform(-1.0, 1.0) + linear[1] * random.uniform(-1.0, 1.0) +
                linear[2] * std::pow(10.0, random.uniform(-6.0, -2.0));
  }
  return linear;
}

/// Triangles that have nothing to do with each other, also slivers. Not solid.
inline Mesh triangle_soup(Random& random, std::uint32_t triangles) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const double size = std::exp2(random.uniform(-12.0, 0.0));
    const glm::dvec3 middle = vector_in(random, 1.0);
    for (int corner = 0; corner < 3; ++corner) {
      mesh.positions.emplace_back(middle + vector_in(random, size));
    }
    if (random.below(8) == 0) {
      mesh.positions.back() =
          mesh.positions[mesh.positions.size() - 2] + glm::vec3(vector_in(random, 1e-6 * size));
    }
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  return mesh;
}

/// What the meshes of a world are like.
enum class MeshKind {
  ordinary,  // about 1 m, at most 300 triangles
  tiny,      // coordinates of 1e-44 to 1e-36 in their own frame, near the end of float
  huge,      // of 1e30 to 1e37
  fine       // two objects of thousands of triangles, so that clusters hold tens
};

/// A bumpy sphere of 12 n^2 triangles; with `solid` false it lacks one.
inline Mesh fine_mesh(std::uint32_t n, Bumps bumps, bool solid) {
  BumpySphereParameters parameters;
  parameters.subdivisions = n;
  parameters.bumps = bumps;
  Mesh mesh = bumpy_sphere_mesh(parameters);
  if (!solid) mesh.triangles.pop_back();
  return mesh;
}

/// Takes coordinates to one of the ends of float, by a power of two. Returns that.
inline double shrink_or_grow(Mesh& mesh, MeshKind kind, Random& random) {
  const double exponent =
      kind == MeshKind::tiny ? random.uniform(-146.0, -120.0) : random.uniform(100.0, 123.0);
  const double scale = std::exp2(std::floor(exponent));
  for (glm::vec3& position : mesh.positions) position = glm::vec3(glm::dvec3(position) * scale);
  return scale;
}

/// Five objects (MeshKind::fine: two) about a point that is up to 1e6 m from the origin, of about
/// 1 m. With `solid` of solids, else also of triangle soup.
inline Scene facing_world(Random& random, bool exact, bool solid,
                          MeshKind kind = MeshKind::ordinary) {
  Scene scene;
  BumpySphereParameters bumpy;
  bumpy.subdivisions = 5;
  bumpy.bumps = Bumps::low;
  BumpySphereParameters far_bumpy = bumpy;
  far_bumpy.bumps = Bumps::high;
  far_bumpy.mesh_offset = {3000.0, -200.0, 70.0};
  scene.meshes = {cube_mesh(), sphere_mesh(5), bumpy_sphere_mesh(bumpy)};
  if (exact) {
    for (Mesh& mesh : scene.meshes) mesh = snapped(std::move(mesh));
  } else if (kind == MeshKind::ordinary) {
    scene.meshes.push_back(bumpy_sphere_mesh(far_bumpy));
  }
  if (!solid) scene.meshes = {triangle_soup(random, 150), sphere_mesh(4)};
  if (kind == MeshKind::fine) {
#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
    constexpr std::uint32_t subdivisions = 14;
#else
    constexpr std::uint32_t subdivisions = 30;
#endif
    scene.meshes = {fine_mesh(subdivisions, Bumps::low, solid),
                    fine_mesh(subdivisions, Bumps::high, solid)};
  }
  std::vector<double> scales(scene.meshes.size(), 1.0);
  if (kind == MeshKind::tiny || kind == MeshKind::huge) {
    for (std::size_t i = 0; i < scales.size(); ++i) {
      scales[i] = shrink_or_grow(scene.meshes[i], kind, random);
    }
  }
  constexpr std::array<double, 3> reaches{10.0, 1e3, 1e6};
  glm::dvec3 middle = vector_in(random, reaches[random.below(reaches.size())]);
  if (exact) middle = glm::round(middle);
  const std::uint32_t objects = kind == MeshKind::fine ? 2 : 5;
  for (std::uint32_t i = 0; i < objects; ++i) {
    const auto mesh = kind == MeshKind::fine
                          ? static_cast<MeshId>(i)
                          : static_cast<MeshId>(random.below(scene.meshes.size()));
    const bool plain = random.below(4) == 0;
    const glm::dmat3 linear = plain ? glm::dmat3(1.0) : linear_map(random, exact);
    glm::dvec3 at = middle + vector_in(random, 8.0);
    if (exact) at = glm::round(at);
    if (mesh == 3) at -= linear * far_bumpy.mesh_offset;
    const glm::dmat3 placed = linear / scales[mesh];
    scene.objects.push_back({mesh, {placed[0], placed[1], placed[2], at}, none_id});
  }
  scene.finish();
  return scene;
}

/// A camera that is hard for one random triangle of the scene.
inline Camera facing_camera(Random& random, const Scene& scene) {
  const auto object = static_cast<ObjectId>(random.below(scene.object_count()));
  const Mesh& mesh = scene.mesh_of(object);
  const glm::dmat4x3& transform = scene.objects[object].transform;
  const glm::uvec3& corners = mesh.triangles[random.below(mesh.triangles.size())];
  // In the mesh's frame and then taken to the world: fewer digits are lost.
  const glm::dvec3 a(mesh.positions[corners.x]);
  const glm::dvec3 u = glm::dvec3(mesh.positions[corners.y]) - a;
  const glm::dvec3 v = glm::dvec3(mesh.positions[corners.z]) - a;
  const auto far_out = [&] {
    const double whole = static_cast<double>(8 + random.below(120));
    return random.below(2) == 0 ? whole : -whole;
  };
  // Of the mesh, as a power of two.
  const glm::dvec3 half = mesh.bounds.half_size();
  const double unit = std::exp2(std::round(std::log2(std::max({half.x, half.y, half.z}))));
  glm::dvec3 local = a;
  const std::uint64_t choice = random.below(8);
  switch (choice) {
    case 0:  // in the plane
    case 1:
      local += u * far_out() + v * far_out();
      break;
    case 2:  // on the line of an edge, in two planes
      local += u * far_out();
      break;
    case 3:  // at a vertex
      break;
    case 4:
    case 5: {  // grazing
      const glm::dvec3 normal = glm::cross(u, v);
      const double tilt = std::pow(10.0, random.uniform(-12.0, -1.0));
      local += u * far_out() + v * far_out();
      local += normal * (glm::length(local - a) * tilt * (random.below(2) == 0 ? 1.0 : -1.0) /
                         std::max(glm::length(normal), 1e-30 * unit * unit));
      break;
    }
    case 6:  // far away
      local += vector_in(random, unit) * std::pow(10.0, random.uniform(2.0, 8.0));
      break;
    default:
      local += vector_in(random, 12.0 * unit);
  }
  Camera camera;
  const glm::dvec3 eye = transform * glm::dvec4(local, 1.0);
  const glm::dvec3 target = transform * glm::dvec4(a + vector_in(random, 0.5 * unit), 1.0);
  const glm::dvec3 up = random.below(2) == 0 ? glm::dvec3(0.0, 1.0, 0.0) : vector_in(random, 1.0);
  camera.pose = look_at(eye, target, up);
  camera.lens = perspective_lens(random.uniform(0.2, 2.5), 1.0, 1e-3, 1e9);
  if (random.below(4) == 0) camera.lens.far_m = std::numeric_limits<double>::infinity();
  if (random.below(4) == 0) camera.lens.left *= random.uniform(0.1, 3.0);  // off-centre
  if (random.below(4) == 0) {
    camera.lens = orthographic_lens(20.0, 1.0, -1e9, 1e9);
    // Orthographic depth may be negative: nothing is near.
    camera.lens.near_m = -1e9;
    if (random.below(2) == 0) {
      // Along an axis of the object, in the planes of a cube's sides.
      const auto axis = static_cast<int>(random.below(3));
      const glm::dvec3 along = transform[axis];
      camera.pose = look_at(eye, eye - along * unit, up);
    }
  }
  return camera;
}

}  // namespace vislab::test
