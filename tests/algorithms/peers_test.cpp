// What others built: wrong by float rounding at most.
#include <gtest/gtest.h>

#include <set>

#include "common/geometry/frustum.h"
#include "common/geometry/random.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

class Peer : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    Registry registry;
    register_all_cullers(registry);
    if (!registry.entries().contains(std::string_view(GetParam()))) {
      GTEST_SKIP() << GetParam() << " is not built: its Debian package is not installed";
    }
  }
};

Scene field(std::size_t count) {
  Random random(21);
  Scene scene;
  scene.meshes = {sphere_mesh(2)};
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 offset(random.uniform(-30.0, 30.0), random.uniform(-30.0, 30.0),
                            random.uniform(-30.0, 30.0));
    scene.objects.push_back({0, placed(offset, glm::dvec3(random.uniform(0.1, 2.0))), none_id});
  }
  scene.finish();
  return scene;
}

/// Planes of the frustum that the box is clear of, on either side, count; a box that is nearer to
/// one than float can tell may go or stay.
void expect_right(CullerRun& run, const Camera& camera) {
  constexpr double float_error_m = 1e-3;
  const Frame frame = run.frame(camera);
  const Frustum frustum = frustum_of(camera);
  const std::vector<ObjectId> emitted = run.objects(camera);
  const std::set<ObjectId> kept(emitted.begin(), emitted.end());
  EXPECT_EQ(kept.size(), emitted.size());
  std::size_t wrong = 0;
  for (const ObjectId object : frame.objects.shown) {
    bool outside = false;
    bool near = false;
    for (const Plane& plane : frustum.span()) {
      const double distance = plane.signed_distance(p_vertex(plane, frame.objects.bounds[object]));
      outside = outside || distance < 0.0;
      near = near || std::abs(distance) < float_error_m;
    }
    if (!near && outside == kept.contains(object)) ++wrong;
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_LE(kept.size(), frame.objects.shown.size());
  EXPECT_TRUE(std::ranges::includes(frame.objects.shown, kept));
}

TEST_P(Peer, DiffersFromTheDefinitionByFloatRoundingAtMost) {
  const Scene scene = field(1001);
  CullerRun run(GetParam(), scene);
  Random random(22);
  for (int i = 0; i < 20; ++i) {
    Camera camera = camera_at({random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0), 0.5},
                              {random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0), 0.0});
    if (i % 3 == 1) camera.lens = orthographic_lens(12.0, 1.5, 0.5, 40.0);
    if (i % 3 == 2) camera.lens.far_m = std::numeric_limits<double>::infinity();
    expect_right(run, camera);
  }
}

TEST_P(Peer, FollowsMovedHiddenAndShownObjects) {
  const Scene scene = field(300);
  CullerRun run(GetParam(), scene);
  const Camera camera = camera_at({0.0, 0.0, 25.0}, {0.0, 0.0, 0.0});
  run.update(camera, {{1, 7, 8},
                      {placed({0.0, 500.0, 0.0}), placed({0.0, 0.0, 0.0}), placed({1.0, 1.0, 1.0})},
                      {},
                      {2, 3, 8}});
  expect_right(run, camera);
  run.update(camera, {{8}, {placed({0.0, 0.0, 0.0})}, {3, 8}, {}});
  expect_right(run, camera);
  run.reset();
  expect_right(run, camera);
}

TEST_P(Peer, KeepsToWhatItIsOffered) {
  const Scene scene = field(300);
  CullerRun run(GetParam(), scene);
  const Camera camera = camera_at({0.0, 0.0, 25.0}, {0.0, 0.0, 0.0});
  const std::vector<ObjectId> all = run.objects(camera);
  ASSERT_GT(all.size(), 10U);
  const std::array<ObjectId, 2> offered{all[3], all[7]};
  const std::array<std::span<const ObjectId>, 1> runs{offered};
  std::vector<ObjectId> kept = run.objects(camera, Candidates::of(runs));
  std::ranges::sort(kept);
  EXPECT_EQ(kept, (std::vector<ObjectId>{std::min(all[3], all[7]), std::max(all[3], all[7])}));
}

INSTANTIATE_TEST_SUITE_P(All, Peer, ::testing::Values("peer.bullet", "peer.filament"),
                         [](const auto& test) { return std::string(test.param).substr(5); });

}  // namespace
}  // namespace vislab
