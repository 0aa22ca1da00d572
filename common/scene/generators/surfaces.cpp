#include "common/scene/generators/surfaces.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "common/geometry/random.h"
#include "common/scene/orientation.h"

namespace vislab {
namespace {

/// The rectangle of half size 1 by 1 in the plane z = 0 that faces +z.
Mesh quad_mesh() {
  Mesh mesh;
  mesh.name = "quad";
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// A regular polygon of radius 1 in the plane z = 0, as a fan.
Mesh polygon_mesh(std::uint32_t corners) {
  Mesh mesh;
  mesh.name = "polygon";
  for (std::uint32_t i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  for (std::uint32_t i = 1; i + 1 < corners; ++i) mesh.triangles.emplace_back(0, i, i + 1);
  return mesh;
}

/// quad_mesh() with these half edges about `center`.
Object quad(const glm::dvec3& center, const glm::dvec3& across, const glm::dvec3& up) {
  const glm::dvec3 normal = glm::normalize(glm::cross(across, up));
  return {0, glm::dmat4x3(across, up, normal, center), none_id};
}

Scene scene_of_quads() {
  Scene scene;
  scene.meshes.push_back(quad_mesh());
  return scene;
}

/// Places of `count` things in a row about 0, `pitch` apart.
double in_row(std::uint32_t i, std::uint32_t count, double pitch) {
  return (i + 0.5 - 0.5 * count) * pitch;
}

}  // namespace

Scene make_crossing_quads(const CrossingQuadsParameters& parameters) {
  constexpr double pitch_m = 2.5;
  constexpr double reach_m = 0.5;
  Scene scene = scene_of_quads();
  for (std::uint32_t i = 0; i < parameters.pairs; ++i) {
    const double x = in_row(i, parameters.pairs, pitch_m);
    scene.objects.push_back(quad({x, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}));
    const double right_z = -reach_m * parameters.penetration;
    scene.objects.push_back(quad({x, 0.25, 0.5 * (reach_m + right_z)},
                                 {1.0, 0.0, 0.5 * (right_z - reach_m)}, {0.0, 1.0, 0.0}));
  }
  return scene;
}

Scene make_cyclic_bars(const CyclicBarsParameters& parameters) {
  constexpr double half_length_m = 1.2;
  constexpr double half_width_m = 0.2;
  constexpr double out_m = 0.45;  // of a bar's middle from the triangle's
  Scene scene = scene_of_quads();
  const double tilt = parameters.tilt_deg * std::numbers::pi / 180.0;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 3.0;
    const glm::dvec3 out(std::cos(angle), std::sin(angle), 0.0);
    const glm::dvec3 flat(-std::sin(angle), std::cos(angle), 0.0);
    const glm::dvec3 along(flat.x * std::cos(tilt), flat.y * std::cos(tilt), std::sin(tilt));
    const glm::dvec3 middle = out * out_m + glm::dvec3(0.0, 0.0, (i - 1) * parameters.layer_m);
    scene.objects.push_back(quad(middle, out * half_width_m, along * half_length_m));
  }
  return scene;
}

Scene make_tilted_polygons(const TiltedPolygonsParameters& parameters) {
  Scene scene;
  scene.meshes.push_back(polygon_mesh(parameters.corners));
  Random random(parameters.seed);
  for (std::uint32_t i = 0; i < parameters.count; ++i) {
    glm::dvec3 center;
    for (int axis = 0; axis < 3; ++axis) {
      center[axis] = random.uniform(-parameters.extent_m, parameters.extent_m);
    }
    const glm::dmat3 turn = random_rotation(random) * parameters.size_m;
    scene.objects.push_back({0, glm::dmat4x3(turn[0], turn[1], turn[2], center), none_id});
  }
  return scene;
}

Scene make_coplanar_pair(const CoplanarPairParameters& parameters) {
  constexpr double pitch_m = 2.0;
  constexpr double half_m = 0.5;
  Scene scene = scene_of_quads();
  Random random(parameters.seed);
  for (std::uint32_t i = 0; i < parameters.pairs; ++i) {
    // A frame that is near to the world's: facing +z, turned by up to 0.3 rad.
    const glm::dmat3 frame = rotation(random_direction(random), random.uniform(0.0, 0.3));
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const glm::dvec3 axis = frame * glm::dvec3(std::cos(angle), std::sin(angle), 0.0);
    const glm::dmat3 tilted = rotation(axis, parameters.tilt_rad) * frame;
    const glm::dvec3 center(in_row(i, parameters.pairs, pitch_m), 0.0, 0.0);
    const glm::dvec3 aside = (frame[0] + frame[1]) * (0.5 * half_m);
    const Object first = quad(center - aside, frame[0] * half_m, frame[1] * half_m);
    const Object second = quad(center + aside, tilted[0] * half_m, tilted[1] * half_m);
    scene.objects.push_back(i % 2 == 0 ? first : second);
    scene.objects.push_back(i % 2 == 0 ? second : first);
  }
  return scene;
}

Scene make_scanline_fence(const ScanlineFenceParameters& parameters) {
  Scene scene = scene_of_quads();
  Random random(parameters.seed);
  const double pitch = parameters.width_m / parameters.polygons;
  for (std::uint32_t i = 0; i < parameters.polygons; ++i) {
    const glm::dvec3 center(in_row(i, parameters.polygons, pitch), 0.0,
                            -random.uniform(0.0, parameters.depth_m));
    scene.objects.push_back(quad(center, {0.5 * pitch * parameters.overlap, 0.0, 0.0},
                                 {0.0, 0.5 * parameters.height_m, 0.0}));
  }
  return scene;
}

Scene make_touching_spans(const TouchingSpansParameters& parameters) {
  constexpr double pitch_m = 0.5;
  constexpr double half_height_m = 0.2;
  constexpr double slope = 0.5;
  Scene scene = scene_of_quads();
  for (std::uint32_t i = 0; i < parameters.pairs; ++i) {
    const double y = in_row(i, parameters.pairs, pitch_m);
    const glm::dvec3 up(0.0, half_height_m, 0.0);
    const Object farther = quad({0.5, y, -0.5 * slope}, {0.5, 0.0, -0.5 * slope}, up);
    const Object nearer =
        quad({0.5, y, parameters.depth_difference_m + 0.5 * slope}, {0.5, 0.0, 0.5 * slope}, up);
    scene.objects.push_back(i % 2 == 0 ? nearer : farther);
    scene.objects.push_back(i % 2 == 0 ? farther : nearer);
  }
  return scene;
}

}  // namespace vislab
