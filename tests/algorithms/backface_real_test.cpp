// backface.polygon on meshes from packages, which ./lab test fetches, judged by rays.
#include <gtest/gtest.h>

#include "common/judge/metrics.h"
#include "common/scene/library.h"
#include "tests/algorithms/run_culler.h"

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

const DataFolders& folders() {
  static const DataFolders data{VISLAB_SOURCE_DIR "/data", VISLAB_SOURCE_DIR "/data/cache"};
  return data;
}

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
  const Path path = load_path(loaded.default_path, scene, viewport, frames, folders());
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
  const LoadedScene loaded_ = load_scene(GetParam(), folders());
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

TEST(BackfaceOnTheCow, LosesWhatItShowsOfItsBackIfToldTo) {
  const Sum sum = judged("backface.polygon[open=cull]", load_scene("cow", folders()), 12);
  EXPECT_GT(sum.lost, 0U);
  EXPECT_GT(sum.culled_share(), 0.3);
}

}  // namespace
}  // namespace vislab
