#include <gtest/gtest.h>

#include "common/judge/path_truth.h"
#include "common/scene/error.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

/// Truth that is written down.
class WrittenTruth : public TruthSource {
 public:
  std::span<const ObjectId> visible_objects(std::uint64_t) const override { return objects; }
  std::span<const TriangleRange> visible_triangles(std::uint64_t) const override {
    return triangles;
  }

  std::vector<ObjectId> objects = {1, 3};
  std::vector<TriangleRange> triangles = {{1, 0, 2}, {1, 4, 3}, {3, 11, 1}};
};

class Oracle : public testing::Test {
 protected:
  Oracle() {
    scene_.meshes = {cube_mesh()};
    for (int i = 0; i < 5; ++i) {
      scene_.objects.push_back({0, placed({3.0 * i, 0.0, 0.0}), none_id});
    }
    scene_.finish();
    context_.truth = &truth_;
  }

  Scene scene_;
  WrittenTruth truth_;
  BuildContext context_;
  Camera camera_ = camera_at({0.0, 0.0, 20.0}, {0.0, 0.0, 0.0});
};

TEST_F(Oracle, KeepsWhatTruthSays) {
  CullerRun objects("oracle", scene_, context_);
  EXPECT_EQ(objects.objects(camera_), truth_.objects);
  CullerRun triangles("oracle[level=triangle]", scene_, context_);
  EXPECT_EQ(triangles.emitted(camera_), truth_.triangles);
  EXPECT_EQ(triangles.culler().info().granularity, Granularity::triangle);
}

TEST_F(Oracle, KeepsTheOrderOfItsCandidates) {
  const std::vector<ObjectId> offered = {4, 3, 2, 1};
  const std::span<const ObjectId> span(offered);
  CullerRun run("oracle", scene_, context_);
  EXPECT_EQ(
      run.objects(camera_, Candidates::of(std::span<const std::span<const ObjectId>>(&span, 1))),
      (std::vector<ObjectId>{3, 1}));
}

TEST_F(Oracle, CutsOfferedRangesToTheVisibleTriangles) {
  const std::vector<TriangleRange> offered = {{3, 0, 12}, {1, 5, 7}, {1, 1, 1}, {0, 0, 12}};
  const std::span<const TriangleRange> span(offered);
  CullerRun run("oracle[level=triangle]", scene_, context_);
  EXPECT_EQ(run.emitted(camera_,
                        Candidates::of(std::span<const std::span<const TriangleRange>>(&span, 1))),
            (std::vector<TriangleRange>{{3, 11, 1}, {1, 5, 2}, {1, 1, 1}}));
}

TEST(OracleRays, KeepsWhatItsOwnRaysFindAndCountsThem) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (int i = 0; i < 5; ++i) scene.objects.push_back({0, placed({3.0 * i, 0.0, 0.0}), none_id});
  scene.finish();
  const PathTruth truth(scene);
  BuildContext context;
  context.truth = &truth;
  const Camera camera = camera_at({0.0, 0.0, 20.0}, {0.0, 0.0, 0.0});
  CullerRun few("oracle.rays[aim=lattice,every_px=64,offset_x_px=32.5,offset_y_px=32.3]", scene,
                context);
  few.update(camera, {});
  EXPECT_EQ(few.objects(camera), (std::vector<ObjectId>{0})) << "one ray, straight on";
  EXPECT_EQ(few.counter("rays"), 1U);
  EXPECT_EQ(few.counter("unseen_ppm"), 1'000'000U) << "all that was seen was seen once";
  CullerRun many("oracle.rays", scene, context);
  many.update(camera, {});
  EXPECT_EQ(many.objects(camera), (std::vector<ObjectId>{0, 1, 2, 3, 4}));
  CullerRun triangles("oracle.rays[level=triangle]", scene, context);
  triangles.update(camera, {});
  EXPECT_EQ(triangles.emitted(camera).front().count, 2U) << "only the front of the first cube";
}

TEST_F(Oracle, RefusesToBuildWithoutTruth) {
  EXPECT_THROW(CullerRun("oracle.rays", scene_), InputError);
  EXPECT_THROW(CullerRun("oracle.rays", scene_, context_), InputError)
      << "a truth that is written down casts no rays";
  EXPECT_THROW(CullerRun("oracle", scene_), InputError);
  EXPECT_THROW(CullerRun("oracle[level=triangle]", scene_), InputError);
}

}  // namespace
}  // namespace vislab
