// detail.screen_size and detail.wrong on scenes whose objects are below, at and above a threshold.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/judge/metrics.h"
#include "common/judge/stability.h"
#include "common/scene/generators/generators.h"
#include "common/scene/generators/swarm.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

Camera looking_along(const glm::dvec3& eye, const glm::dvec3& way, double fov_deg = 60.0) {
  return {look_at(eye, eye + way), perspective_lens(degrees(fov_deg), 1.0, 0.1, 500.0)};
}

/// A culler on a path of frames of 64 x 64 pixels.
class DetailRun {
 public:
  DetailRun(const std::string& spec, const Scene& scene) : run_(spec, scene), scene_(&scene) {}

  void reset() { run_.reset(); }
  const CullerInfo& info() { return run_.culler().info(); }

  std::vector<ObjectId> kept(const Camera& camera, const Changes& changes = {}) {
    run_.update(camera, changes);
    std::vector<ObjectId> ids;
    for (const TriangleRange& range : run_.emitted(camera)) ids.push_back(range.object);
    return ids;
  }

  /// What it left out of a frame, by truth's rays.
  Verdict verdict(const Camera& camera) {
    std::vector<VisibleSet::Run> runs;
    for (const ObjectId object : kept(camera)) {
      runs.push_back({scene_->first_triangle(object), scene_->triangle_count(object)});
    }
    RayCaster caster(*scene_, TruthSettings());
    const Frame frame = run_.frame(camera, {64, 64});
    return judge_set(frame, caster.trace(frame), VisibleSet(std::move(runs)), Granularity::object,
                     caster);
  }

 private:
  CullerRun run_;
  const Scene* scene_;
};

/// Cubes in a row across the view, half a metre apart, 20 m before the origin, of growing size.
Scene row() {
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (int i = 0; i < 20; ++i) {
    const double half = 0.02 * (i + 1);
    scene.objects.push_back(
        {0, box_transform({0.9 * (i - 9.5), 0.0, -20.0}, glm::dvec3(half)), none_id});
  }
  scene.finish();
  return scene;
}

const Camera front = looking_along({0, 0, 0}, {0, 0, -1});

TEST(DetailScreenSize, LeavesOutMoreTheHigherTheThreshold) {
  const Scene scene = row();
  std::size_t last = scene.object_count();
  for (const char* threshold : {"0", "0.1", "1", "4", "16"}) {
    for (const char* area : {"sphere", "box"}) {
      DetailRun run(
          std::string("detail.screen_size[area=") + area + ",threshold_px=" + threshold + "]",
          scene);
      const std::vector<ObjectId> kept = run.kept(front);
      EXPECT_LE(kept.size(), last + (std::string(area) == "sphere" ? 0 : 1));
      // Larger ones stay: what is left out comes first in the row.
      if (!kept.empty()) {
        EXPECT_EQ(kept.size(), scene.object_count() - kept.front());
      }
      if (std::string(area) == "box") last = kept.size();
    }
  }
  EXPECT_LT(last, 5U);
}

TEST(DetailScreenSize, KeepsAllThatMayBeSeenAtAThresholdOfNothing) {
  Scene scene = row();
  Scene behind;
  behind.meshes = scene.meshes;
  behind.objects = scene.objects;
  behind.objects.push_back({0, box_transform({0, 0, 5}, glm::dvec3(1.0)), none_id});
  behind.objects.push_back({0, box_transform({0, 0, 0}, glm::dvec3(1.0)), none_id});
  behind.objects.push_back({0, box_transform({300, 0, -20}, glm::dvec3(1e-5)), none_id});
  behind.finish();
  DetailRun run("detail.screen_size[threshold_px=0]", behind);
  EXPECT_EQ(run.info().guarantee, Guarantee::conservative);
  const std::vector<ObjectId> kept = run.kept(front);
  EXPECT_EQ(kept.size(), behind.object_count() - 1);
  EXPECT_EQ(std::ranges::count(kept, ObjectId{20}), 0);  // wholly before the near plane
  DetailRun some("detail.screen_size", behind);
  EXPECT_EQ(some.info().guarantee, Guarantee::approximate);
}

TEST(DetailScreenSize, KeepsWhatHoldsTheEyeAtAnyThreshold) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {{0, box_transform({0, 0, 0}, glm::dvec3(1.0)), none_id}};
  scene.finish();
  DetailRun sphere("detail.screen_size[threshold_px=1000000]", scene);
  EXPECT_EQ(sphere.kept(front).size(), 1U);
}

TEST(DetailScreenSize, DoesNotAskWhereTheImageEnds) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {{0, box_transform({60, 0, -20}, glm::dvec3(2.0)), none_id}};
  scene.finish();
  DetailRun run("detail.screen_size[threshold_px=4]", scene);
  EXPECT_EQ(run.kept(front).size(), 1U);
}

TEST(DetailScreenSize, MeasuresASheetAsItIsSeen) {
  Scene scene;
  scene.meshes = {box_mesh({1.0, 0.0, 1.0}, 1, 1.0)};
  scene.objects = {{0, box_transform({0, -3, -10}, glm::dvec3(1.0)), none_id},
                   {0, box_transform({0, 0, -10}, glm::dvec3(1.0)), none_id}};
  scene.finish();
  DetailRun box("detail.screen_size[area=box,threshold_px=4]", scene);
  EXPECT_EQ(box.kept(front), std::vector<ObjectId>{0});
  DetailRun sphere("detail.screen_size[threshold_px=4]", scene);
  EXPECT_EQ(sphere.kept(front).size(), 2U);
  DetailRun wrong("detail.wrong[error=inner_sphere,threshold_px=4]", scene);
  EXPECT_TRUE(wrong.kept(front).empty());
}

TEST(DetailScreenSize, FollowsObjectsThatMoveAndForgetsThemAtTheNextPath) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {{0, box_transform({0, 0, -200}, glm::dvec3(1.0)), none_id}};
  scene.finish();
  for (const char* area : {"sphere", "box"}) {
    DetailRun run(std::string("detail.screen_size[threshold_px=4,area=") + area + "]", scene);
    EXPECT_TRUE(run.kept(front).empty());
    Changes nearer;
    nearer.moved = {0};
    nearer.transforms = {box_transform({0, 0, -10}, glm::dvec3(1.0))};
    EXPECT_EQ(run.kept(front, nearer).size(), 1U);
    EXPECT_EQ(run.kept(front).size(), 1U);
    run.reset();
    EXPECT_TRUE(run.kept(front).empty());
  }
}

TEST(DetailMotionRule, IsOffWhenTheCameraStandsAndGrowsWithItsSpeed) {
  const Scene scene = row();
  DetailRun run("detail.screen_size[threshold_px=4,motion=3]", scene);
  EXPECT_EQ(run.info().repeatability, Repeatability::path);
  DetailRun whole("detail.screen_size[threshold_px=4]", scene);
  EXPECT_EQ(whole.info().repeatability, Repeatability::stateless);
  const std::size_t all = scene.object_count();
  const std::size_t fewest = whole.kept(front).size();
  ASSERT_LT(fewest, all / 2 + 1);
  EXPECT_EQ(run.kept(front).size(), all);  // the first frame: nothing is known of a motion
  EXPECT_EQ(run.kept(front).size(), all);
  // A pixel is 0.24 m at 20 m.
  const auto aside = [](double x) { return looking_along({x, 0, 0}, {0, 0, -1}); };
  const std::size_t slow = run.kept(aside(0.24)).size();
  EXPECT_LT(slow, all);
  EXPECT_GT(slow, fewest);
  EXPECT_EQ(run.kept(aside(0.24)).size(), all);  // it stopped
  EXPECT_EQ(run.kept(aside(1.3)).size(), fewest);
  run.reset();
  EXPECT_EQ(run.kept(aside(9.0)).size(), all);
}

TEST(DetailMotionRule, CountsTurningAsMotion) {
  const Scene scene = row();
  DetailRun run("detail.screen_size[threshold_px=4,motion=3]", scene);
  run.kept(front);
  EXPECT_LT(run.kept(looking_along({0, 0, 0}, {0.1, 0, -1})).size(), scene.object_count());
}

TEST(DetailHysteresis, KeepsATremblingCameraFromFlickering) {
  const Scene scene = row();
  const auto toggles = [&](const std::string& spec) {
    DetailRun run(spec, scene);
    std::size_t changes = 0;
    std::vector<ObjectId> last;
    for (int i = 0; i < 20; ++i) {
      const std::vector<ObjectId> kept =
          run.kept(looking_along({0, 0, i % 2 == 0 ? 0 : 0.8}, {0, 0, -1}));
      if (i > 1 && kept != last) ++changes;
      last = kept;
    }
    return changes;
  };
  // At 4 % more distance the threshold passes some of the twenty sizes.
  std::size_t most = 0;
  for (const char* threshold : {"1", "2", "4", "6"}) {
    const std::string given = std::string("threshold_px=") + threshold;
    most = std::max(most, toggles("detail.screen_size[" + given + "]"));
    EXPECT_EQ(toggles("detail.screen_size[hysteresis=0.25," + given + "]"), 0U);
  }
  EXPECT_GT(most, 10U);
}

TEST(DetailHysteresis, LosesNoMoreThanTheThresholdWhateverWasBefore) {
  const Scene scene = row();
  DetailRun plain("detail.screen_size[threshold_px=4]", scene);
  DetailRun run("detail.screen_size[threshold_px=4,hysteresis=0.5]", scene);
  for (const double z : {0.0, 30.0, -5.0, 2.0, 60.0, 0.0}) {
    const Camera camera = looking_along({0, 0, z}, {0, 0, -1});
    const std::vector<ObjectId> least = plain.kept(camera);
    EXPECT_TRUE(std::ranges::includes(run.kept(camera), least));
  }
}

/// Perimeter of the convex hull (Andrew's monotone chain).
double perimeter(std::vector<glm::dvec2> points) {
  std::ranges::sort(points, [](const glm::dvec2& a, const glm::dvec2& b) {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
  });
  double length = 0.0;
  for (int side = 0; side < 2; ++side) {
    std::vector<glm::dvec2> chain;
    for (const glm::dvec2& p : points) {
      while (chain.size() > 1) {
        const glm::dvec2 a = chain.back() - chain[chain.size() - 2];
        const glm::dvec2 b = p - chain.back();
        if (a.x * b.y - a.y * b.x > 0.0) break;
        chain.pop_back();
      }
      chain.push_back(p);
    }
    for (std::size_t i = 1; i < chain.size(); ++i) length += glm::distance(chain[i - 1], chain[i]);
    std::ranges::reverse(points);
  }
  return length;
}

/// Pixel centres that rays give each object, of all that were left out, against their bound. The
/// objects are cubes, so that their outlines are convex.
void expect_bounded_losses(const std::string& measure, double threshold_px, const Scene& scene,
                           const Camera& camera, std::uint64_t& lost_in_all) {
  DetailRun run(
      "detail.screen_size[area=" + measure + ",threshold_px=" + std::to_string(threshold_px) + "]",
      scene);
  CullerRun frames("none", scene);
  const Frame frame = frames.frame(camera, {64, 64});
  std::vector<std::uint8_t> is_kept(scene.object_count(), 0);
  for (const ObjectId object : run.kept(camera)) is_kept[object] = 1;
  RayCaster caster(scene, TruthSettings());
  const ObjectVisibility truth = object_visibility(scene, caster.trace(frame));
  for (ObjectId object = 0; object < scene.object_count(); ++object) {
    if (is_kept[object] != 0 || truth.pixels[object] == 0) continue;
    std::vector<glm::dvec2> outline;
    for (const glm::vec3& corner : scene.mesh_of(object).positions) {
      const glm::dvec4 clip =
          camera.view_projection() *
          glm::dvec4(scene.objects[object].transform * glm::dvec4(corner, 1.0), 1.0);
      outline.push_back((glm::dvec2(clip) / clip.w * 0.5 + 0.5) * 64.0);
    }
    EXPECT_LE(truth.pixels[object], threshold_px + 0.5 * perimeter(outline) + 1.0)
        << measure << ", object " << object;
    lost_in_all += truth.pixels[object];
  }
}

TEST(DetailScreenSize, LosesOfEachObjectNoMorePixelsThanTheThresholdAndHalfTheOutline) {
  BoxFieldParameters parameters;
  parameters.count = 1500;
  parameters.extent_m = 60.0;
  parameters.clear_radius_m = 8.0;
  parameters.rotated = true;
  Scene scene = make_box_field(parameters);
  scene.finish();
  std::uint64_t lost = 0;
  for (const double threshold_px : {1.0, 9.0, 40.0}) {
    for (const char* measure : {"sphere", "box"}) {
      expect_bounded_losses(measure, threshold_px, scene,
                            looking_along({0, 0, 0}, {1, 0.2, -1}, 110.0), lost);
    }
  }
  EXPECT_GT(lost, 500U);
}

TEST(DetailScreenSize, MayLoseInSumWhatNoObjectCovers) {
  SwarmParameters parameters;
  parameters.area_m2 = 80.0;
  parameters.width_m = 14.0;
  const auto lost = [&](std::uint32_t count) {
    parameters.count = count;
    Scene scene = make_swarm(parameters);
    scene.finish();
    DetailRun run("detail.screen_size[threshold_px=2]", scene);
    return run.verdict(looking_along({0, 0, 20}, {0, 0, -1}, 45.0));
  };
  EXPECT_EQ(lost(20).false_px, 0U);
  const Verdict swarm = lost(3000);
  EXPECT_GT(swarm.false_px, 300U);
  EXPECT_LE(swarm.max_false_px, 7U);
}

TEST(DetailWrong, LosesMoreThanTheThresholdOfAnObject) {
  // At the side of a wide view, where the ellipse is almost twice the printed disc.
  Scene scene;
  scene.meshes = {bumpy_sphere_mesh({12, Bumps::none, 0.0, glm::dvec3(0.0)})};
  const Camera camera = looking_along({0, 0, 0}, {0, 0, -1}, 120.0);
  for (const double radius : {3.2, 2.5, 1.5}) {
    glm::dmat4x3 transform = box_transform({12.0, 5.0, -10.0}, glm::dvec3(radius));
    scene.objects = {{0, transform, none_id}};
    Scene one = scene;
    one.finish();
    DetailRun right("detail.screen_size[threshold_px=100]", one);
    DetailRun printed("detail.wrong[error=printed_formula,threshold_px=100]", one);
    DetailRun units("detail.wrong[error=near_plane_units,threshold_px=100]", one);
    EXPECT_EQ(printed.info().guarantee, Guarantee::erroneous);
    EXPECT_EQ(units.kept(camera).size(), 0U);
    if (radius == 3.2) {
      EXPECT_EQ(printed.kept(camera).size(), 1U);
    }
    if (radius == 2.5) {
      EXPECT_EQ(right.kept(camera).size(), 1U);
      EXPECT_GT(printed.verdict(camera).max_false_px, 100U);
    }
    if (radius == 1.5) {
      EXPECT_EQ(right.kept(camera).size(), 0U);
    }
  }
}

}  // namespace
}  // namespace vislab
