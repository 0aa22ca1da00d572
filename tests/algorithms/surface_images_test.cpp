#include <gtest/gtest.h>

#include <algorithm>

#include "common/judge/surface_judge.h"
#include "common/scene/generators/surfaces.h"
#include "experiments/contract/scenario.h"
#include "run_culler.h"
#include "tests/input_error.h"

namespace vislab {
namespace {

/// A method at work in a scenario.
class Painted {
 public:
  Painted(const std::string& spec, const Scenario& scenario)
      : scenario_(&scenario), run_(spec, scenario.scene()) {}

  /// Of a frame; the image stays until the next.
  SurfaceVerdict judge(std::size_t index) {
    const Frame frame = scenario_->frame(index);
    sink_.start(scenario_->scene(), frame);
    run_.culler().cull(frame, Candidates::everything(), sink_);
    return judge_surface(frame, scenario_->scene(), scenario_->truth().frame(index), image());
  }
  /// Sum over all frames.
  SurfaceVerdict judge_all() {
    SurfaceVerdict sum;
    for (std::size_t i = 0; i < scenario_->frame_count(); ++i) {
      const SurfaceVerdict one = judge(i);
      sum.surface_px += one.surface_px;
      sum.disputed_surface_px += one.disputed_surface_px;
    }
    return sum;
  }
  std::span<const TriangleId> image() { return run_.culler().surface_image(); }
  std::uint64_t counter(std::string_view name) const { return run_.counter(name); }
  const RecordingSink& sink() const { return sink_; }

 private:
  const Scenario* scenario_;
  CullerRun run_;
  RecordingSink sink_;
};

const std::vector<std::string>& exact_methods() {
  static const std::vector<std::string> specs = {"surface.zbuffer",
                                                 "surface.zbuffer[convention=reversed]",
                                                 "surface.zbuffer[bits=float,convention=reversed]",
                                                 "surface.bsp",
                                                 "surface.bsp[order=front_to_back]",
                                                 "surface.bsp[splitter=first]"};
  return specs;
}

TEST(SurfaceImages, OfExactMethodsAreTruthsOnEverySmallScene) {
  std::uint64_t disputed = 0;
  for (SmallScene& small : small_scenes()) {
    const Scenario scenario(std::move(small));
    for (const std::string& spec : exact_methods()) {
      Painted painted(spec, scenario);
      for (std::size_t i = 0; i < scenario.frame_count(); ++i) {
        const SurfaceVerdict verdict = painted.judge(i);
        EXPECT_EQ(verdict.surface_px, 0U) << spec << ", " << scenario.name() << ", frame " << i;
        disputed += verdict.disputed_surface_px;
      }
    }
  }
  std::cout << disputed << " pixels excused\n";
}

TEST(SurfaceImages, OfTreesAreTheSameInBothOrdersAndNothingIsDrawnTwiceFrontToBack) {
  for (SmallScene& small : small_scenes()) {
    const bool moves = small.name.find("moves") != std::string::npos;
    const Scenario scenario(std::move(small));
    Painted painter("surface.bsp", scenario);
    Painted coverage("surface.bsp[order=front_to_back]", scenario);
    std::uint64_t owned = 0;
    for (std::size_t i = 0; i < scenario.frame_count(); ++i) {
      painter.judge(i);
      coverage.judge(i);
      EXPECT_TRUE(std::ranges::equal(painter.image(), coverage.image()))
          << scenario.name() << ", frame " << i;
      owned += static_cast<std::uint64_t>(
          std::ranges::count_if(coverage.image(), [](TriangleId id) { return id != none_id; }));
    }
    // What has moved is drawn over the tree's image.
    if (!moves) {
      EXPECT_EQ(coverage.counter("pixels_written"), owned) << scenario.name();
    }
    EXPECT_GE(painter.counter("pixels_written"), owned) << scenario.name();
  }
}

/// A scene by itself, from before it.
SmallScene seen_from(Scene scene, std::vector<glm::dvec3> eyes,
                     const Viewport& viewport = {96, 80}) {
  scene.finish();
  Path path;
  for (const glm::dvec3& eye : eyes) {
    path.frames.push_back({{look_at(eye, {0.0, 0.0, 0.0}),
                            perspective_lens(degrees(60.0), viewport.aspect(), 0.1, 100.0)},
                           {}});
  }
  return {"a test's", std::move(scene), std::move(path), viewport};
}

const std::vector<glm::dvec3> before = {{0.013, 0.2, 2.5}, {-0.4, 0.3, 2.0}};

TEST(SurfaceImages, OfSpansAreWrongWherePolygonsGoThroughEachOtherAndOthersAreNot) {
  CrossingQuadsParameters crossing;
  crossing.penetration = 1.0;
  const Scenario scenario(seen_from(make_crossing_quads(crossing), before));
  EXPECT_GT(Painted("surface.span_buffer", scenario).judge_all().surface_px, 50U);
  for (const std::string& spec : exact_methods()) {
    EXPECT_EQ(Painted(spec, scenario).judge_all().surface_px, 0U) << spec;
  }
}

TEST(SurfaceImages, OfSpansAreTheZBuffersWhereNothingInterpenetratesInRingsToo) {
  CyclicBarsParameters ring;
  ring.tilt_deg = 10.0;
  ScanlineFenceParameters fence;
  fence.polygons = 60;
  std::vector<Scenario> scenarios;
  scenarios.emplace_back(seen_from(make_cyclic_bars(ring), before));
  scenarios.emplace_back(seen_from(make_scanline_fence(fence), before));
  for (const Scenario& scenario : scenarios) {
    Painted spans("surface.span_buffer", scenario);
    Painted depths("surface.zbuffer", scenario);
    std::uint64_t owned = 0;
    for (std::size_t i = 0; i < scenario.frame_count(); ++i) {
      EXPECT_EQ(spans.judge(i).surface_px, 0U);
      depths.judge(i);
      EXPECT_TRUE(std::ranges::equal(spans.image(), depths.image())) << "frame " << i;
      owned += static_cast<std::uint64_t>(
          std::ranges::count_if(spans.image(), [](TriangleId id) { return id != none_id; }));
    }
    EXPECT_EQ(spans.counter("pixels_written"), owned);  // every pixel once
    EXPECT_GT(depths.counter("pixels_written"), owned);
    EXPECT_GT(spans.counter("cut_spans"), spans.counter("spans"));
  }
}

TEST(SurfaceImages, OfSpansThatTouchAreUndecidedIfComparedAtTheirLeftEnds) {
  TouchingSpansParameters touching;
  touching.depth_difference_m = 0.0;
  const Scenario scenario(seen_from(make_touching_spans(touching), {{0.0, 0.013, 5.0}}));
  EXPECT_GT(Painted("surface.span_buffer[compare_at=left_end]", scenario).judge_all().surface_px,
            20U);
  EXPECT_EQ(Painted("surface.span_buffer", scenario).judge_all().surface_px, 0U);
}

/// Squares side by side, each behind another by a share `gap` of its depth, from 0.5 to 1 of
/// `distance_m` from a camera at the origin. The farther comes first, so that it wins a tie.
SmallScene far_pairs(double distance_m, double gap) {
  Scene scene;
  Mesh mesh;
  constexpr int pairs = 12;
  for (int i = 0; i < pairs; ++i) {
    const double share = 0.5 + 0.5 * i / pairs;
    for (const double depth : {distance_m * share * (1.0 + gap), distance_m * share}) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      const double x = depth * 0.08 * (i - 0.5 * pairs);
      const double side = depth * 0.06;
      for (const glm::dvec2 corner : {glm::dvec2(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
        mesh.positions.emplace_back(x + side * corner.x, side * (corner.y - 0.5), -depth);
      }
      mesh.triangles.emplace_back(first, first + 1, first + 2);
      mesh.triangles.emplace_back(first, first + 2, first + 3);
    }
  }
  scene.meshes = {mesh};
  scene.objects = {{0, glm::dmat4x3(1.0), none_id}};
  scene.finish();
  Path path;
  const Viewport viewport{128, 96};
  path.frames.push_back(
      {{Pose{}, perspective_lens(degrees(60.0), viewport.aspect(), 0.1, 1e5)}, {}});
  return {"far pairs", std::move(scene), std::move(path), viewport};
}

TEST(SurfaceImages, OfTheZBufferAreWrongAsSoonAsItsStepsAreTooCoarse) {
  const Scenario near_by(far_pairs(20.0, 2e-3));       // 200 times the near distance
  const Scenario far_away(far_pairs(10'000.0, 2e-4));  // 100,000 times
  const auto wrong = [](const std::string& spec, const Scenario& scenario) {
    return Painted("surface.zbuffer[" + spec + "]", scenario).judge_all().surface_px;
  };
  for (const std::string convention : {"standard", "reversed"}) {
    const std::string with = ",convention=" + convention;
    EXPECT_GT(wrong("bits=16" + with, near_by), 0U) << convention;
    EXPECT_EQ(wrong("bits=24" + with, near_by), 0U) << convention;
    EXPECT_GT(wrong("bits=24" + with, far_away), 0U) << convention;
    EXPECT_EQ(wrong("bits=32" + with, far_away), 0U) << convention;
  }
  EXPECT_EQ(wrong("bits=float,convention=standard", near_by), 0U);
  EXPECT_GT(wrong("bits=float,convention=standard", far_away), 0U);
  EXPECT_EQ(wrong("bits=float,convention=reversed", far_away), 0U);
}

TEST(SurfaceImages, OfWrongVariantsAreFoundOutByTheJudge) {
  CrossingQuadsParameters crossing;
  const Scenario scenario(seen_from(make_crossing_quads(crossing), before));
  for (const std::string error :
       {"own_polygon_lost", "clear_of_other_convention", "comparison_of_other_convention"}) {
    EXPECT_GT(Painted("surface.wrong[error=" + error + "]", scenario).judge_all().surface_px, 50U)
        << error;
  }
}

TEST(SurfaceImages, OfWholePolygonsPaintedByTheirMiddlesAreRightOfAPileAndWrongOfARing) {
  const auto wrong_px = [&](double tilt_deg) {
    CyclicBarsParameters bars;
    bars.tilt_deg = tilt_deg;
    const Scenario scenario(seen_from(make_cyclic_bars(bars), {{0.0, 0.0, 3.0}}));
    return Painted("surface.wrong[error=whole_polygons]", scenario).judge_all().surface_px;
  };
  EXPECT_EQ(wrong_px(0.0), 0U);
  EXPECT_GT(wrong_px(10.0), 50U);
}

TEST(SurfaceBsp, EmitsFromBackToFrontOrFromFrontToBack) {
  // Three triangles behind each other, each smaller than the one behind it.
  Scene scene;
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes = {mesh};
  for (const double z : {1.0, -1.0, 0.0}) {
    const double size = 1.0 - 0.5 * z;
    scene.objects.push_back(
        {0,
         {glm::dvec3(size, 0, 0), glm::dvec3(0, size, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, 0, z)},
         none_id});
  }
  scene.finish();
  const Camera camera = camera_at({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0});
  EXPECT_EQ(CullerRun("surface.bsp", scene).objects(camera), (std::vector<ObjectId>{1, 2, 0}));
  EXPECT_EQ(CullerRun("surface.bsp[order=front_to_back]", scene).objects(camera),
            (std::vector<ObjectId>{0, 2, 1}));
}

TEST(SurfaceBsp, RefusesScenesWhoseTreeIsTooLargeAndSaysHowLarge) {
  TiltedPolygonsParameters parameters;
  Scene scene = make_tilted_polygons(parameters);
  scene.finish();
  const std::string message =
      input_error([&] { CullerRun run("surface.bsp[max_fragments=210]", scene); });
  EXPECT_TRUE(says(message, "200 triangles"));
  EXPECT_TRUE(says(message, "210 fragments"));
}

TEST(SurfaceBsp, DeclaresApproximateWhatAnEpsilonOrFewBitsMakeOfIt) {
  Registry registry;
  register_all_cullers(registry);
  const auto guarantee = [&](const std::string& spec) {
    return registry.make(spec)->info().guarantee;
  };
  EXPECT_EQ(guarantee("surface.bsp"), Guarantee::image_exact);
  EXPECT_EQ(guarantee("surface.bsp[epsilon_m=0.001]"), Guarantee::approximate);
  EXPECT_EQ(guarantee("surface.zbuffer"), Guarantee::approximate);
  EXPECT_EQ(guarantee("surface.zbuffer[bits=16]"), Guarantee::approximate);
  EXPECT_EQ(guarantee("surface.zbuffer[bits=float]"), Guarantee::approximate);
  EXPECT_EQ(guarantee("surface.zbuffer[bits=float,convention=reversed]"), Guarantee::image_exact);
}

}  // namespace
}  // namespace vislab
