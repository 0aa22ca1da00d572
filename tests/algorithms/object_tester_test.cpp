#include "algorithms/frustum/object_tester.h"

#include <gtest/gtest.h>

#include <limits>

#include "common/geometry/random.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

using frustum_culling::FrustumTester;
using frustum_culling::ObjectTester;
using frustum_culling::ObjectTestOptions;
using frustum_culling::Switches;
using VolumeTest = ObjectTestOptions::Test;
using SphereKind = ObjectTestOptions::SphereKind;

/// A long thin tetrahedron along the diagonal: its own box is much tighter than the world's. The
/// stray vertex belongs to no triangle.
Mesh splinter() {
  Mesh mesh;
  mesh.positions = {{-5.0F, -5.0F, -5.0F},
                    {5.0F, 5.0F, 5.2F},
                    {5.0F, 5.2F, 5.0F},
                    {5.2F, 5.0F, 5.0F},
                    {1e6F, 0.0F, 0.0F}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}};
  return mesh;
}

glm::dmat4x3 random_placement(Random& random) {
  const auto number = [&](double reach) { return random.uniform(-reach, reach); };
  glm::dmat4x3 transform(1.0);
  for (int column = 0; column < 3; ++column) {
    transform[column] += glm::dvec3(number(0.6), number(0.6), number(0.6));
  }
  transform[3] = {number(30.0), number(30.0), number(30.0)};
  return transform;
}

Scene splinters(std::uint64_t seed) {
  Random random(seed);
  Scene scene;
  scene.meshes = {splinter(), cube_mesh()};
  for (std::uint32_t i = 0; i < 600; ++i) {
    scene.objects.push_back({i % 2, random_placement(random), none_id});
  }
  scene.finish();
  return scene;
}

/// Does any plane exclude all vertices of the object, by more than rounding?
bool vertices_excluded(const Scene& scene, const Frame& frame, ObjectId object) {
  const Mesh& mesh = scene.mesh_of(object);
  const Frustum frustum = frustum_of(frame.camera);
  return std::ranges::any_of(frustum.span(), [&](const Plane& plane) {
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      for (const glm::dvec3& p : world_triangle(mesh, frame.objects.transforms[object], i)) {
        if (plane.signed_distance(p) >= -1e-9) return false;
      }
    }
    return true;
  });
}

class Kept {
 public:
  Kept(const ObjectTestOptions& options, const Scene& scene)
      : objects(options), tester(Switches{}) {
    objects.build(scene);
  }

  std::vector<ObjectId> of(const Frame& frame) {
    tester.start(frame);
    objects.start(frame);
    std::vector<ObjectId> kept;
    for (const ObjectId object : frame.objects.shown) {
      if (objects.keeps(object, frame, tester, object, tester.all_planes())) {
        kept.push_back(object);
      }
    }
    return kept;
  }

  ObjectTester objects;
  FrustumTester tester;
};

std::vector<ObjectTestOptions> all_options() {
  std::vector<ObjectTestOptions> all;
  for (const bool refine : {false, true}) {
    for (const VolumeTest test : {VolumeTest::vertex, VolumeTest::corners, VolumeTest::sphere,
                                  VolumeTest::obb, VolumeTest::dual, VolumeTest::exact}) {
      for (const SphereKind sphere : {SphereKind::box, SphereKind::farthest, SphereKind::ritter}) {
        all.push_back({test, sphere, refine});
      }
    }
  }
  return all;
}

TEST(ObjectTester, EveryTestKeepsAllThatNoPlaneExcludesAsItMoves) {
  const Scene scene = splinters(21);
  for (const ObjectTestOptions& options : all_options()) {
    SceneState state(scene);
    Kept kept(options, scene);
    Random random(22);
    for (int step = 0; step < 8; ++step) {
      Camera camera = camera_at({random.uniform(-20.0, 20.0), 0.0, random.uniform(-20.0, 20.0)},
                                {random.uniform(-5.0, 5.0), random.uniform(-9.0, 9.0), 0.0});
      if (step % 3 == 1) camera.lens = orthographic_lens(12.0, 1.5, 0.5, 40.0);
      if (step % 3 == 2) camera.lens.far_m = std::numeric_limits<double>::infinity();
      Changes changes;
      for (ObjectId object = 0; object < 600; object += 50) {
        changes.moved.push_back(object);
        changes.transforms.push_back(random_placement(random));
      }
      state.apply(changes);
      const Frame frame{0, camera, {}, state.view(), 0.0};
      kept.objects.update(frame, changes);
      const std::vector<ObjectId> ids = kept.of(frame);
      EXPECT_GT(ids.size(), 0U);
      EXPECT_LT(ids.size(), 600U);
      const bool by_planes = options.test != VolumeTest::exact && !options.refine;
      for (const ObjectId object : frame.objects.shown) {
        const bool is_kept = std::ranges::binary_search(ids, object);
        if (is_kept || vertices_excluded(scene, frame, object)) continue;
        // The exact test may find more than single planes do, but only on the world box.
        EXPECT_FALSE(by_planes) << "object " << object << ", test "
                                << static_cast<int>(options.test);
        EXPECT_EQ(ExactFrustum(camera).side(frame.objects.bounds[object]), Side::outside);
      }
    }
    kept.objects.reset();
    state.reset();
    const Frame frame{0, camera_at({0.0, 0.0, 20.0}, {0.0, 0.0, 0.0}), {}, state.view(), 0.0};
    EXPECT_EQ(kept.of(frame), Kept(options, scene).of(frame));
  }
}

TEST(ObjectTester, TighterVolumesKeepLess) {
  const Scene scene = splinters(23);
  const SceneState state(scene);
  const auto count = [&](const ObjectTestOptions& options) {
    Kept kept(options, scene);
    Random random(24);
    std::size_t sum = 0;
    for (int i = 0; i < 10; ++i) {
      const Camera camera =
          camera_at({random.uniform(-20.0, 20.0), 0.0, random.uniform(-20.0, 20.0)},
                    {random.uniform(-5.0, 5.0), random.uniform(-9.0, 9.0), 0.0});
      sum += kept.of({0, camera, {}, state.view(), 0.0}).size();
    }
    return sum;
  };
  const std::size_t box = count({VolumeTest::vertex, SphereKind::box, false});
  EXPECT_EQ(count({VolumeTest::corners, SphereKind::box, false}), box);
  EXPECT_GT(count({VolumeTest::sphere, SphereKind::box, false}), box);
  EXPECT_LT(count({VolumeTest::sphere, SphereKind::ritter, false}),
            count({VolumeTest::sphere, SphereKind::box, false}));
  const std::size_t oriented = count({VolumeTest::obb, SphereKind::box, false});
  EXPECT_LT(oriented, box);
  EXPECT_LE(count({VolumeTest::dual, SphereKind::ritter, false}), oriented);
  EXPECT_LE(count({VolumeTest::exact, SphereKind::box, false}), box);
  EXPECT_EQ(count({VolumeTest::vertex, SphereKind::box, true}),
            count({VolumeTest::exact, SphereKind::box, false}));
}

TEST(ObjectTester, AsksTheOrientedBoxOnlyWhereTheSphereIntersects) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (const double x : {0.0, 300.0, 11.5}) {
    scene.objects.push_back({0, placed({x, 0.0, 0.0}), none_id});
  }
  scene.finish();
  const SceneState state(scene);
  const Frame frame{0, camera_at({0.0, 0.0, 20.0}, {0.0, 0.0, 0.0}), {}, state.view(), 0.0};
  Kept sphere({VolumeTest::sphere, SphereKind::box, false}, scene);
  Kept dual({VolumeTest::dual, SphereKind::box, false}, scene);
  EXPECT_EQ(sphere.of(frame), (std::vector<ObjectId>{0, 2}));
  EXPECT_EQ(dual.of(frame), (std::vector<ObjectId>{0, 2}));
  // Only object 2 straddles: its oriented box costs six planes more.
  EXPECT_EQ(dual.objects.plane_tests(), sphere.objects.plane_tests() + 6);
}

TEST(ObjectTester, NeverLeavesOutABrokenBox) {
  const Scene scene = splinters(25);
  SceneState state(scene);
  std::vector<Aabb> bounds(state.view().bounds.begin(), state.view().bounds.end());
  for (Aabb& box : bounds) box.max.y = std::numeric_limits<float>::quiet_NaN();
  Frame frame{0, camera_at({0.0, 0.0, 500.0}, {0.0, 0.0, 1000.0}), {}, state.view(), 0.0};
  frame.objects.bounds = bounds;
  for (const ObjectTestOptions& options : all_options()) {
    EXPECT_EQ(Kept(options, scene).of(frame).size(), 600U);
  }
}

}  // namespace
}  // namespace vislab
