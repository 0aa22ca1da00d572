// Every mistake of depth.wrong on a scene made for it: the judge finds it there, and the right
// methods are right there.
#include <gtest/gtest.h>

#include <cmath>

#include "common/scene/generators/generators.h"
#include "common/scene/generators/occlusion.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/depth_damage.h"

namespace vislab {
namespace {

constexpr Viewport viewport{127, 95};

Camera looking(const glm::dvec3& eye, const glm::dvec3& target, double near_m = 0.3) {
  return {look_at(eye, target), perspective_lens(degrees(60.0), viewport.aspect(), near_m, 3000.0)};
}

Play finished(Scene scene, const std::vector<Camera>& cameras) {
  Play play;
  play.scene = std::move(scene);
  play.scene.finish();
  for (const Camera& camera : cameras) play.steps.push_back({camera, {}});
  return play;
}

Play city() {
  CityParameters parameters;
  parameters.blocks_x = parameters.blocks_z = 8;
  parameters.roof_share = 0.3;
  parameters.street_boxes = 600;
  return finished(make_city(parameters), {looking({0.0, 1.7, 0.0}, {60.0, 4.0, 7.0}),
                                          looking({-50.0, 1.7, 25.0}, {0.0, 3.0, -60.0}),
                                          looking({-50.0, 30.0, 25.0}, {0.0, 3.0, -60.0})});
}

Play boxes(double near_m) {
  BoxFieldParameters parameters;
  parameters.count = 1500;
  parameters.extent_m = 200.0;
  parameters.min_half_size_m = 3.0;
  parameters.max_half_size_m = 12.0;
  parameters.clear_radius_m = 30.0;
  return finished(make_box_field(parameters), {looking({0.0, 0.0, 0.0}, {1.0, 0.0, 0.2}, near_m),
                                               looking({0.0, 0.0, 0.0}, {-0.3, 0.2, 1.0}, near_m)});
}

Play slits(double gap_m) {
  SlitWallParameters parameters;
  parameters.gap_m = gap_m;
  parameters.ratio = 1.0;
  return finished(make_slit_wall(parameters), {looking({0.3, 1.7, 10.0}, {0.0, 4.0, 0.0}),
                                               looking({-5.0, 1.7, 9.0}, {0.0, 4.0, 0.0})});
}

Play wall() {
  MovingWallParameters parameters;
  parameters.targets = 300;
  const Camera camera = looking({0.0, 5.0, 12.0}, {0.0, 4.5, 0.0});
  return finished(make_moving_wall(parameters), {camera, camera, camera});
}

void expect_right(const Play& play) {
  for (const char* culler : {"depth.horizon", "depth.masked", "depth.hzb"}) {
    EXPECT_EQ(damage(culler, play, viewport, true).image_px, 0U) << culler;
  }
}

void expect_losses(const std::string& error, const Play& play) {
  expect_right(play);
  EXPECT_GT(damage("depth.wrong[error=" + error + "]", play, viewport).false_px, 0U) << error;
}

/// Loses nothing, but keeps more objects than the same test without the mistake.
void expect_waste(const std::string& error, const std::string& right, const Play& play) {
  const Damage wrong = damage("depth.wrong[error=" + error + "]", play, viewport);
  EXPECT_EQ(wrong.false_px, 0U) << error;
  EXPECT_GT(wrong.kept, damage(right, play, viewport).kept * 5 / 4) << error;
}

TEST(DepthWrong, HorizonsOfBoundingRectanglesHideWhatIsSeenPastCorners) {
  expect_losses("bounding_rectangle", city());
}

TEST(DepthWrong, HorizonsInARoughOrderHideWhatIsNear) {
  expect_losses("unsorted,noise=0.8", city());
  EXPECT_EQ(damage("depth.wrong[error=unsorted,noise=0]", city(), viewport).false_px, 0U);
}

TEST(DepthWrong, PyramidsThatAreRoundedDownForgetColumns) {
  CityParameters parameters;
  parameters.blocks_x = parameters.blocks_z = 12;
  parameters.roof_share = 0.3;
  parameters.street_boxes = 1500;
  parameters.seed = 3;
  constexpr Viewport odd{639, 512};
  Play play = finished(make_city(parameters), {});
  for (const glm::dvec3& eye : {glm::dvec3(0.0, 1.7, 0.0),
                                {-50.0, 1.7, 25.0},
                                {75.0, 1.7, -25.0},
                                {25.0, 1.7, 100.0},
                                {-100.0, 1.7, 75.0},
                                {-75.0, 40.0, 150.0}}) {
    for (const glm::dvec3& way :
         {glm::dvec3(60.0, 3.0, 8.0), {50.0, 3.0, -85.0}, {-65.0, 3.0, 55.0}}) {
      const Camera camera{look_at(eye, eye + way),
                          perspective_lens(degrees(60.0), odd.aspect(), 0.3, 3000.0)};
      play.steps.push_back({camera, {}});
    }
  }
  EXPECT_GT(damage("depth.wrong[error=npot_floor]", play, odd).false_px, 0U);
  EXPECT_EQ(damage("depth.hzb", play, odd).false_px, 0U);
}

TEST(DepthWrong, PyramidsUpdatedBackwardsFindNextToNothingHidden) {
  expect_waste("update_backwards", "depth.wrong[error=loose_bounds,growth=1]", city());
}

TEST(DepthWrong, PyramidsThatKeepTheNearestHideTooMuch) {
  expect_losses("wrong_reduction", city());
}

TEST(DepthWrong, FewBitsHideWhatIsALittleNearer) {
  expect_losses("quantised", boxes(0.001));
  EXPECT_EQ(damage("depth.wrong[error=quantised]", boxes(10.0), viewport).false_px, 0U);
}

TEST(DepthWrong, CornersBehindTheEyeAreNotWhereTheyAreProjected) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {{0, placed({0.0, -1.0, 0.0}, {4.0, 0.2, 60.0}), none_id},
                   {0, placed({0.0, 0.0, -3.0}, {3.0, 2.0, 0.1}), none_id}};
  expect_losses("near_plane_projected",
                finished(std::move(scene), {looking({0.0, 0.5, 1.0}, {0.0, 0.0, -10.0})}));
}

TEST(DepthWrong, PointsNearestToTheEyeAreNotThoseOfLeastDepth) {
  BoxFieldParameters parameters;
  parameters.count = 400;
  parameters.extent_m = 25.0;
  parameters.min_half_size_m = 0.8;
  parameters.max_half_size_m = 1.6;
  parameters.clear_radius_m = 2.0;
  parameters.elongation = 2.5;
  parameters.seed = 5;
  Play play = finished(make_box_field(parameters), {});
  for (int i = 0; i < 12; ++i) {
    const glm::dvec3 way(std::sin(degrees(30.0 * i)), 0.0, std::cos(degrees(30.0 * i)));
    const Lens wide = perspective_lens(degrees(98.0), viewport.aspect(), 0.1, 200.0);
    play.steps.push_back({{look_at(glm::dvec3(0.0), way), wide}, {}});
  }
  expect_losses("euclidean_nearest", play);
}

TEST(DepthWrong, TheInverseOfWTellsNothingInParallelViews) {
  Play parallel = city();
  // From above, so that the ground lies below all that stands on it.
  Camera above = looking({-45.0, 70.0, 40.0}, {-40.0, 0.0, -10.0});
  above.lens = orthographic_lens(80.0, viewport.aspect(), 0.3, 400.0);
  parallel.steps = {{above, {}}};
  expect_losses("depth_by_w", parallel);
  EXPECT_EQ(damage("depth.wrong[error=depth_by_w]", city(), viewport).false_px, 0U);
}

TEST(DepthWrong, LooseBoundsFindLessHidden) {
  expect_waste("loose_bounds,growth=2", "depth.wrong[error=loose_bounds,growth=1]", city());
}

TEST(DepthWrong, CentresOfLargePixelsMissSlits) {
  expect_losses("centres_at_reduced_size", slits(0.2));
}

TEST(DepthWrong, PixelsThatAreOnlyTouchedCloseSlits) {
  expect_losses("rounded_outward", slits(0.12));
}

TEST(DepthWrong, OccludersThatStandOutCloseSlits) {
  expect_losses("grown_occluders,growth=0.3", slits(0.5));
}

TEST(DepthWrong, HolesAreNotOpaque) {
  expect_losses("boxes_as_occluders",
                finished(make_lattice_wall({}), {looking({0.3, 6.0, 12.0}, {0.0, 6.0, 0.0})}));
}

TEST(DepthWrong, LastFramesDepthsHideWhatComesIntoView) {
  Play play = wall();
  play.steps[1].changes.moved = {0};
  play.steps[1].changes.transforms = {placed({8.0, 6.0, 0.0}, {10.0, 6.0, 0.15})};
  expect_losses("one_phase", play);
  EXPECT_EQ(damage("depth.wrong[error=one_phase]", wall(), viewport).false_px, 0U);
}

TEST(DepthWrong, OccludersThatAreGoneHideNothing) {
  Play play = wall();
  play.steps[2].changes.hidden = {0};
  expect_losses("stale_occluders", play);
  EXPECT_EQ(damage("depth.wrong[error=stale_occluders]", wall(), viewport).false_px, 0U);
}

}  // namespace
}  // namespace vislab
