// CHC, CHC++ and their ideal: no image changes, whatever the camera and the objects do and
// whichever switch is off, and each asks in the way that it is made for.
#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>
#include <set>

#include "common/render/modelled_gpu.h"
#include "common/render/osmesa_device.h"
#include "common/spatial/query_hierarchy.h"
#include "tests/algorithms/query_scenes.h"

namespace vislab {
namespace {

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
                                     "occlusion.chcpp[leaf_triangles=100,division=finest]",
                                     "occlusion.chcpp[leaf_triangles=100,tight_bounds=false]",
                                     "occlusion.chcpp[leaf_triangles=100,open_unasked=false]",
                                     "occlusion.chcpp[leaf_triangles=100,reask=false]",
                                     "occlusion.chcpp[leaf_triangles=100,skip_vain=false]",
                                     "occlusion.chcpp[leaf_triangles=100,hand_over_triangles=50]",
                                     "occlusion.chcpp[leaf_triangles=100,hand_over_triangles=0]",
                                     "occlusion.chcpp[leaf_triangles=100,sleep=false]"};

Play standing(int frames) {
  return finished(small_city(), std::vector<Camera>(static_cast<std::size_t>(frames),
                                                    looking({0.0, 1.7, 45.0}, {0.0, 1.7, 0.0})));
}

void expect_exact(Play play, double most_kept = 0.8) {
  QueryPlay stage(std::move(play), query_viewport);
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

TEST(Coherent, ChangesNoImageAmongPipes) { expect_exact(among_pipes()); }

TEST(Coherent, ChangesNoImageWhileObjectsMoveAppearAndDisappear) {
  expect_exact(changing_objects(), 0.95);
}

TEST(Coherent, ChangesNoImageWithTheEyeInBoxesAndAtTheNearPlane) {
  expect_exact(eye_in_boxes(), 1.0);
}

/// What a method keeps, and asks, in two passes with a reset between them.
void expect_the_same_after_a_reset(QueryPlay& stage, RenderDevice& device) {
  for (const char* method : exact_methods) {
    const auto [once, again] = stage.run_twice(method, device);
    for (std::size_t i = 0; i < once.size(); ++i) {
      EXPECT_EQ(once[i].kept, again[i].kept) << method << ", frame " << i;
      EXPECT_EQ(once[i].counts.named(), again[i].counts.named()) << method << ", frame " << i;
    }
  }
}

TEST(Coherent, RepeatsItselfOnADeviceThatKeepsItsOwnTime) {
  QueryPlay stage(street(), query_viewport);
  ModelledGpu device(gpu_presets().front().model);
  expect_the_same_after_a_reset(stage, device);
  for (const char* method : {"occlusion.chc", "occlusion.chcpp"}) {
    stage.run(method, device);
    const std::optional<double> clock = device.clock_ms();
    stage.run(method, device);
    EXPECT_EQ(clock, device.clock_ms()) << method;
  }
}

/// In a process of its own, since OSMesa reads how many threads it has when its first context is
/// made.
TEST(CoherentDeathTest, RepeatsItselfOnASynchronousDevice) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto run = [] {
    ::setenv("LP_NUM_THREADS", "0", 1);
    QueryPlay stage(street(), query_viewport);
    OsMesaDevice device;
    expect_the_same_after_a_reset(stage, device);
    std::_Exit(::testing::Test::HasFailure() ? 1 : 0);
  };
  EXPECT_EXIT(run(), ::testing::ExitedWithCode(0), "");
}

TEST(Coherent, ChangesNoImageWithThousandsOfQuestionsUnderWay) {
#if defined(__SANITIZE_ADDRESS__)
  constexpr Viewport viewport{128, 128};
#else
  constexpr Viewport viewport{512, 512};
#endif
  Play play = thousands_of_boxes(0.5, 2.0);
  play.steps.erase(play.steps.begin());
  QueryPlay stage(std::move(play), viewport);
  OsMesaDevice device;
  for (const char* method :
       {"occlusion.chc[leaf_triangles=1]",
        "occlusion.chcpp[leaf_triangles=1,batch=10000,multiqueries=false,interval=1,reask=false,"
        "skip_vain=false]"}) {
    std::uint64_t most = 0;
    for (const QueryFrame& frame : stage.run(method, device)) {
      EXPECT_EQ(frame.image_px, 0U) << method;
      most = std::max(most, frame.counts.queries);
    }
    EXPECT_GT(most, 2000U) << method;
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
  QueryPlay stage(standing(16), query_viewport);
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
  QueryPlay stage(standing(14), query_viewport);
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
  QueryPlay stage(street(), query_viewport);
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
      const Frame frame{i, camera, query_viewport, state.view(), 0.0};
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
