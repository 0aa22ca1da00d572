#include "common/render/query_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/geometry/frustum.h"
#include "common/geometry/random.h"
#include "common/render/osmesa_device.h"
#include "tests/render/small_scenes.h"

namespace vislab {
namespace {

using test::frame_of;
using test::object_at;
using test::square_mesh;

glm::dvec3 random_vector(Random& random) {
  return {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
}

/// Uniform in the logarithm.
double random_scale(Random& random, double low, double high) {
  return std::exp(random.uniform(std::log(low), std::log(high)));
}

Camera random_camera(Random& random, std::uint64_t kind) {
  Camera camera;
  camera.pose = look_at(3.0 * random_vector(random), 30.0 * random_vector(random));
  switch (kind) {
    case 0:
      camera.lens = perspective_lens(1.0, 1.0, 0.1, 100.0);
      break;
    case 1:
      camera.lens = perspective_lens(1.0, 1.0, 0.05, 500.0);
      break;
    case 2:
      camera.lens = perspective_lens(1.0, 1.0, 0.1, std::numeric_limits<double>::infinity());
      break;
    default:
      camera.lens = orthographic_lens(10.0, 1.0, 0.0, 100.0);
  }
  return camera;
}

/// A few random triangles around `point`; in some cases in a plane through the eye, so that they
/// are seen nearly edge-on.
Mesh random_triangles(Random& random, const Ray& ray, const glm::dvec3& point, double size,
                      bool edge_on) {
  Mesh mesh;
  const auto count = static_cast<std::uint32_t>(1 + random.below(3));
  const glm::dvec3 side = glm::normalize(glm::cross(ray.direction, random_vector(random)));
  for (std::uint32_t i = 0; i < 3 * count; ++i) {
    const glm::dvec3 q = random_vector(random);
    const glm::dvec3 offset =
        edge_on ? ray.direction * q.x + side * q.y + glm::cross(side, ray.direction) * q.z * 1e-3
                : q;
    mesh.positions.push_back(glm::vec3(point + offset * size));
  }
  for (std::uint32_t i = 0; i < 3 * count; i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  return mesh;
}

/// A square across a world axis, which is the whole face of its box, before or behind an occluder
/// that nearly coincides with it.
void place_squares(Random& random, Scene& scene, const Ray& ray, const glm::dvec3& point,
                   double depth, double size) {
  scene.meshes = {square_mesh(1), square_mesh(3)};
  scene.objects = {object_at(0, point), object_at(1, point)};
  const auto axis = static_cast<int>(random.below(3));
  glm::dmat4x3 transform(0.0);
  transform[0][(axis + 1) % 3] = size;
  transform[1][(axis + 2) % 3] = size * random.uniform(0.2, 1.0);
  transform[2][axis] = size;
  transform[3] = point;
  scene.objects[1].transform = transform;
  transform[0] *= 1.5;
  transform[1] *= 1.5;
  transform[3] += ray.direction * (depth * random_scale(random, 1e-8, 1e-5));
  scene.objects[0].transform = transform;
}

struct Tally {
  int queries = 0;
  int visible = 0;
  int missed = 0;  // queries that counted fewer samples than the object then added
};

Tally count_misses(int trials, bool enlarge) {
  Random random(7);
  OsMesaDevice device;
  Tally tally;
  const Viewport viewport{128, 128};
  for (int trial = 0; trial < trials; ++trial) {
    const Camera camera = random_camera(random, random.below(4));
    const double depth = random_scale(random, 1.0, 90.0);
    const Ray ray = camera.ray({random.uniform(0.05, 0.95), random.uniform(0.05, 0.95)});
    const glm::dvec3 point = ray.origin + ray.direction * depth;
    const double size = depth * random_scale(random, 0.005, 0.3);
    Scene scene;
    const std::uint64_t shape = random.below(4);
    if (shape == 0) {
      const Mesh object = random_triangles(random, ray, point, size, true);
      scene.meshes = {random_triangles(random, ray, point, size, false), object};
      scene.objects = {object_at(0, glm::dvec3(0.0)), object_at(1, glm::dvec3(0.0))};
    } else if (shape == 1) {
      const Mesh object = random_triangles(random, ray, point, size, false);
      scene.meshes = {random_triangles(random, ray, point, 1.5 * size, false), object};
      scene.objects = {object_at(0, glm::dvec3(0.0)), object_at(1, glm::dvec3(0.0))};
    } else {
      place_squares(random, scene, ray, point, depth, size);
    }
    scene.finish();
    const SceneState state(scene);
    Frame frame = frame_of(state, viewport);
    frame.camera = camera;
    const Aabb tight = state.view().bounds[1];
    const Aabb box = enlarge ? enlarged_for_query(camera, viewport, tight) : tight;
    if (touches_near_region(camera, box)) continue;
    ++tally.queries;
    device.load(scene);
    device.begin_frame(frame);
    device.draw(std::array<ObjectId, 1>{0});
    const QueryId query = device.query(std::array<Aabb, 1>{box});
    device.draw(std::array<ObjectId, 1>{1});
    const std::vector<std::uint32_t> ids = device.read_ids();
    const auto added = static_cast<std::uint64_t>(std::count(ids.begin(), ids.end(), 1U));
    if (added > 0) ++tally.visible;
    if (added > device.samples(query)) ++tally.missed;
  }
  return tally;
}

TEST(QueryBounds, AQueryOfTheEnlargedBoxCountsAllThatItsContentsAdd) {
  const Tally tally = count_misses(2500, true);
  EXPECT_GT(tally.queries, 2000);
  EXPECT_GT(tally.visible, 700);
  EXPECT_EQ(tally.missed, 0);
}

TEST(QueryBounds, WithoutTheMarginSuchQueriesMissSamples) {
  EXPECT_GT(count_misses(2500, false).missed, 0);
}

TEST(QueryBounds, TheMarginIsSmall) {
  Camera camera;
  camera.lens = perspective_lens(1.0, 1.0, 0.1, 100.0);
  const Aabb box{{-1.0F, -1.0F, -12.0F}, {1.0F, 1.0F, -10.0F}};
  const Aabb large = enlarged_for_query(camera, {512, 512}, box);
  const double pixel = 2.0 * std::tan(0.5) * 12.0 / 512.0;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(large.min[axis], box.min[axis]);
    EXPECT_GT(large.max[axis], box.max[axis]);
    EXPECT_GT(large.min[axis], static_cast<double>(box.min[axis]) - 0.1 * pixel);
  }
  EXPECT_LT(large.max.x, 1.0 + 0.1 * pixel);
  EXPECT_LT(large.max.z, -10.0 + 0.01);
}

TEST(QueryBounds, ABrokenBoxIsLeftAsItIs) {
  const Aabb empty;
  EXPECT_EQ(enlarged_for_query(Camera{}, Viewport{}, empty), empty);
}

}  // namespace
}  // namespace vislab
