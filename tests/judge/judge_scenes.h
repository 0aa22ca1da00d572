// Small scenes for the judge's tests, and a slow, independent ray caster in double.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "common/culler/visible_set.h"
#include "common/geometry/random.h"
#include "common/judge/truth.h"
#include "common/scene/generators/generators.h"

namespace vislab {

/// A scene, its state and one camera.
class Stage {
 public:
  Stage(Scene built, const Camera& camera, const Viewport& viewport)
      : scene(finished(std::move(built))), state(scene) {
    frame.camera = camera;
    frame.viewport = viewport;
    frame.objects = state.view();
  }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  void apply(const Changes& changes) {
    state.apply(changes);
    frame.objects = state.view();
  }

  Scene scene;
  SceneState state;
  Frame frame;

 private:
  static Scene finished(Scene built) {
    built.finish();
    return built;
  }
};

inline Changes changes(std::vector<ObjectId> moved, std::vector<glm::dmat4x3> transforms = {},
                       std::vector<ObjectId> shown = {}, std::vector<ObjectId> hidden = {}) {
  return {std::move(moved), std::move(transforms), std::move(shown), std::move(hidden)};
}

inline Camera camera_at(const glm::dvec3& eye, const glm::dvec3& target, double near_m = 0.1,
                        double far_m = 100.0, double aspect = 1.0) {
  return {look_at(eye, target), perspective_lens(std::numbers::pi / 3.0, aspect, near_m, far_m)};
}

/// One mesh of cubes from -1 to 1, placed at `centers`.
inline Scene cubes_at(const std::vector<glm::dvec3>& centers) {
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  for (const glm::dvec3& center : centers) {
    scene.objects.push_back({0, box_transform(center, glm::dvec3(1.0)), none_id});
  }
  return scene;
}

/// A triangle as an object of its own, world frame.
inline void add_triangle(Scene& scene, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  Mesh mesh;
  mesh.positions = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  scene.objects.push_back({static_cast<MeshId>(scene.meshes.size()), glm::dmat4x3(1.0), none_id});
  scene.meshes.push_back(std::move(mesh));
}

/// Objects of five random triangles each, within the cube from -extent to extent.
inline Scene random_triangles(int objects, double extent, double size, std::uint64_t seed) {
  Random random(seed);
  const auto vector = [&](double limit) {
    const double x = random.uniform(-limit, limit);
    const double y = random.uniform(-limit, limit);
    return glm::vec3(x, y, random.uniform(-limit, limit));
  };
  Scene scene;
  for (int i = 0; i < objects; ++i) {
    Mesh mesh;
    const glm::vec3 center = vector(extent);
    for (unsigned t = 0; t < 5; ++t) {
      for (int corner = 0; corner < 3; ++corner) mesh.positions.push_back(center + vector(size));
      mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    scene.objects.push_back({static_cast<MeshId>(scene.meshes.size()), glm::dmat4x3(1.0), none_id});
    scene.meshes.push_back(std::move(mesh));
  }
  return scene;
}

/// First triangle through a window position, by trying all of them in double.
inline TriangleId brute_force(const Frame& frame, const Scene& scene, const glm::dvec2& window_px) {
  const Ray ray =
      frame.camera.ray(window_px / glm::dvec2(frame.viewport.width, frame.viewport.height));
  TriangleId nearest = none_id;
  double nearest_t = std::numeric_limits<double>::infinity();
  for (const ObjectId object : frame.objects.shown) {
    for (std::uint32_t i = 0; i < scene.triangle_count(object); ++i) {
      const auto [a, b, c] =
          world_triangle(scene.mesh_of(object), frame.objects.transforms[object], i);
      const glm::dvec3 normal = glm::cross(b - a, c - a);
      const double t = glm::dot(normal, a - ray.origin) / glm::dot(normal, ray.direction);
      if (!(t >= frame.camera.lens.near_m && t <= frame.camera.lens.far_m && t < nearest_t))
        continue;
      const glm::dvec3 p = ray.origin + ray.direction * t;
      if (glm::dot(glm::cross(b - a, p - a), normal) < 0.0 ||
          glm::dot(glm::cross(c - b, p - b), normal) < 0.0 ||
          glm::dot(glm::cross(a - c, p - c), normal) < 0.0) {
        continue;
      }
      nearest = scene.first_triangle(object) + i;
      nearest_t = t;
    }
  }
  return nearest;
}

inline glm::dvec2 centre_of(std::size_t pixel, const Viewport& viewport) {
  return {static_cast<double>(pixel % viewport.width) + 0.5,
          static_cast<double>(pixel / viewport.width) + 0.5};
}

/// All triangles that are shown, but some.
inline VisibleSet all_but(const Stage& stage, const std::vector<TriangleId>& left_out) {
  std::vector<VisibleSet::Run> runs;
  for (const ObjectId object : stage.frame.objects.shown) {
    const TriangleId first = stage.scene.first_triangle(object);
    for (std::uint32_t i = 0; i < stage.scene.triangle_count(object); ++i) {
      if (std::ranges::find(left_out, first + i) == left_out.end()) runs.push_back({first + i, 1});
    }
  }
  return VisibleSet(std::move(runs));
}

/// All triangles of the objects for which `keep` is true.
template <typename Keep>
VisibleSet objects_where(const Stage& stage, Keep&& keep) {
  std::vector<VisibleSet::Run> runs;
  for (const ObjectId object : stage.frame.objects.shown) {
    if (keep(object)) {
      runs.push_back({stage.scene.first_triangle(object), stage.scene.triangle_count(object)});
    }
  }
  return VisibleSet(std::move(runs));
}

}  // namespace vislab
