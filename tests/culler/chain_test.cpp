#include "common/culler/chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "algorithms/all_cullers.h"
#include "common/culler/visible_set.h"
#include "experiments/contract/contract.h"
#include "experiments/contract/small_scenes.h"
#include "tests/culler/test_cullers.h"

namespace vislab {
namespace {

Registry all_cullers() {
  Registry registry;
  register_all_cullers(registry);
  add_test_cullers(registry);
  return registry;
}

/// Cubes in a row along -z, the nearest first.
Scene row_of_cubes(std::size_t count) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (std::size_t i = 0; i < count; ++i) {
    scene.objects.push_back({0, placed({0.0, 0.0, -4.0 * static_cast<double>(i)}), none_id});
  }
  scene.finish();
  return scene;
}

Camera down_the_row() {
  return {look_at({0.0, 0.0, 10.0}, {0.0, 0.0, 0.0}), perspective_lens(1.0, 1.0, 0.1, 1e6)};
}

/// A chain of scripted stages, at work on a row of cubes.
class Chained : public testing::Test {
 protected:
  using Cull = ScriptedCuller::Cull;

  void stage(Granularity granularity, Cull cull) {
    stages_.push_back(std::make_unique<ScriptedCuller>(
        test_info("scripted", granularity, Guarantee::conservative, Repeatability::stateless),
        std::move(cull)));
  }
  /// A stage that notes each call: form and number of spans.
  void listener(Granularity granularity = Granularity::triangle) {
    stage(granularity, [this](const Frame&, const Candidates& offered, DrawSink& out) {
      ++calls_;
      spans_ += offered.object_runs().size() + offered.range_runs().size();
      last_form_ = offered.form();
      for (const auto& run : offered.object_runs()) {
        heard_.insert(heard_.end(), run.begin(), run.end());
        first_ids_.push_back(run.data());
        out.objects(run);
      }
      for (const auto& run : offered.range_runs()) out.ranges(run);
      if (offered.form() == Candidates::Form::everything) out.everything();
    });
  }

  const std::vector<TriangleRange>& run(const Scene& scene,
                                        const Candidates& candidates = Candidates::everything()) {
    state_.emplace(scene);
    chain_ = make_chain(std::move(stages_));
    chain_->build(scene, {});
    frame_ = {0, down_the_row(), {64, 64}, state_->view(), 0.0};
    sink_.start(scene, frame_);
    chain_->update(frame_, {});
    chain_->cull(frame_, candidates, sink_);
    return sink_.emitted();
  }

  std::vector<std::unique_ptr<ICuller>> stages_;
  std::optional<SceneState> state_;
  std::unique_ptr<ICuller> chain_;
  Frame frame_;
  RecordingSink sink_;

  int calls_ = 0;
  std::size_t spans_ = 0;
  Candidates::Form last_form_ = Candidates::Form::everything;
  std::vector<ObjectId> heard_;
  std::vector<const ObjectId*> first_ids_;
};

TEST_F(Chained, OffersEverythingInOneWord) {
  const Scene scene = row_of_cubes(4);
  listener();
  listener();
  listener();
  EXPECT_EQ(run(scene).size(), 4U);
  EXPECT_EQ(calls_, 3);
  EXPECT_EQ(last_form_, Candidates::Form::everything);
  EXPECT_EQ(spans_, 0U);
}

TEST_F(Chained, CollectsEmissionsAndCallsTheNextStageOnce) {
  const Scene scene = row_of_cubes(6);
  const std::vector<ObjectId> ids = {5, 0, 3, 1};
  stage(Granularity::object, [&](const Frame&, const Candidates&, DrawSink& out) {
    for (const ObjectId& id : ids) out.objects({&id, 1});
    out.objects({});
  });
  listener();
  run(scene);
  EXPECT_EQ(calls_, 1);
  EXPECT_EQ(spans_, 4U);  // the empty one is not worth an offer
  EXPECT_EQ(heard_, ids);
}

TEST_F(Chained, DoesNotCallAStageThatNothingIsOfferedTo) {
  const Scene scene = row_of_cubes(2);
  stage(Granularity::object, [](const Frame&, const Candidates&, DrawSink&) {});
  listener();
  EXPECT_TRUE(run(scene).empty());
  EXPECT_EQ(calls_, 0);
}

TEST_F(Chained, HandsOnAtAFlushAndAtTheEnd) {
  const Scene scene = row_of_cubes(6);
  const std::vector<ObjectId> ids = {0, 1, 2, 3, 4, 5};
  std::vector<std::size_t> drawn;  // how much the last sink had when the flush returned
  stage(Granularity::object, [&](const Frame&, const Candidates&, DrawSink& out) {
    const std::span<const ObjectId> all(ids);
    out.objects(all.first(2));
    out.flush();
    drawn.push_back(sink_.emitted().size());
    out.flush();
    out.objects(all.subspan(2, 3));
    out.flush();
    drawn.push_back(sink_.emitted().size());
    out.objects(all.last(1));
  });
  listener();
  listener();
  run(scene);
  EXPECT_EQ(drawn, (std::vector<std::size_t>{2, 5}));
  EXPECT_EQ(sink_.emitted().size(), 6U);
  EXPECT_EQ(calls_, 6);  // three batches through two stages; the empty flush is none
  EXPECT_EQ(sink_.flushes(), 3U);
}

TEST_F(Chained, TurnsMixedFormsIntoRangesInTheOrderOfEmission) {
  const Scene scene = row_of_cubes(4);
  stages_.push_back(std::make_unique<MixedForms>());
  listener();
  const std::vector<TriangleRange> expected = {{0, 0, 12}, {1, 0, 6}, {1, 6, 6},
                                               {2, 0, 12}, {3, 0, 6}, {3, 6, 6}};
  EXPECT_EQ(run(scene), expected);
  EXPECT_EQ(calls_, 1);
  EXPECT_EQ(last_form_, Candidates::Form::ranges);
}

TEST_F(Chained, PutsTheRangesBackBehindAStageThatSeesOnlyObjects) {
  const Scene scene = row_of_cubes(5);
  const std::vector<TriangleRange> ranges = {{4, 3, 2}, {1, 0, 1}, {2, 5, 5}, {1, 7, 2}, {4, 0, 1}};
  stage(Granularity::triangle, [&](const Frame&, const Candidates&, DrawSink& out) {
    out.ranges(std::span(ranges).first(3));
    out.ranges(std::span(ranges).subspan(3));
  });
  std::vector<ObjectId> kept;
  stage(Granularity::object, [&](const Frame&, const Candidates& offered, DrawSink& out) {
    ASSERT_EQ(offered.form(), Candidates::Form::objects);
    for (const auto& run : offered.object_runs()) {
      heard_.insert(heard_.end(), run.begin(), run.end());
    }
    kept = {1, 4};
    out.objects(kept);
  });
  listener();
  // The order of the stage that kept them; within an object that of the first emission.
  EXPECT_EQ(run(scene), (std::vector<TriangleRange>{{1, 0, 1}, {1, 7, 2}, {4, 3, 2}, {4, 0, 1}}));
  EXPECT_EQ(heard_, (std::vector<ObjectId>{4, 1, 2}));
  EXPECT_EQ(last_form_, Candidates::Form::ranges);
}

TEST_F(Chained, PutsTheRangesBackForItsFirstStageToo) {
  const Scene scene = row_of_cubes(3);
  listener(Granularity::object);
  listener();
  const std::vector<TriangleRange> ranges = {{2, 1, 3}, {0, 4, 4}};
  const std::span<const TriangleRange> span(ranges);
  EXPECT_EQ(run(scene, Candidates::of(std::span<const std::span<const TriangleRange>>(&span, 1))),
            ranges);
  EXPECT_EQ(heard_, (std::vector<ObjectId>{2, 0}));
}

TEST_F(Chained, RefusesAnObjectStageThatEmitsWhatItWasNotOffered) {
  const Scene scene = row_of_cubes(3);
  const std::vector<TriangleRange> range = {{2, 1, 3}};
  const ObjectId other = 1;
  stage(Granularity::triangle,
        [&](const Frame&, const Candidates&, DrawSink& out) { out.ranges(range); });
  stage(Granularity::object, [&](const Frame&, const Candidates&, DrawSink& out) {
    out.objects({&other, 1});
  });
  EXPECT_THROW(run(scene), std::logic_error);
}

TEST_F(Chained, MayItselfBeAStage) {
  const Scene scene = row_of_cubes(4);
  const std::vector<ObjectId> ids = {3, 2, 1, 0};
  std::vector<std::unique_ptr<ICuller>> inner;
  inner.push_back(std::make_unique<ScriptedCuller>(
      test_info("inner", Granularity::object, Guarantee::conservative, Repeatability::stateless),
      [&](const Frame&, const Candidates&, DrawSink& out) {
        out.objects(std::span(ids).first(2));
        out.flush();
        EXPECT_EQ(sink_.emitted().size(), 5U);  // through all stages behind: 3 in quarters, 2 whole
        out.objects(std::span(ids).last(2));
      }));
  inner.push_back(std::make_unique<MixedForms>());
  listener();
  stages_.push_back(make_chain(std::move(inner)));
  listener();
  stages_.push_back(std::make_unique<MixedForms>());
  run(scene);
  EXPECT_EQ(sink_.set().triangle_count(), 48U);
}

TEST(Chain, HasTheWeakestPromisesAndTheFinestGranularityOfItsStages) {
  const Registry registry = all_cullers();
  const CullerInfo exact =
      registry.make("frustum.flat > occlusion.stop_and_wait > backface.polygon")->info();
  EXPECT_EQ(exact.name, "frustum.flat > occlusion.stop_and_wait > backface.polygon");
  EXPECT_EQ(exact.guarantee, Guarantee::image_exact);
  EXPECT_EQ(exact.repeatability, Repeatability::stateless);
  EXPECT_EQ(exact.granularity, Granularity::triangle);
  EXPECT_TRUE(exact.needs_device);
  EXPECT_FALSE(exact.needs_truth);
  const CullerInfo late = registry.make("oracle > test.late")->info();
  EXPECT_EQ(late.guarantee, Guarantee::approximate);
  EXPECT_EQ(late.repeatability, Repeatability::path);
  EXPECT_EQ(late.granularity, Granularity::object);
  EXPECT_TRUE(late.needs_truth);
}

TEST(Chain, CullsWhatAllItsStagesCullOrElseWhatIsHidden) {
  const Registry registry = all_cullers();
  const auto culls = [&](const char* chain) { return registry.make(chain)->info().culls; };
  EXPECT_EQ(culls("frustum.flat > frustum.flat"), Culls::outside_frustum);
  EXPECT_EQ(culls("backface.polygon > backface.polygon"), Culls::back_faces);
  EXPECT_EQ(culls("frustum.flat > backface.polygon"), Culls::hidden);
  EXPECT_EQ(culls("frustum.flat > backface.polygon > frustum.flat"), Culls::hidden);
  EXPECT_EQ(culls("occlusion.stop_and_wait"), Culls::hidden);
}

TEST(Chain, AddsUpTheCountersOfItsStages) {
  const Registry registry = all_cullers();
  const Scene scene = row_of_cubes(3);
  const SceneState state(scene);
  const std::string flat = "frustum.flat[kernel=scalar]";
  const std::unique_ptr<ICuller> chain = registry.make(flat + " > " + flat + " > none");
  chain->build(scene, {});
  const Frame frame{0, down_the_row(), {64, 64}, state.view(), 0.0};
  RecordingSink sink;
  sink.start(scene, frame);
  chain->cull(frame, Candidates::everything(), sink);
  const Counters expected = {{"objects_tested", 6}, {"plane_tests", 36}};
  EXPECT_EQ(chain->counters(), expected);
}

class ChainUnderContract : public testing::TestWithParam<std::string> {};

TEST_P(ChainUnderContract, KeepsIt) {
  for (const ContractResult& result : check_contract(all_cullers(), GetParam())) {
    EXPECT_TRUE(result.passed) << result.check << ": " << result.message;
  }
}

INSTANTIATE_TEST_SUITE_P(Chain, ChainUnderContract,
                         testing::Values("test.mixed", "test.late", "test.mixed > frustum.flat",
                                         "test.mixed > backface.polygon > test.mixed",
                                         "test.late > backface.polygon",
                                         "test.mixed > occlusion.stop_and_wait > test.mixed",
                                         "frustum.flat > occlusion.stop_and_wait > test.late"));

TEST(ChainCheck, FindsAStatefulCullerThatCallsItselfStateless) {
  bool found = false;
  for (const ContractResult& result : check_contract(all_cullers(), "test.late_but_stateless")) {
    const bool repeats = result.check.find("come again") != std::string::npos;
    EXPECT_NE(result.passed, repeats) << result.check << ": " << result.message;
    found |= repeats;
  }
  EXPECT_TRUE(found);
}

/// A device that notes how much was drawn before each query, and answers as it is told.
class ListeningDevice : public RenderDevice {
 public:
  explicit ListeningDevice(const Scene& scene) : scene_(&scene) {}

  void load(const Scene&) override {}
  void begin_frame(const Frame&) override {}
  void draw(std::span<const ObjectId> objects) override {
    for (const ObjectId object : objects) drawn_ += scene_->triangle_count(object);
  }
  void draw(std::span<const TriangleRange> ranges) override {
    for (const TriangleRange& range : ranges) drawn_ += range.count;
  }
  void cull_back_faces(std::span<const ObjectId>) override {}
  std::span<const ObjectId> one_sided() const override { return {}; }
  QueryId query(std::span<const Aabb>) override {
    drawn_before_query_.push_back(drawn_);
    return {0, static_cast<std::uint32_t>(drawn_before_query_.size() - 1)};
  }
  void flush() override {}
  bool ready(QueryId) override { return true; }
  std::uint64_t samples(QueryId query) override { return query.index % 2 == 0 ? 1 : 0; }
  void finish() override {}
  std::string description() const override { return "listening"; }

  const std::vector<std::uint64_t>& drawn_before_query() const { return drawn_before_query_; }

 private:
  const Scene* scene_;
  std::uint64_t drawn_ = 0;
  std::vector<std::uint64_t> drawn_before_query_;
};

/// Draws at once.
class DrawingSink : public DrawSink {
 public:
  explicit DrawingSink(RenderDevice& device) : device_(&device) {}
  void everything() override { FAIL() << "not expected here"; }
  void objects(std::span<const ObjectId> ids) override { device_->draw(ids); }
  void ranges(std::span<const TriangleRange> ranges) override { device_->draw(ranges); }
  void flush() override {}

 private:
  RenderDevice* device_;
};

TEST(Chain, HasDrawnWhatADrawingStageInItsMiddleKeptWhenThatAsks) {
  const Scene scene = row_of_cubes(5);
  const SceneState state(scene);
  ListeningDevice device(scene);
  BuildContext context;
  context.device = &device;
  const std::unique_ptr<ICuller> chain =
      all_cullers().make("frustum.flat > occlusion.stop_and_wait > backface.polygon");
  chain->build(scene, context);
  const Frame frame{0, down_the_row(), {64, 64}, state.view(), 0.0};
  DrawingSink sink(device);
  chain->cull(frame, Candidates::everything(), sink);
  // Every second cube is kept; of a kept one the front, two triangles, comes through the last
  // stage.
  EXPECT_EQ(device.drawn_before_query(), (std::vector<std::uint64_t>{0, 2, 2, 4, 4}));
}

/// Costs of a link over a field of a million objects, counted, not timed: what counts is how often
/// a successor is called and that no id is copied.
class MillionObjects : public Chained {
 protected:
  static constexpr std::size_t count = 1'000'000;

  static Scene field() {
    Scene scene;
    scene.meshes = {cube_mesh()};
    scene.objects.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double x = 3.0 * static_cast<double>(i % 1000);
      const double z = -3.0 * static_cast<double>(i / 1000);
      scene.objects.push_back({0, placed({x, 0.0, z}), none_id});
    }
    scene.finish();
    return scene;
  }
};

TEST_F(MillionObjects, PassThroughAsOneWordOrAsSpansThatAreNeverCopied) {
  const Scene scene = field();
  listener();
  listener();
  listener();
  run(scene);
  EXPECT_EQ(calls_, 3);
  EXPECT_EQ(spans_, 0U);

  std::vector<ObjectId> order(count);
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::reverse(order);  // a hierarchy's own order
  constexpr std::size_t run_length = 1000;
  constexpr std::size_t runs_in_batch = 250;
  std::vector<const ObjectId*> emitted;
  stage(Granularity::object, [&](const Frame&, const Candidates&, DrawSink& out) {
    for (std::size_t first = 0; first < count; first += run_length) {
      const std::span<const ObjectId> ids = std::span(order).subspan(first, run_length);
      emitted.push_back(ids.data());
      out.objects(ids);
      if (emitted.size() % runs_in_batch == 0) out.flush();
    }
  });
  calls_ = 0;
  listener();
  run(scene);
  EXPECT_EQ(calls_, 4);  // one call a batch
  EXPECT_EQ(spans_, count / run_length);
  EXPECT_EQ(first_ids_, emitted);  // the spans that were emitted, not copies of them
  EXPECT_EQ(sink_.emitted().size(), count);
}

}  // namespace
}  // namespace vislab
