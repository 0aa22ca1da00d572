// Cullers of back faces on meshes from packages, which ./lab test fetches, judged by rays, by
// images and by exact predicates.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "common/judge/image_judge.h"
#include "common/judge/metrics.h"
#include "common/scene/generators/generators.h"
#include "common/scene/library.h"
#include "tests/algorithms/run_culler.h"
#include "tests/geometry/exact_facing.h"
#include "tests/scene/repository_data.h"

namespace vislab {
namespace {

constexpr Viewport viewport{256, 256};
constexpr TruthSettings settings{.jitter_per_pixel = 4, .seed = 1, .threads = 2};

struct Sum {
  std::uint64_t kept = 0;
  std::uint64_t offered = 0;
  std::uint64_t lost = 0;  // undisputed samples of C and J

  double culled_share() const {
    return 1.0 - static_cast<double>(kept) / static_cast<double>(offered);
  }
};

VisibleSet set_of(const Scene& scene, const std::vector<TriangleRange>& ranges) {
  std::vector<VisibleSet::Run> runs;
  for (const TriangleRange& range : ranges) {
    runs.push_back({scene.first_triangle(range.object) + range.first, range.count});
  }
  return VisibleSet(std::move(runs));
}

/// Judges a culler on `frames` frames of the scene's default path.
Sum judged(const std::string& culler, const LoadedScene& loaded, int frames) {
  const Scene& scene = loaded.scene;
  const Path path =
      load_path(loaded.default_path, scene, viewport, frames, test::repository_data());
  RayCaster caster(scene, settings);
  CullerRun run(culler, scene);
  Sum sum;
  for (const PathFrame& now : path.frames) {
    run.update(now.camera, now.changes);
    const Frame frame = run.frame(now.camera, viewport);
    const FrameTruth truth = caster.trace(frame);
    const VisibleSet kept = set_of(scene, run.emitted(now.camera));
    const Verdict verdict = judge_set(frame, truth, kept, Granularity::triangle, caster);
    sum.kept += verdict.submitted_triangles;
    sum.offered += verdict.scene_triangles;
    sum.lost += verdict.false_px + verdict.false_jittered;
  }
  return sum;
}

class BackfaceOnRealMeshes : public testing::TestWithParam<const char*> {
 protected:
  const LoadedScene loaded_ = load_scene(GetParam(), test::repository_data());
};

std::string name_of(const testing::TestParamInfo<const char*>& scene) { return scene.param; }

class BackfaceOnSolids : public BackfaceOnRealMeshes {};

TEST_P(BackfaceOnSolids, LosesNothingAndLeavesOutAThirdOfTheTriangles) {
  const Sum sum = judged("backface.polygon", loaded_, 8);
  EXPECT_EQ(sum.lost, 0U);
  EXPECT_GT(sum.culled_share(), 0.3);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BackfaceOnSolids,
                         testing::Values("bunny", "hare", "elephant", "hares_14"), name_of);

class BackfaceOnMeshesThatCrossThemselves : public BackfaceOnRealMeshes {};

TEST_P(BackfaceOnMeshesThatCrossThemselves, KeepsThemWholeAndLosesNothing) {
  const Sum sum = judged("backface.polygon", loaded_, 8);
  EXPECT_EQ(sum.lost, 0U);
  EXPECT_EQ(sum.kept, sum.offered);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BackfaceOnMeshesThatCrossThemselves, testing::Values("cow", "man"),
                         name_of);

/// Holds every conservative culler to exact predicates, rays and images on a path. Those that need
/// a device leave out nothing themselves; their contract is checked on the image.
void expect_all_right(const Scene& scene, const Path& path) {
  RayCaster caster(scene, settings);
  ImageJudge images(scene);
  Registry registry;
  register_all_cullers(registry);
  struct Judged {
    std::string name;
    CullerRun run;
    test::FacingCounts facings;
    std::uint64_t lost = 0;
    ImageVerdict image;
  };
  std::vector<std::unique_ptr<Judged>> cullers;
  for (const auto& [name, entry] : registry.entries()) {
    const CullerInfo& info = entry.info;
    if (info.culls != Culls::back_faces || info.guarantee != Guarantee::conservative ||
        info.needs_device) {
      continue;
    }
    cullers.emplace_back(new Judged{name, CullerRun(name, scene), {}, 0, {}});
  }
  EXPECT_GE(cullers.size(), 2U);
  for (const PathFrame& now : path.frames) {
    const Frame frame = cullers.front()->run.frame(now.camera, viewport);
    const FrameTruth truth = caster.trace(frame);
    images.start(frame, truth);
    const std::vector<test::Facing> facings = test::exact_facings(scene, frame);
    for (const std::unique_ptr<Judged>& culler : cullers) {
      culler->run.update(now.camera, now.changes);
      const std::vector<TriangleRange> ranges = culler->run.emitted(now.camera);
      const VisibleSet kept = set_of(scene, ranges);
      culler->facings += test::count_facings(scene, frame, facings, ranges);
      const Verdict verdict = judge_set(frame, truth, kept, Granularity::triangle, caster);
      culler->lost += verdict.false_px + verdict.false_jittered;
      const ImageVerdict image = images.judge(frame, kept);
      culler->image.image_px += image.image_px;
      culler->image.disputed_image_px += image.disputed_image_px;
    }
  }
  for (const std::unique_ptr<Judged>& culler : cullers) {
    std::cout << culler->name << ": " << culler->facings.recall() << " of " << culler->facings.back
              << " back faces left out, " << culler->image.disputed_image_px
              << " disputed pixels differ\n";
    EXPECT_TRUE(culler->facings.all_right())
        << culler->name << ": " << culler->facings.front_left_out << " front faces and "
        << culler->facings.edge_on_left_out << " edge-on ones left out";
    EXPECT_GT(culler->facings.recall(), 0.01) << culler->name;
    EXPECT_EQ(culler->lost, 0U) << culler->name;
    EXPECT_EQ(culler->image.image_px, 0U) << culler->name;
  }
}

class EveryBackfaceCuller : public BackfaceOnRealMeshes {};

TEST_P(EveryBackfaceCuller, LosesNoSampleAndNoFrontFaceAndChangesDisputedPixelsOnly) {
  expect_all_right(loaded_.scene, load_path(loaded_.default_path, loaded_.scene, viewport, 3,
                                            test::repository_data()));
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryBackfaceCuller,
                         testing::Values("bunny", "elephant", "hares_14", "bumpy_high", "apartment",
                                         "mirrored_shapes"),
                         name_of);

TEST(EveryBackfaceCullerOnAPath, LosesNothingWhereTheEyeGoesThroughASolid) {
  BumpySphereParameters parameters;
  parameters.subdivisions = 12;
  parameters.bumps = Bumps::low;
  Scene scene = make_bumpy_sphere(parameters);
  scene.finish();
  const Path path = load_path("through", scene, viewport, 9, test::repository_data());
  const auto inside = std::ranges::count_if(path.frames, [](const PathFrame& frame) {
    return glm::length(frame.camera.pose.eye) < 0.9;  // the sphere's radius is at least .93
  });
  EXPECT_GE(inside, 3);
  EXPECT_LT(inside, 9);
  expect_all_right(scene, path);
}

TEST(BackfaceOnTheCow, LosesWhatItShowsOfItsBackIfToldTo) {
  const Sum sum =
      judged("backface.polygon[open=cull]", load_scene("cow", test::repository_data()), 12);
  EXPECT_GT(sum.lost, 0U);
  EXPECT_GT(sum.culled_share(), 0.3);
}

}  // namespace
}  // namespace vislab
