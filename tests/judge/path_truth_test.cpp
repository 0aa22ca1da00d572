#include "common/judge/path_truth.h"

#include <gtest/gtest.h>

#include "tests/judge/judge_scenes.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

Path two_frames() {
  Path path;
  path.frames.push_back({camera_at({0.0, 1.0, 9.0}, {0.0, 0.0, 0.0}), {}});
  path.frames.push_back({camera_at({1.0, 1.0, 9.0}, {0.0, 0.0, 0.0}), changes({}, {}, {}, {0})});
  return path;
}

TEST(PathTruth, gives_oracles_the_visible_objects_and_merged_ranges_of_triangles) {
  Scene scene = cubes_at({{0.0, 0.0, 0.0}, {0.0, 0.0, -5.0}, {3.0, 0.0, 0.0}});
  scene.finish();
  const TruthSettings settings;
  RayCaster caster(scene, settings);
  std::vector<std::size_t> progress;
  const PathTruth truth = trace_path(two_frames(), {64, 64}, settings, caster, nullptr,
                                     [&](std::size_t done) { progress.push_back(done); });
  ASSERT_EQ(truth.frame_count(), 2U);
  EXPECT_EQ(progress, (std::vector<std::size_t>{1, 2}));
  for (std::uint64_t frame = 0; frame < 2; ++frame) {
    std::vector<TriangleId> from_ranges;
    std::vector<ObjectId> objects;
    TriangleRange last{none_id, 0, 0};
    for (const TriangleRange& range : truth.visible_triangles(frame)) {
      EXPECT_FALSE(range.object == last.object && range.first == last.first + last.count);
      if (objects.empty() || objects.back() != range.object) objects.push_back(range.object);
      for (std::uint32_t i = 0; i < range.count; ++i) {
        from_ranges.push_back(scene.first_triangle(range.object) + range.first + i);
      }
      last = range;
    }
    EXPECT_EQ(from_ranges, truth.frame(frame).visible());
    const auto visible = truth.visible_objects(frame);
    EXPECT_EQ(objects, std::vector<ObjectId>(visible.begin(), visible.end()));
  }
  EXPECT_EQ(truth.visible_objects(0)[0], 0U);
  EXPECT_EQ(truth.visible_objects(1)[0], 1U) << "what hid it is hidden now";
}

TEST(PathTruth, comes_from_the_store_the_second_time) {
  Scene scene = cubes_at({{0.0, 0.0, 0.0}, {0.0, 0.0, -5.0}, {3.0, 0.0, 0.0}});
  scene.finish();
  const TemporaryFolder temporary;
  const std::filesystem::path& folder = temporary.path();
  const TruthSettings settings;
  const TruthStore store(folder);
  RayCaster caster(scene, settings);
  const PathTruth traced = trace_path(two_frames(), {64, 64}, settings, caster, &store);
  const PathTruth loaded = trace_path(two_frames(), {64, 64}, settings, caster, &store);
  for (std::uint64_t frame = 0; frame < 2; ++frame) {
    EXPECT_EQ(traced.frame(frame), loaded.frame(frame));
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder),
                          std::filesystem::directory_iterator()),
            2);
  // A mark in a stored frame proves that it is read.
  Frame frame;
  SceneState state(scene);
  frame.viewport = {64, 64};
  frame.camera = two_frames().frames[0].camera;
  frame.objects = state.view();
  FrameTruth marked = traced.frame(0);
  marked.ids[0] = 5;
  store.save(truth_key(frame, scene, settings), marked);
  const PathTruth third = trace_path(two_frames(), {64, 64}, settings, caster, &store);
  EXPECT_EQ(third.frame(0).ids[0], 5U);
}

}  // namespace
}  // namespace vislab
