#include <gtest/gtest.h>

#include "common/judge/image_judge.h"
#include "common/judge/truth.h"
#include "common/render/osmesa_device.h"
#include "common/scene/error.h"
#include "common/scene/generators/generators.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

using Objects = std::vector<ObjectId>;

/// A quad in the plane z = 0 that is seen from +z.
Mesh sheet() {
  Mesh mesh;
  mesh.positions = {
      {-1.0F, -1.0F, 0.0F}, {1.0F, -1.0F, 0.0F}, {1.0F, 1.0F, 0.0F}, {-1.0F, 1.0F, 0.0F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

glm::dmat4x3 moved(const glm::dvec3& place) {
  glm::dmat4x3 transform(1.0);
  transform[3] = place;
  return transform;
}

/// In a row along z: a cube, a sheet, a cube, and one far to the side.
Scene row() {
  Scene scene;
  scene.meshes = {cube_mesh(), sheet()};
  scene.objects = {{0, moved({0.0, 0.0, 0.0}), none_id},
                   {1, moved({0.0, 0.0, -5.0}), none_id},
                   {0, moved({0.0, 0.0, -10.0}), none_id},
                   {0, moved({150.0, 0.0, -10.0}), none_id}};
  scene.finish();
  return scene;
}

/// A culler, the device that it uses, and what the device is told.
class GlRun {
 public:
  GlRun(const std::string& spec, const Scene& scene) : run_(spec, scene, with_device(scene)) {}

  Objects one_sided(const Camera& camera, const Candidates& candidates = Candidates::everything()) {
    const Frame frame = run_.frame(camera);
    device_.begin_frame(frame);
    emitted_ = run_.emitted(camera, candidates);
    return {device_.one_sided().begin(), device_.one_sided().end()};
  }
  const std::vector<TriangleRange>& emitted() const { return emitted_; }
  const CullerInfo& info() { return run_.culler().info(); }

 private:
  BuildContext with_device(const Scene& scene) {
    device_.load(scene);
    BuildContext context;
    context.device = &device_;
    return context;
  }

  OsMesaDevice device_;
  CullerRun run_;
  std::vector<TriangleRange> emitted_;
};

const Camera down_the_row = camera_at({0.0, 0.0, 10.0}, {0.0, 0.0, 0.0});

TEST(BackfaceGl, HasTheDeviceCullSolidObjectsAndSubmitsEverything) {
  const Scene scene = row();
  GlRun run("backface.gl", scene);
  EXPECT_EQ(run.one_sided(down_the_row), (Objects{0, 2, 3}));
  std::uint64_t triangles = 0;
  for (const TriangleRange& range : run.emitted()) triangles += range.count;
  EXPECT_EQ(triangles, scene.triangle_count());
  EXPECT_EQ(run.info().guarantee, Guarantee::image_exact);
}

TEST(BackfaceGl, KeepsBothSidesOfWhatMayHoldTheEye) {
  const Scene scene = row();
  GlRun run("backface.gl", scene);
  EXPECT_EQ(run.one_sided(camera_at({0.0, 0.0, 0.5}, {0.0, 0.0, -10.0})), (Objects{2, 3}));
  Camera orthographic = camera_at({0.0, 0.0, 0.5}, {0.0, 0.0, -10.0});
  orthographic.lens = orthographic_lens(5.0, 1.0, 0.1, 100.0);
  EXPECT_EQ(run.one_sided(orthographic), (Objects{2, 3}));
}

TEST(BackfaceGl, CullsOpenMeshesOnlyIfToldTo) {
  const Scene scene = row();
  GlRun run("backface.gl[open=cull]", scene);
  EXPECT_EQ(run.one_sided(down_the_row), (Objects{0, 1, 2, 3}));
  EXPECT_EQ(run.info().guarantee, Guarantee::approximate);
}

TEST(BackfaceGl, NamesOnlyWhatItIsOfferedAndEachObjectOnce) {
  const Scene scene = row();
  GlRun run("backface.gl", scene);
  const std::array<TriangleRange, 3> ranges = {{{2, 0, 3}, {2, 5, 2}, {1, 0, 1}}};
  const std::span<const TriangleRange> part(ranges);
  EXPECT_EQ(
      run.one_sided(down_the_row,
                    Candidates::of(std::span<const std::span<const TriangleRange>>(&part, 1))),
      (Objects{2}));
  EXPECT_EQ(run.emitted(), std::vector<TriangleRange>(ranges.begin(), ranges.end()));
}

TEST(BackfaceGl, WorksOnWhatOtherStagesKeep) {
  const Scene scene = row();
  GlRun chain("frustum.flat > backface.gl", scene);
  EXPECT_EQ(chain.one_sided(down_the_row), (Objects{0, 2}));
  GlRun after("backface.polygon > backface.gl", scene);
  EXPECT_EQ(after.one_sided(down_the_row), (Objects{0, 2, 3}));
}

TEST(BackfaceGl, RefusesToWorkWithoutADevice) {
  const Scene scene = row();
  EXPECT_THROW(CullerRun("backface.gl", scene), InputError);
}

/// Pixels that change, undisputed, if the device leaves out the backs of all objects.
std::uint64_t changed_pixels(const Scene& scene, const Camera& camera) {
  const SceneState state(scene);
  const Frame frame{0, camera, {96, 96}, state.view(), 0.0};
  RayCaster caster(scene, TruthSettings{});
  const FrameTruth truth = caster.trace(frame);
  ImageJudge judge(scene);
  judge.start(frame, truth);
  const VisibleSet all({{0, static_cast<std::uint32_t>(scene.triangle_count())}});
  return judge.judge(frame, all, frame.objects.shown).image_px;
}

TEST(BackfaceGl, ChangesNoUndisputedPixelOfSolidsUnderAnyTransform) {
  BumpySphereParameters bumpy;
  bumpy.subdivisions = 24;
  bumpy.bumps = Bumps::high;
  Scene scene;
  scene.meshes = {bumpy_sphere_mesh(bumpy)};
  glm::dmat4x3 mirrored = moved({-1.5, 0.0, 0.0});
  mirrored[0] = -mirrored[0];
  glm::dmat4x3 sheared = moved({1.5, 0.0, 0.0});
  sheared[1] += glm::dvec3(0.8, 0.0, 0.3);
  scene.objects = {{0, mirrored, none_id}, {0, sheared, none_id}};
  scene.finish();
  ASSERT_TRUE(scene.meshes[0].solid);
  Camera camera = camera_at({0.5, 1.0, 7.0}, {0.0, 0.0, 0.0});
  EXPECT_EQ(changed_pixels(scene, camera), 0U);
  camera.lens = orthographic_lens(3.0, 1.0, 0.1, 100.0);
  EXPECT_EQ(changed_pixels(scene, camera), 0U);
}

TEST(BackfaceGl, IsFoundOutWhereItCullsWhatShowsItsBack) {
  EXPECT_GT(changed_pixels(row(), camera_at({0.0, 0.0, -7.5}, {0.0, 0.0, 0.0})), 100U)
      << "the sheet from behind";
}

}  // namespace
}  // namespace vislab
