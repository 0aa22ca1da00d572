#include "experiments/show/kinds_picture.h"

#include <gtest/gtest.h>

#include <numeric>

#include "algorithms/all_cullers.h"
#include "common/scene/library.h"
#include "experiments/run/path_run.h"
#include "tests/scene/repository_data.h"

namespace vislab {
namespace {

constexpr Viewport viewport{96, 96};

/// The kinds in some frames of a scene's own path, with their truth.
class KindsOfFrames : public ::testing::TestWithParam<const char*> {
 protected:
  KindsOfFrames() : loaded_(load_scene(GetParam(), test::repository_data())) {
    register_all_cullers(registry_);
    const Path path =
        load_path(loaded_.default_path, loaded_.scene, viewport, 6, test::repository_data());
    SceneState state(loaded_.scene);
    RayCaster caster(loaded_.scene, TruthSettings{4, 1, 1});
    KindFinder finder(loaded_.scene, registry_);
    for_each_frame(path, state, viewport,
                   [&](std::size_t, const Frame& frame, const Changes& changes) {
                     finder.update(frame, changes);
                     truths_.push_back(caster.trace(frame));
                     found_.push_back(finder.find(frame, truths_.back()));
                   });
  }

  std::uint64_t count(CullingKind kind) const {
    std::uint64_t sum = 0;
    for (const FrameKinds& frame : found_) sum += frame.counts[static_cast<std::size_t>(kind)];
    return sum;
  }

  Registry registry_;
  LoadedScene loaded_;
  std::vector<FrameTruth> truths_;
  std::vector<FrameKinds> found_;
};

TEST_P(KindsOfFrames, OnlyWhatTruthSeesIsDrawnOrADetail) {
  for (std::size_t i = 0; i < found_.size(); ++i) {
    std::uint64_t seen = 0;
    for (const CullingKind kind : found_[i].kinds) {
      if (kind == CullingKind::drawn || kind == CullingKind::detail) ++seen;
    }
    EXPECT_EQ(seen, truths_[i].visible().size());
    for (const TriangleId id : truths_[i].visible()) {
      EXPECT_TRUE(found_[i].kinds[id] == CullingKind::drawn ||
                  found_[i].kinds[id] == CullingKind::detail);
    }
  }
}

TEST_P(KindsOfFrames, EveryTriangleIsCountedOnce) {
  for (const FrameKinds& frame : found_) {
    EXPECT_EQ(std::accumulate(frame.counts.begin(), frame.counts.end(), std::uint64_t{0}),
              loaded_.scene.triangle_count());
  }
}

TEST_P(KindsOfFrames, PortalsLeaveOutNothingWhereThereAreNoCells) {
  EXPECT_EQ(count(CullingKind::portal) > 0, !loaded_.scene.cells.empty());
  EXPECT_GT(count(CullingKind::view_frustum), 0U);
}

INSTANTIATE_TEST_SUITE_P(Scenes, KindsOfFrames, ::testing::Values("room_line", "city_tiny"));

}  // namespace
}  // namespace vislab
