// The query methods without a hierarchy: no image changes, whatever the camera and the objects do,
// and each asks in the way that it is made for.
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "common/geometry/random.h"
#include "common/render/modelled_gpu.h"
#include "common/render/osmesa_device.h"
#include "tests/algorithms/query_scenes.h"

namespace vislab {
namespace {

const char* const exact_methods[] = {"occlusion.stop_and_wait",
                                     "occlusion.batched",
                                     "occlusion.batched[batch=1]",
                                     "occlusion.batched[batch=1000]",
                                     "occlusion.chc_flat",
                                     "occlusion.chc_flat[flush_every=1]",
                                     "occlusion.chc_flat[flush_every=1000]"};

/// No method changes the image, and each leaves out at least a quarter of what is shown, even if
/// all of it is asked about at once.
void expect_exact(Play play) {
  QueryPlay stage(std::move(play), query_viewport);
  OsMesaDevice device;
  for (const char* method : exact_methods) {
    const std::vector<QueryFrame> frames = stage.run(method, device);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(frames[i].image_px, 0U) << method << ", frame " << i;
    }
    EXPECT_LT(kept(frames), stage.scene().object_count() * frames.size() * 3 / 4) << method;
  }
}

/// The lecture's demonstration: a flat cube and a sphere above it, here one behind the other.
TEST(QueryDemonstration, ASphereBehindACubeHasNoVisibleSamples) {
  Scene scene;
  scene.meshes = {cube_mesh(), sphere_mesh(12)};
  scene.objects = {{0, placed({0.0, -0.25, 0.0}, {1.0, 0.5, 1.0}), none_id},
                   {1, placed({0.0, -0.25, -4.0}, glm::dvec3(0.4)), none_id}};
  scene.finish();
  const SceneState state(scene);
  OsMesaDevice osmesa;
  ModelledGpu modelled(gpu_presets().front().model);
  for (RenderDevice* device :
       {static_cast<RenderDevice*>(&osmesa), static_cast<RenderDevice*>(&modelled)}) {
    device->load(scene);
    /// Samples of the first object's box on an empty image, and of the second's once it is drawn.
    const auto samples = [&](const glm::dvec3& eye, ObjectId first, ObjectId second) {
      const Frame frame{0, looking(eye, {0.0, -0.25, 0.0}), {64, 64}, state.view(), 0.0};
      device->begin_frame(frame);
      const QueryId alone = device->query({&state.view().bounds[first], 1});
      device->draw({&first, 1});
      const QueryId behind = device->query({&state.view().bounds[second], 1});
      device->flush();
      return std::pair(device->samples(alone), device->samples(behind));
    };
    const auto [cube, hidden_sphere] = samples({0.0, -0.25, 6.0}, 0, 1);
    EXPECT_GT(cube, 0U);
    EXPECT_EQ(hidden_sphere, 0U) << "no samples visible";
    const auto [sphere, cube_around_it] = samples({0.0, -0.25, -10.0}, 1, 0);
    EXPECT_GT(sphere, 0U);
    EXPECT_GT(cube_around_it, 0U) << "the cube shows round the sphere";
  }
}

TEST(QueryDemonstration, EveryMethodDrawsTheCubeAloneFromTheFront) {
  Scene scene;
  scene.meshes = {cube_mesh(), sphere_mesh(12)};
  scene.objects = {{0, placed({0.0, -0.25, 0.0}, {1.0, 0.5, 1.0}), none_id},
                   {1, placed({0.0, -0.25, -4.0}, glm::dvec3(0.4)), none_id}};
  const Camera front = looking({0.0, -0.25, 6.0}, {0.0, -0.25, 0.0});
  const Camera back = looking({0.0, -0.25, -10.0}, {0.0, -0.25, 0.0});
  QueryPlay stage(finished(std::move(scene), {front, front, back, back}), query_viewport);
  ModelledGpu device(gpu_presets().front().model);
  for (const char* method : {"occlusion.batched[batch=1]", "occlusion.stop_and_wait"}) {
    const std::vector<QueryFrame> frames = stage.run(method, device);
    EXPECT_EQ(frames[0].kept, std::vector<ObjectId>{0}) << method;
    EXPECT_EQ(frames[1].kept, std::vector<ObjectId>{0}) << method;
    EXPECT_EQ(frames[2].kept, (std::vector<ObjectId>{1, 0})) << method;
    EXPECT_EQ(frames[3].kept, (std::vector<ObjectId>{1, 0})) << method;
    EXPECT_EQ(frames[3].counts.queries, 2U) << method;
  }
}

TEST(FlatQueries, ChangeNoImageInStreetsAndAtCuts) { expect_exact(street()); }

TEST(FlatQueries, ChangeNoImageAmongPipes) { expect_exact(among_pipes()); }

TEST(FlatQueries, ChangeNoImageWhileObjectsMoveAppearAndDisappear) {
  expect_exact(changing_objects());
}

TEST(FlatQueries, ChangeNoImageWithTheEyeInBoxesAndAtTheNearPlane) { expect_exact(eye_in_boxes()); }

TEST(FlatQueries, ChangeNoImageWithThousandsOfQuestionsUnderWay) {
  QueryPlay stage(thousands_of_boxes(), query_viewport);
  OsMesaDevice device;
  for (const char* method : {"occlusion.batched[batch=1000]",
                             "occlusion.chc_flat[flush_every=1000]", "occlusion.last_frame"}) {
    const std::vector<QueryFrame> frames = stage.run(method, device);
    EXPECT_GT(frames[2].counts.queries, 2000U) << method;
    if (std::string(method) != "occlusion.last_frame") {
      EXPECT_EQ(frames[0].image_px + frames[1].image_px + frames[2].image_px, 0U) << method;
    }
  }
}

TEST(FlatQueries, AskAgainInTheSameWayAfterAReset) {
  QueryPlay stage(finished(small_city(), {looking({0.0, 1.7, 45.0}, {0.0, 1.7, 0.0}),
                                          looking({0.0, 1.7, 43.0}, {0.0, 1.7, 0.0})}),
                  query_viewport);
  for (const char* method : exact_methods) {
    ModelledGpu device(gpu_presets().front().model);
    const std::vector<QueryFrame> once = stage.run(method, device);
    const std::optional<double> clock = device.clock_ms();
    const std::vector<QueryFrame> again = stage.run(method, device);
    EXPECT_EQ(clock, device.clock_ms()) << method;
    for (std::size_t i = 0; i < once.size(); ++i) EXPECT_EQ(once[i].kept, again[i].kept) << method;
  }
}

TEST(Batched, ChangesStateAndWaitsLessOftenTheLargerItsBatchesAre) {
  const Camera camera = looking({0.0, 1.7, 45.0}, {0.0, 1.7, 0.0});
  QueryPlay stage(finished(small_city(), {camera, camera, camera}), query_viewport);
  ModelledGpu device(gpu_presets().front().model);
  DeviceCounts last = counts(stage.run("occlusion.stop_and_wait", device));
  for (const char* batch : {"1", "8", "40"}) {
    const DeviceCounts now =
        counts(stage.run("occlusion.batched[batch=" + std::string(batch) + "]", device));
    EXPECT_LT(now.state_changes, last.state_changes) << batch;
    EXPECT_LE(now.queries, last.queries) << batch;
    last = now;
  }
}

TEST(Batched, KeepsWhatItAskedInTheViewOnly) {
  QueryPlay stage(finished(small_city(), {looking({0.0, 1.7, 45.0}, {0.0, 1.7, 90.0})}),
                  query_viewport);
  ModelledGpu device(gpu_presets().front().model);
  const QueryFrame away = stage.run("occlusion.batched", device).front();
  EXPECT_LT(away.counts.queries, stage.scene().object_count() / 2);
}

/// A wall that is taken away in frame 3 and comes back in frame 6.
Play wall_that_goes() {
  MovingWallParameters parameters;
  parameters.targets = 60;
  const Camera camera = looking({0.0, 5.0, 12.0}, {0.0, 4.5, 0.0});
  Play play = finished(make_moving_wall(parameters), std::vector<Camera>(9, camera));
  play.steps[3].changes.hidden = {0};
  play.steps[6].changes.shown = {0};
  return play;
}

TEST(LastFrame, MissesWhatComesIntoViewForAsManyFramesAsItsAnswersAreLate) {
  QueryPlay stage(wall_that_goes(), query_viewport);
  OsMesaDevice device;
  for (const std::size_t late : {1U, 2U}) {
    const std::vector<QueryFrame> frames =
        stage.run("occlusion.last_frame[frames_late=" + std::to_string(late) + "]", device);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(frames[i].image_px > 0, i >= 3 && i < 3 + late) << late << " late, frame " << i;
    }
    EXPECT_LT(frames[2].kept.size(), stage.scene().object_count() / 2);
    // The wall itself is new in frame 6 and is drawn at once.
    EXPECT_TRUE(std::ranges::count(frames[6].kept, 0U) == 1);
    EXPECT_EQ(frames[2].counts.state_changes, 1U) << "one batch, at the end of the frame";
  }
}

TEST(Threshold, LosesMoreTheHigherItIs) {
  QueryPlay stage(finished(small_city(), {looking({0.0, 1.7, 45.0}, {0.0, 1.7, 0.0}),
                                          looking({30.0, 40.0, 60.0}, {0.0, 0.0, 0.0})}),
                  query_viewport);
  ModelledGpu device(gpu_presets().front().model);
  for (const std::string method : {"stop_and_wait", "batched", "chc_flat"}) {
    std::uint64_t last_px = 0;
    for (const char* threshold : {"0", "10", "200"}) {
      const std::uint64_t px =
          stage.image_px("occlusion." + method + "[threshold_px=" + threshold + "]", device);
      if (threshold[0] == '0') {
        EXPECT_EQ(px, 0U) << method;
      } else {
        EXPECT_GT(px, last_px) << method << ", " << threshold;
      }
      last_px = px;
    }
  }
}

}  // namespace
}  // namespace vislab
