#include "common/judge/image_judge.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/judge/judge_scenes.h"

namespace vislab {
namespace {

Camera inside_camera(double near_m) {
  return camera_at({0.1, 0.2, 0.3}, {2.0, 0.4, 1.0}, near_m, 50.0);
}

TEST(ErrorFloor, of_random_scenes_holds_disputed_pixels_only) {
  std::uint64_t disputed = 0;
  std::uint64_t pixels = 0;
  int number = 0;
  Camera orthographic = camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0});
  orthographic.lens = orthographic_lens(6.0, 1.0, 1.0, 15.0);
  Camera infinite = camera_at({0.0, 1.0, 8.0}, {0.0, 0.0, 0.0});
  infinite.lens.far_m = std::numeric_limits<double>::infinity();
  for (const Camera& camera : {camera_at({0.0, 1.0, 8.0}, {0.0, 0.0, 0.0}), inside_camera(0.1),
                               inside_camera(0.5), orthographic, infinite}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      Stage stage(random_triangles(60, 3.0, 1.0, seed), camera, {161, 163});
      RayCaster caster(stage.scene, {.jitter_per_pixel = 1, .seed = 1, .threads = 2});
      const FrameTruth truth = caster.trace(stage.frame);
      ImageJudge judge(stage.scene);
      judge.start(stage.frame, truth);
      const ImageJudge::Floor floor = judge.error_floor(stage.frame);
      EXPECT_EQ(floor.undisputed_px, 0U) << "camera " << number << ", seed " << seed;
      disputed += floor.disputed_px;
      pixels += truth.ids.size();
    }
    ++number;
  }
  EXPECT_LT(disputed, pixels / 100);
  RecordProperty("disputed_px", std::to_string(disputed));
  RecordProperty("pixels", std::to_string(pixels));
}

TEST(ErrorFloor, is_the_depth_buffers_where_it_has_coarse_steps) {
  // Both are nearer to each other than a step at 4,000 near distances; the farther is drawn first.
  Scene scene;
  add_triangle(scene, {-300.0F, -300.0F, -400.07F}, {300.0F, -300.0F, -400.07F},
               {0.0F, 300.0F, -400.07F});
  add_triangle(scene, {-200.0F, -250.0F, -400.0F}, {200.0F, -250.0F, -400.0F},
               {0.0F, 200.0F, -400.0F});
  Stage stage(std::move(scene), camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, 0.1, 1000.0),
              {64, 64});
  RayCaster caster(stage.scene, {.jitter_per_pixel = 1, .seed = 1, .threads = 2});
  const FrameTruth truth = caster.trace(stage.frame);
  ImageJudge judge(stage.scene);
  judge.start(stage.frame, truth);
  const std::span<const TriangleId> owners = judge.full_image().owners;
  ASSERT_EQ(owners.size(), truth.ids.size());
  std::uint64_t farther = 0;
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    if (truth.ids[i] == 1 && owners[i] == 0) ++farther;
  }
  EXPECT_GT(farther, 100U) << "the device cannot tell them apart";
  EXPECT_EQ(judge.error_floor(stage.frame).undisputed_px, 0U);
  // Whoever leaves out the nearer one leaves the device's image as it is.
  const VisibleSet kept = all_but(stage, {1});
  const auto false_px = [&](Guarantee guarantee) {
    return judge_set(stage.frame, truth, kept, Granularity::triangle, caster,
                     shown_image(guarantee, {}, &judge))
        .false_px;
  };
  EXPECT_GT(false_px(Guarantee::conservative), farther / 2);
  EXPECT_EQ(false_px(Guarantee::image_exact), false_px(Guarantee::conservative) - farther);
}

TEST(ErrorFloor, of_another_frames_truth_is_not_excused) {
  Stage stage(cubes_at({{0.0, 0.0, 0.0}}), camera_at({0.0, 0.0, 6.0}, {0.0, 0.0, 0.0}), {64, 64});
  RayCaster caster(stage.scene, {.jitter_per_pixel = 1, .seed = 1, .threads = 2});
  const FrameTruth truth = caster.trace(stage.frame);
  ImageJudge judge(stage.scene);
  stage.frame.camera = camera_at({0.5, 0.0, 6.0}, {0.5, 0.0, 0.0});
  judge.start(stage.frame, truth);
  EXPECT_GT(judge.error_floor(stage.frame).undisputed_px, 50U);
}

TEST(ImageJudge, sees_no_difference_if_only_hidden_things_are_left_out) {
  Stage stage(cubes_at({{0.0, 0.0, 0.0}, {0.0, 0.0, -4.0}, {0.0, 0.0, 20.0}}),
              camera_at({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0}), {65, 63});
  RayCaster caster(stage.scene, {.jitter_per_pixel = 1, .seed = 1, .threads = 2});
  const FrameTruth truth = caster.trace(stage.frame);
  ImageJudge judge(stage.scene);
  judge.start(stage.frame, truth);
  EXPECT_EQ(judge.judge(stage.frame, all_but(stage, {})), ImageVerdict{});
  const VisibleSet first = objects_where(stage, [](ObjectId object) { return object == 0; });
  EXPECT_EQ(judge.judge(stage.frame, first), ImageVerdict{});
}

TEST(ImageJudge, counts_the_pixels_of_what_is_missing) {
  Stage stage(cubes_at({{0.0, 0.0, 0.0}, {3.0, 0.5, -6.0}}),
              camera_at({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0}), {65, 63});
  RayCaster caster(stage.scene, {.jitter_per_pixel = 1, .seed = 1, .threads = 2});
  const FrameTruth truth = caster.trace(stage.frame);
  ImageJudge judge(stage.scene);
  judge.start(stage.frame, truth);
  const VisibleSet second = objects_where(stage, [](ObjectId object) { return object == 1; });
  const ImageVerdict verdict = judge.judge(stage.frame, second);
  const Verdict by_rays = judge_set(stage.frame, truth, second, Granularity::object, caster);
  EXPECT_GT(verdict.image_px, 100U);
  EXPECT_EQ(verdict.image_px + verdict.disputed_image_px,
            by_rays.false_px + by_rays.disputed_lost_px);
  EXPECT_NEAR(static_cast<double>(verdict.image_px), static_cast<double>(by_rays.false_px), 2.0);
  const ImageVerdict nothing = judge.judge(stage.frame, VisibleSet());
  EXPECT_GT(nothing.image_px, verdict.image_px);
}

TEST(ImageJudge, follows_moved_and_hidden_objects_and_another_size) {
  Stage stage(cubes_at({{-2.0, 0.0, 0.0}, {2.0, 0.0, 0.0}}),
              camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0}), {64, 64});
  RayCaster caster(stage.scene, {.jitter_per_pixel = 1, .seed = 1, .threads = 2});
  ImageJudge judge(stage.scene);
  const FrameTruth before = caster.trace(stage.frame);
  judge.start(stage.frame, before);
  EXPECT_EQ(judge.error_floor(stage.frame).undisputed_px, 0U);
  stage.apply(changes({0}, {box_transform({0.0, 1.0, 2.0}, glm::dvec3(0.6))}, {}, {1}));
  stage.frame.viewport = {45, 57};
  const FrameTruth truth = caster.trace(stage.frame);
  judge.start(stage.frame, truth);
  EXPECT_EQ(judge.error_floor(stage.frame).undisputed_px, 0U);
  ASSERT_FALSE(truth.visible().empty());
  EXPECT_LT(truth.visible().back(), 12U) << "only the first cube is shown";
}

}  // namespace
}  // namespace vislab
