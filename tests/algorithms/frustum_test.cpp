#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/geometry/frustum.h"
#include "common/geometry/random.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

Scene cubes_at(const std::vector<glm::dvec3>& offsets) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (const glm::dvec3& offset : offsets) scene.objects.push_back({0, placed(offset), none_id});
  scene.finish();
  return scene;
}

Scene random_field(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 offset(random.uniform(-30.0, 30.0), random.uniform(-30.0, 30.0),
                            random.uniform(-30.0, 30.0));
    const glm::dvec3 scale(random.uniform(0.1, 4.0), random.uniform(0.1, 4.0),
                           random.uniform(0.1, 4.0));
    scene.objects.push_back({0, placed(offset, scale), none_id});
  }
  scene.finish();
  return scene;
}

TEST(FrustumFlat, KeepsExactlyTheBoxesThatNoPlaneExcludes) {
  const Scene scene = random_field(3, 2000);
  CullerRun run("frustum.flat", scene);
  CullerRun by_id("frustum.flat[early_out=off]", scene);
  CullerRun one_by_one("frustum.flat[kernel=scalar]", scene);
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    Camera camera = camera_at({random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0), 0.5},
                              {random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0), 0.0});
    if (i % 3 == 1) camera.lens = orthographic_lens(12.0, 1.5, 0.5, 40.0);
    if (i % 3 == 2) camera.lens.far_m = std::numeric_limits<double>::infinity();
    std::vector<ObjectId> expected;
    const Frustum frustum = frustum_of(camera);
    for (const ObjectId object : run.frame(camera).objects.shown) {
      const Aabb& box = run.frame(camera).objects.bounds[object];
      const bool outside = std::ranges::any_of(
          frustum.span(), [&](const Plane& plane) { return surely_outside(plane, box); });
      if (!outside) expected.push_back(object);
    }
    for (CullerRun* flat : {&run, &by_id, &one_by_one}) {
      std::vector<ObjectId> kept = flat->objects(camera);
      std::ranges::sort(kept);
      EXPECT_EQ(kept, expected) << "camera " << i;
    }
    EXPECT_GT(expected.size(), 0U);
    EXPECT_LT(expected.size(), scene.object_count());
  }
}

TEST(FrustumFlat, TheSphereKeepsAllThatTheBoxKeepsAndMore) {
  const Scene scene = random_field(5, 2000);
  CullerRun boxes("frustum.flat", scene);
  CullerRun spheres("frustum.flat[test=sphere]", scene);
  const Camera camera = camera_at({0.0, 0.0, 25.0}, {5.0, 1.0, 0.0});
  std::vector<ObjectId> by_box = boxes.objects(camera);
  std::vector<ObjectId> by_sphere = spheres.objects(camera);
  std::ranges::sort(by_box);
  std::ranges::sort(by_sphere);
  EXPECT_TRUE(std::ranges::includes(by_sphere, by_box));
  EXPECT_GT(by_sphere.size(), by_box.size());
}

TEST(FrustumFlat, FollowsMovedObjectsAndForgetsThemOnReset) {
  const Scene scene = cubes_at({{0.0, 0.0, 0.0}, {100.0, 0.0, 0.0}});
  const Camera camera = camera_at({0.0, 0.0, 10.0}, {0.0, 0.0, 0.0});
  for (const char* spec :
       {"frustum.flat", "frustum.flat[early_out=off]", "frustum.flat[test=sphere]"}) {
    CullerRun run(spec, scene);
    EXPECT_EQ(run.objects(camera), std::vector<ObjectId>{0}) << spec;
    run.update(camera, {{0, 1}, {placed({0.0, 50.0, 0.0}), placed({1.0, 0.0, 0.0})}, {}, {}});
    EXPECT_EQ(run.objects(camera), std::vector<ObjectId>{1}) << spec;
    run.reset();
    EXPECT_EQ(run.objects(camera), std::vector<ObjectId>{0}) << spec;
  }
}

TEST(FrustumFlat, TestsOnlyWhatIsShown) {
  const Scene scene = cubes_at({{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {4.0, 0.0, 0.0}});
  const Camera camera = camera_at({0.0, 0.0, 10.0}, {0.0, 0.0, 0.0});
  CullerRun run("frustum.flat", scene);
  run.update(camera, {{}, {}, {}, {1}});
  EXPECT_EQ(run.objects(camera), (std::vector<ObjectId>{0, 2}));
  EXPECT_EQ(run.counter("objects_tested"), 2U);
}

TEST(FrustumFlat, TestsWhatALaterStageIsOfferedInItsOrder) {
  const Scene scene = random_field(9, 3000);
  const Camera camera = camera_at({0.0, 0.0, 25.0}, {5.0, 1.0, 0.0});
  CullerRun one_by_one("frustum.flat[kernel=scalar]", scene);
  for (const char* spec : {"frustum.flat", "frustum.flat[early_out=off]"}) {
    CullerRun run(spec, scene);
    for (const std::size_t count : {0, 1, 40, 2000}) {
      std::vector<ObjectId> offered;
      for (std::size_t i = 0; i < count; ++i) {
        offered.push_back(static_cast<ObjectId>((i * 1009 + 5) % scene.object_count()));
      }
      const std::span<const ObjectId> all(offered);
      const std::array runs{all.first(count / 3), all.subspan(count / 3)};
      const std::uint64_t before = run.counter("objects_tested");
      EXPECT_EQ(run.objects(camera, Candidates::of(runs)),
                one_by_one.objects(camera, Candidates::of(runs)))
          << spec << ", " << count;
      EXPECT_EQ(run.counter("objects_tested") - before, count);
    }
  }
}

TEST(FrustumFlat, ShortListsCostNoMoreThanTheirLength) {
  const Scene scene = random_field(9, 3000);
  const Camera camera = camera_at({0.0, 0.0, 25.0}, {5.0, 1.0, 0.0});
  CullerRun run("frustum.flat", scene);
  const std::array<ObjectId, 3> few{7, 11, 13};
  const std::array<std::span<const ObjectId>, 1> runs{few};
  run.objects(camera, Candidates::of(runs));
  EXPECT_LE(run.counter("plane_tests"), 18U);
}

TEST(FrustumFlat, StopsAtTheFirstPlaneThatExcludes) {
  const Camera camera = camera_at({0.0, 0.0, 10.0}, {0.0, 0.0, 0.0});
  const Scene inside = cubes_at({{0.0, 0.0, 0.0}});
  const std::string one_by_one = "frustum.flat[kernel=scalar]";
  CullerRun six(one_by_one, inside);
  six.objects(camera);
  EXPECT_EQ(six.counter("plane_tests"), 6U);

  Camera endless = camera;
  endless.lens.far_m = std::numeric_limits<double>::infinity();
  CullerRun five(one_by_one, inside);
  five.objects(endless);
  EXPECT_EQ(five.counter("plane_tests"), 5U);

  const Scene far_left = cubes_at({{-100.0, 0.0, 0.0}});
  CullerRun one(one_by_one, far_left);
  EXPECT_TRUE(one.objects(camera).empty());
  EXPECT_EQ(one.counter("plane_tests"), 1U);
}

TEST(FrustumFlat, NeverLeavesOutABrokenBox) {
  const Scene scene = cubes_at({{-100.0, 0.0, 0.0}});
  const Camera camera = camera_at({0.0, 0.0, 10.0}, {0.0, 0.0, 0.0});
  CullerRun run("frustum.flat", scene);
  EXPECT_TRUE(run.objects(camera).empty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float broken : {nan, -infinity}) {
    Aabb box = run.frame(camera).objects.bounds[0];
    box.min.x = broken;
    Frame frame = run.frame(camera);
    frame.objects.bounds = {&box, 1};
    RecordingSink sink;
    sink.start(scene, frame);
    run.culler().update(frame, {{0}, {scene.objects[0].transform}, {}, {}});
    run.culler().cull(frame, Candidates::everything(), sink);
    EXPECT_EQ(sink.emitted().size(), 1U) << broken;
  }
}

TEST(FrustumFlat, KeepsABoxThatOnlyTouchesAPlane) {
  // The left plane of a 90 degree camera at the origin runs exactly through x = z.
  Camera camera = camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});
  camera.lens = {Projection::perspective, -0.125, 0.125, -0.125, 0.125, 0.125, 100.0};
  const Scene scene = cubes_at({{-11.0, 0.0, -9.0}, {-11.0 - 1e-5, 0.0, -9.0}});
  CullerRun run("frustum.flat", scene);
  EXPECT_EQ(run.objects(camera), std::vector<ObjectId>{0});
}

}  // namespace
}  // namespace vislab
