#include <gtest/gtest.h>

#include "common/render/osmesa_device.h"
#include "experiments/contract/contract_sink.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

/// A wall at z = 0 that fills the view from +z, and cubes: 1 in front of it, 2 and 3 behind, 4
/// behind and much higher, so that it sticks out above.
Scene wall() {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {{0, placed({0.0, 0.0, 0.0}, {8.0, 6.0, 0.1}), none_id},
                   {0, placed({1.0, 0.0, 3.0}, glm::dvec3(0.2)), none_id},
                   {0, placed({0.0, 0.0, -3.0}), none_id},
                   {0, placed({2.0, 1.0, -9.0}), none_id},
                   {0, placed({0.0, 5.0, -9.0}, {0.5, 9.0, 0.5}), none_id}};
  scene.finish();
  return scene;
}

/// A run of stop-and-wait on a device; emitted() in the order of drawing.
class Drawn {
 public:
  Drawn(const std::string& spec, const Scene& scene)
      : scene_(&scene), run_(spec, scene, with(device_, scene)) {}

  std::vector<ObjectId> objects(const Camera& camera) {
    const Frame frame = run_.frame(camera, {128, 128});
    device_.begin_frame(frame);
    ContractSink sink;
    sink.start(*scene_, frame, Candidates::everything(), &device_);
    run_.culler().cull(frame, Candidates::everything(), sink);
    std::vector<ObjectId> ids;
    for (const TriangleRange& range : sink.finish()) ids.push_back(range.object);
    EXPECT_EQ(sink.fault(), "");
    return ids;
  }

  CullerRun& run() { return run_; }

 private:
  static BuildContext with(OsMesaDevice& device, const Scene& scene) {
    device.load(scene);
    BuildContext context;
    context.device = &device;
    return context;
  }

  const Scene* scene_;
  OsMesaDevice device_;
  CullerRun run_;
};

TEST(StopAndWait, LeavesOutWhatTheWallHidesAndDrawsFrontToBack) {
  const Scene scene = wall();
  Drawn drawn("occlusion.stop_and_wait", scene);
  EXPECT_EQ(drawn.objects(camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0})),
            (std::vector<ObjectId>{1, 0}));
  EXPECT_EQ(drawn.run().counter("queries"), 5U);
  EXPECT_EQ(drawn.run().counter("occluded"), 3U);
  // From higher up the tall one shows above the wall, whose upper edge is then nearest.
  EXPECT_EQ(drawn.objects(camera_at({0.0, 9.0, 12.0}, {0.0, 5.0, 0.0})),
            (std::vector<ObjectId>{0, 1, 4}));
}

TEST(StopAndWait, SeesEverythingFromBehindTheWall) {
  const Scene scene = wall();
  Drawn drawn("occlusion.stop_and_wait", scene);
  EXPECT_EQ(drawn.objects(camera_at({0.5, 0.0, -20.0}, {0.5, 0.0, 0.0})),
            (std::vector<ObjectId>{3, 4, 2, 0}));
}

TEST(StopAndWait, OrdersByDepthForAnOrthographicCamera) {
  const Scene scene = wall();
  Drawn drawn("occlusion.stop_and_wait", scene);
  Camera camera = camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0});
  camera.lens = orthographic_lens(11.0, 1.0, 0.1, 100.0);
  EXPECT_EQ(drawn.objects(camera), (std::vector<ObjectId>{1, 0}));
  camera.lens = orthographic_lens(40.0, 1.0, 0.1, 100.0);
  EXPECT_EQ(drawn.objects(camera), (std::vector<ObjectId>{1, 0, 4}));
}

TEST(StopAndWait, DrawsWhatMayBeCutByTheNearPlaneUnasked) {
  const Scene scene = wall();
  Drawn drawn("occlusion.stop_and_wait", scene);
  const std::vector<ObjectId> kept =
      drawn.objects(camera_at({0.0, 0.0, 0.15}, {0.0, 0.0, -1.0}));  // 5 cm from the wall
  EXPECT_EQ(kept, std::vector<ObjectId>{0});
  EXPECT_EQ(drawn.run().counter("queries"), 4U);
}

TEST(StopAndWait, LeavesOutSmallThingsAboveTheThreshold) {
  const Scene scene = wall();
  Drawn drawn("occlusion.stop_and_wait[threshold_px=500]", scene);
  EXPECT_EQ(drawn.run().culler().info().guarantee, Guarantee::approximate);
  EXPECT_EQ(drawn.objects(camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0})), std::vector<ObjectId>{0});
}

}  // namespace
}  // namespace vislab
