// Every mistake of occlusion.wrong on a scene made for it: it is found there, and the right methods
// are right there.
#include <gtest/gtest.h>

#include "common/geometry/random.h"
#include "common/render/osmesa_device.h"
#include "common/scene/generators/generators.h"
#include "common/scene/generators/occlusion.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/query_play.h"

namespace vislab {
namespace {

constexpr Viewport viewport{128, 96};

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

Play streets() {
  CityParameters parameters;
  parameters.blocks_x = parameters.blocks_z = 6;
  parameters.street_boxes = 40;
  return finished(make_city(parameters), {looking({0.0, 1.7, 45.0}, {0.0, 1.7, 0.0}),
                                          looking({0.0, 1.7, 40.0}, {0.0, 1.7, 0.0}),
                                          looking({0.0, 1.7, 0.0}, {20.0, 4.0, 0.0})});
}

std::string wrong(const std::string& error) { return "occlusion.wrong[error=" + error + "]"; }

void expect_losses(const std::string& error, Play play) {
  QueryPlay stage(std::move(play), viewport);
  OsMesaDevice device;
  EXPECT_EQ(stage.image_px("occlusion.stop_and_wait", device), 0U) << error;
  EXPECT_EQ(stage.image_px("occlusion.batched[batch=1]", device), 0U) << error;
  EXPECT_GT(stage.image_px(wrong(error), device), 0U) << error;
}

TEST(OcclusionWrong, BoxesAroundTheEyeHaveNoSamples) {
  Scene scene;
  scene.meshes = {cube_mesh(), sphere_mesh(8)};
  scene.objects = {{0, placed({0.0, 0.0, 0.0}, glm::dvec3(20.0)), none_id},
                   {1, placed({0.0, 0.0, -6.0}), none_id}};
  expect_losses("near_box_asked",
                finished(std::move(scene), {looking({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0})}));
}

TEST(OcclusionWrong, BoxesThatAreNotEnlargedMissPixelsAtTheBordersOfWhatIsInThem) {
  // Posters about as large as a pixel before a wall whose box is nearer than theirs. Each edge of
  // theirs has vertices of its own, which are rounded apart from the box's corners.
  Scene scene;
  scene.meshes = {cube_mesh(), box_mesh({1.0, 1.0, 1.0}, 5, 1.0)};
  scene.objects = {{0, placed({0.0, 0.0, -41.0}, {100.0, 60.0, 1.0}), none_id}};
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const double side = random.uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
    scene.objects.push_back(
        {1,
         placed({side * random.uniform(10.0, 28.0), random.uniform(-20.0, 20.0), -39.5},
                {random.uniform(0.1, 0.25), random.uniform(0.1, 0.25), 0.1}),
         none_id});
  }
  Camera rolled = looking({0.0, 0.0, 0.0}, {0.1, 0.05, -1.0});
  rolled.pose.right = 0.8 * rolled.pose.right + 0.6 * rolled.pose.up;
  rolled.pose.up = glm::cross(rolled.pose.back, rolled.pose.right);
  QueryPlay stage(finished(std::move(scene), {rolled}), viewport);
  OsMesaDevice device;
  const QueryFrame right = stage.run("occlusion.batched", device).front();
  const QueryFrame bare = stage.run(wrong("unenlarged_boxes"), device).front();
  EXPECT_EQ(right.image_px + right.disputed_image_px, 0U);
  EXPECT_EQ(bare.image_px, 0U) << "so near to an edge rays and devices disagree as well";
  EXPECT_GT(bare.disputed_image_px, 0U);
}

TEST(OcclusionWrong, AtLeastAsManyAsNoneCullsNothing) {
  QueryPlay stage(streets(), viewport);
  OsMesaDevice device;
  const std::vector<QueryFrame> frames = stage.run(wrong("at_least_threshold"), device);
  const std::vector<QueryFrame> right = stage.run("occlusion.stop_and_wait", device);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].image_px, 0U);
    EXPECT_GT(frames[i].kept.size(), 2 * right[i].kept.size());
  }
}

TEST(OcclusionWrong, AnswersOfTheLastFrameAreAboutOthers) {
  QueryPlay stage(streets(), viewport);
  OsMesaDevice device;
  const std::vector<QueryFrame> frames = stage.run(wrong("stale_answers"), device);
  EXPECT_EQ(frames[0].image_px, 0U) << "no answers yet";
  EXPECT_GT(frames[2].image_px, 0U) << "a cut";
  EXPECT_EQ(stage.image_px("occlusion.batched", device), 0U);
}

TEST(OcclusionWrong, NewObjectsDoNotInheritThatOthersWereHidden) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {{0, placed({0.0, 0.0, -5.0}, {6.0, 6.0, 0.2}), none_id},
                   {0, placed({0.0, 0.0, -9.0}), none_id},
                   {0, placed({0.0, 0.0, -2.0}, glm::dvec3(0.3)), none_id}};
  const Camera camera = looking({0.0, 0.0, 2.0}, {0.0, 0.0, 0.0});
  Play play = finished(std::move(scene), std::vector<Camera>(4, camera));
  play.steps[0].changes.hidden = {2};
  // 1, which is hidden behind the wall, goes, and 2 comes before it.
  play.steps[2].changes.hidden = {1};
  play.steps[2].changes.shown = {2};
  QueryPlay stage(std::move(play), viewport);
  OsMesaDevice device;
  const std::vector<QueryFrame> frames = stage.run(wrong("recycled_handles"), device);
  EXPECT_EQ(frames[1].kept, std::vector<ObjectId>{0});
  EXPECT_GT(frames[2].image_px, 0U);
  EXPECT_EQ(frames[3].image_px, 0U);
  EXPECT_EQ(stage.image_px("occlusion.last_frame", device), 0U) << "answers by object";
}

TEST(OcclusionWrong, TheListingThatTakesNothingOffItsListEndsAtItsLimit) {
  const Play play = streets();
  QueryPlay stage(streets(), viewport);
  OsMesaDevice device;
  for (const QueryFrame& frame : stage.run(wrong("never_pops"), device)) {
    EXPECT_EQ(frame.kept.size(), 1U);
    EXPECT_GT(frame.image_px, 0U);
  }
}

}  // namespace
}  // namespace vislab
