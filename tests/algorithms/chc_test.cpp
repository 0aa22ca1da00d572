// CHC, CHC++ and their ideal: no image changes, whatever the camera and the objects do and
// whichever switch is off, and each asks in the way that it is made for.
#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>
#include <set>

#include "common/render/modelled_gpu.h"
#include "common/render/osmesa_device.h"
#include "common/scene/generators/generators.h"
#include "common/scene/generators/occlusion.h"
#include "common/spatial/query_hierarchy.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/query_play.h"

namespace vislab {
namespace {

constexpr Viewport viewport{127, 95};
/// Small units, so that small scenes have hierarchies.
const char* const exact_methods[] = {"occlusion.chc[leaf_triangles=100]",
                                     "occlusion.chc",
                                     "occlusion.chcpp[leaf_triangles=100]",
                                     "occlusion.chcpp",
                                     "occlusion.chcpp[leaf_triangles=100,batch=1]",
                                     "occlusion.chcpp[leaf_triangles=100,lazy=false]",
                                     "occlusion.chcpp[leaf_triangles=100,interval=1]",
                                     "occlusion.chcpp[leaf_triangles=100,retest=aligned]",
                                     "occlusion.chcpp[leaf_triangles=100,multiqueries=false]",
                                     "occlusion.chcpp[leaf_triangles=100,cost_model=slides]",
                                     "occlusion.chcpp[leaf_triangles=100,persistence=measured]",
                                     "occlusion.chcpp[leaf_triangles=100,max_boxes=2,sigma=3]",
                                     "occlusion.chcpp[leaf_triangles=100,tight_bounds=false]"};

Camera looking(const glm::dvec3& eye, const glm::dvec3& target) {
  return {look_at(eye, target), perspective_lens(degrees(60.0), viewport.aspect(), 0.3, 3000.0)};
}

Play finished(Scene scene, const std::vector<Camera>& cameras) {
  Play play;
  play.scene = std::move(scene);
  play.scene.finish();
  for (const Camera& camera : cameras) play.steps.push_back({camera, {}});
  return play;
}

Scene small_city() {
  CityParameters parameters;
  parameters.blocks_x = parameters.blocks_z = 6;
  parameters.roof_share = 0.5;
  parameters.street_boxes = 40;
  return make_city(parameters);
}

Play street() {
  return finished(
      small_city(),
      {looking({0.0, 1.7, 45.0}, {0.0, 1.7, 0.0}), looking({0.0, 1.7, 43.0}, {0.0, 1.7, 0.0}),
       looking({0.0, 1.7, 0.0}, {20.0, 4.0, 0.0}), looking({0.0, 1.7, 0.0}, {-20.0, 4.0, 3.0}),
       looking({12.5, 1.7, 1.0}, {0.0, 8.0, -30.0})});
}

Play standing(int frames) {
  return finished(small_city(), std::vector<Camera>(static_cast<std::size_t>(frames),
                                                    looking({0.0, 1.7, 45.0}, {0.0, 1.7, 0.0})));
}

std::uint64_t kept(const std::vector<QueryFrame>& frames) {
  std::uint64_t sum = 0;
  for (const QueryFrame& frame : frames) sum += frame.kept.size();
  return sum;
}

void expect_exact(Play play, double most_kept = 0.8) {
  QueryPlay stage(std::move(play), viewport);
  OsMesaDevice device;
  for (const char* method : exact_methods) {
    const std::vector<QueryFrame> frames = stage.run(method, device);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(frames[i].image_px, 0U) << method << ", frame " << i;
      const std::set<ObjectId> once(frames[i].kept.begin(), frames[i].kept.end());
      EXPECT_EQ(once.size(), frames[i].kept.size()) << method << ", frame " << i;
    }
    const auto all = static_cast<double>(stage.scene().object_count() * frames.size());
    EXPECT_LT(static_cast<double>(kept(frames)), most_kept * all) << method;
  }
}

TEST(Coherent, ChangesNoImageInStreetsAndAtCuts) { expect_exact(street()); }

TEST(Coherent, ChangesNoImageAmongPipes) {
  PlantParameters parameters;
  parameters.bays_x = 4;
  parameters.bays_z = 2;
  parameters.segments = 4;
  expect_exact(finished(make_plant(parameters), {looking({-14.0, 1.7, 0.0}, {17.0, 1.7, 0.0}),
                                                 looking({-12.0, 1.7, 0.0}, {17.0, 1.7, 1.0}),
                                                 looking({17.0, 1.7, 11.0}, {-14.0, 1.7, 0.0}),
                                                 looking({17.0, 1.7, 11.0}, {-14.0, 1.7, 0.0})}));
}

TEST(Coherent, ChangesNoImageWhileObjectsMoveAppearAndDisappear) {
  MovingWallParameters parameters;
  parameters.targets = 300;
  const Camera camera = looking({0.0, 5.0, 12.0}, {0.0, 4.5, 0.0});
  Play play = finished(make_moving_wall(parameters), std::vector<Camera>(7, camera));
  const auto wall_at = [&](std::size_t step, const glm::dvec3& place) {
    play.steps[step].changes.moved = {0};
    play.steps[step].changes.transforms = {placed(place, {10.0, 6.0, 0.15})};
  };
  wall_at(2, {8.0, 6.0, 0.0});
  wall_at(3, {0.0, 6.0, 0.0});
  play.steps[4].changes.hidden = {0, 3, 4, 5};
  play.steps[5].changes.shown = {0, 4};
  play.steps[5].changes.hidden = {7, 8, 9, 10};
  play.steps[6].changes.shown = {3, 5, 7, 8};
  expect_exact(std::move(play), 0.95);
}

TEST(Coherent, ChangesNoImageWithTheEyeInBoxesAndAtTheNearPlane) {
  Scene scene;
  scene.meshes = {cube_mesh(), sphere_mesh(8)};
  // A hall around everything, a sphere whose box holds the eye though it does not, a wall, and
  // spheres behind it.
  scene.objects = {{0, placed({0.0, 0.0, 0.0}, glm::dvec3(60.0)), none_id},
                   {1, placed({0.0, 0.0, 0.0}, glm::dvec3(3.0)), none_id},
                   {0, placed({0.0, 0.0, -10.0}, {20.0, 20.0, 0.2}), none_id}};
  for (int i = 0; i < 20; ++i) {
    scene.objects.push_back({1, placed({1.5 * (i - 10), 0.3 * i, -20.0}), none_id});
  }
  expect_exact(finished(std::move(scene), {looking({2.5, 2.5, 2.5}, {0.0, 0.0, -10.0}),
                                           looking({0.0, 0.0, -9.6}, {0.0, 0.0, -20.0}),
                                           looking({0.1, 0.0, -9.9}, {8.0, 0.0, -12.0}),
                                           looking({0.0, 0.0, 2.9}, {0.0, 0.0, -20.0})}),
               1.0);
}

TEST(Coherent, RepeatsItselfOnADeviceThatKeepsItsOwnTime) {
  QueryPlay stage(street(), viewport);
  for (const char* method : exact_methods) {
    ModelledGpu device(gpu_presets().front().model);
    const std::vector<QueryFrame> once = stage.run(method, device);
    const std::optional<double> clock = device.clock_ms();
    const std::vector<QueryFrame> again = stage.run(method, device);
    EXPECT_EQ(clock, device.clock_ms()) << method;
    for (std::size_t i = 0; i < once.size(); ++i) EXPECT_EQ(once[i].kept, again[i].kept) << method;
  }
}

/// Queries and changes of state in the last frames of a camera that stands.
DeviceCounts settled(QueryPlay& stage, const std::string& method) {
  OsMesaDevice device;
  const std::vector<QueryFrame> frames = stage.run(method, device);
  DeviceCounts sum;
  for (std::size_t i = frames.size() / 2; i < frames.size(); ++i) {
    sum.queries += frames[i].counts.queries;
    sum.query_boxes += frames[i].counts.query_boxes;
    sum.state_changes += frames[i].counts.state_changes;
  }
  return sum;
}

TEST(ChcPlusPlus, AsksLessAndChangesStateLessByEachOfItsDevices) {
  QueryPlay stage(standing(16), viewport);
  const std::string units = "leaf_triangles=100";
  const DeviceCounts plain = settled(stage, "occlusion.chc[" + units + "]");
  const DeviceCounts all = settled(stage, "occlusion.chcpp[" + units + "]");
  EXPECT_LT(all.queries, plain.queries / 2);
  EXPECT_LT(all.state_changes, plain.state_changes / 4);
  EXPECT_LT(all.queries,
            settled(stage, "occlusion.chcpp[" + units + ",multiqueries=false]").queries);
  EXPECT_LT(all.queries, settled(stage, "occlusion.chcpp[" + units + ",interval=1]").queries);
  EXPECT_LT(all.state_changes,
            settled(stage, "occlusion.chcpp[" + units + ",lazy=false]").state_changes);
  EXPECT_LT(
      all.state_changes,
      settled(stage, "occlusion.chcpp[" + units + ",batch=1,multiqueries=false]").state_changes);
}

TEST(ChcPlusPlus, SpreadsItsRetestsUnlessTheyAreAligned) {
  QueryPlay stage(standing(14), viewport);
  ModelledGpu device(gpu_presets().front().model);
  const auto busiest = [&](const std::string& retest) {
    std::uint64_t most = 0;
    const std::vector<QueryFrame> frames = stage.run(
        "occlusion.chcpp[leaf_triangles=100,interval=6,multiqueries=false,retest=" + retest + "]",
        device);
    // The first frame asks about everything.
    for (std::size_t i = 2; i < frames.size(); ++i) most = std::max(most, frames[i].counts.queries);
    return most;
  };
  EXPECT_LT(busiest("random"), busiest("aligned"));
}

TEST(ChcPlusPlus, LosesMoreTheHigherItsThresholdIs) {
  QueryPlay stage(street(), viewport);
  ModelledGpu device(gpu_presets().front().model);
  for (const std::string method : {"chc", "chcpp"}) {
    const auto lost = [&](const std::string& threshold) {
      return stage.image_px(
          "occlusion." + method + "[leaf_triangles=20,threshold_px=" + threshold + "]", device);
    };
    EXPECT_EQ(lost("0"), 0U);
    EXPECT_GT(lost("400"), lost("20"));
  }
}

/// Offers only some objects, in two calls of a frame.
TEST(Coherent, KeepsToWhatItIsOffered) {
  const Play play = standing(4);
  const Camera camera = play.steps[0].camera;
  std::vector<ObjectId> even, odd;
  for (ObjectId object = 0; object < play.scene.object_count(); ++object) {
    (object % 2 == 0 ? even : odd).push_back(object);
  }
  for (const char* method : exact_methods) {
    OsMesaDevice device;
    device.load(play.scene);
    BuildContext context;
    context.device = &device;
    CullerRun run(method, play.scene, context);
    DrawingSink sink(device);
    std::vector<ObjectId> last;
    for (std::uint64_t i = 0; i < 3; ++i) {
      const SceneState state(play.scene);
      const Frame frame{i, camera, viewport, state.view(), 0.0};
      run.culler().update(frame, {});
      sink.begin(play.scene, frame);
      // In the middle frame a half only: what is not offered is not taken for hidden.
      for (const std::vector<ObjectId>* half : {&even, &odd}) {
        if (i == 1 && half == &odd) continue;
        const std::span<const ObjectId> span = *half;
        run.culler().cull(frame, Candidates::of(std::span(&span, 1)), sink);
        sink.flush();
      }
      std::vector<ObjectId> now;
      for (const TriangleRange& range : sink.emitted()) now.push_back(range.object);
      std::ranges::sort(now);
      EXPECT_TRUE(std::ranges::adjacent_find(now) == now.end()) << method;
      if (i == 1) {
        for (const ObjectId object : now) EXPECT_EQ(object % 2, 0U) << method;
      }
      last = std::move(now);
    }
    EXPECT_GT(last.size(), 4U) << method;
    EXPECT_LT(last.size(), play.scene.object_count() / 2) << method;
  }
}

/// Truth that is written down.
class SomeAreVisible : public TruthSource {
 public:
  explicit SomeAreVisible(std::vector<ObjectId> objects) : objects_(std::move(objects)) {}
  std::span<const ObjectId> visible_objects(std::uint64_t) const override { return objects_; }
  std::span<const TriangleRange> visible_triangles(std::uint64_t) const override { return {}; }

 private:
  std::vector<ObjectId> objects_;
};

TEST(NodeOracle, KeepsWholeUnitsAndOnlyThoseThatHoldSomethingVisible) {
  const Play play = standing(1);
  const SomeAreVisible truth({5, 17, 30});
  BuildContext context;
  context.truth = &truth;
  // High above, everything is in the view.
  const Camera camera = looking({0.0, 400.0, 1.0}, {0.0, 0.0, 0.0});
  for (const char* leaf : {"1", "100", "400"}) {
    CullerRun run("oracle[level=node,leaf_triangles=" + std::string(leaf) + "]", play.scene,
                  context);
    QueryHierarchy hierarchy(static_cast<std::uint32_t>(std::atoi(leaf)));
    hierarchy.build(play.scene);
    std::set<ObjectId> expected;
    for (const ObjectId object : truth.visible_objects(0)) {
      const std::span<const ObjectId> unit = hierarchy.objects(hierarchy.unit_of(object));
      expected.insert(unit.begin(), unit.end());
    }
    const std::vector<ObjectId> objects = run.objects(camera);
    EXPECT_EQ(std::set<ObjectId>(objects.begin(), objects.end()), expected) << leaf;
    EXPECT_EQ(objects.size(), expected.size()) << leaf;
  }
}

}  // namespace
}  // namespace vislab
