#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "common/judge/disputed.h"
#include "common/judge/ray_scene.h"
#include "common/judge/truth.h"
#include "common/scene/error.h"
#include "tests/judge/judge_scenes.h"

namespace vislab {
namespace {

std::vector<TriangleId> all_ids(const Stage& stage) {
  std::vector<TriangleId> ids(stage.scene.triangle_count());
  for (TriangleId id = 0; id < ids.size(); ++id) ids[id] = id;
  return ids;
}

/// Every sample of C and J against the brute force: what differs must be disputed, and hardly any
/// may. Then the histogram against the samples of J one by one.
void expect_truth(const Stage& stage, RayCaster& caster, const std::string& what) {
  const FrameTruth truth = caster.trace(stage.frame);
  const Viewport viewport = stage.frame.viewport;
  ASSERT_EQ(truth.ids.size(), static_cast<std::size_t>(viewport.width) * viewport.height) << what;
  std::size_t differing = 0;
  const auto check = [&](const glm::dvec2& p, TriangleId id) {
    const TriangleId expected = brute_force(stage.frame, stage.scene, p);
    if (expected == id) return;
    ++differing;
    EXPECT_TRUE(is_disputed(stage.frame, stage.scene, p, expected, id))
        << what << " at " << p.x << ", " << p.y << ": " << id << " instead of " << expected;
  };
  for (std::size_t i = 0; i < truth.ids.size(); ++i) check(centre_of(i, viewport), truth.ids[i]);
  std::map<TriangleId, TriangleHits> histogram;
  for (const RayCaster::Sample& sample : caster.jittered_hits(stage.frame, all_ids(stage))) {
    check(sample.window_px, sample.triangle);
    TriangleHits& hits = histogram[sample.triangle];
    hits.triangle = sample.triangle;
    ++hits.hits;
    hits.clear_hits += window_triangle(stage.frame, stage.scene, sample.triangle)
                                   .edge_distance(sample.window_px) >= disputed_edge_px
                           ? 1
                           : 0;
  }
  std::vector<TriangleHits> expected;
  for (const auto& [id, hits] : histogram) expected.push_back(hits);
  EXPECT_EQ(truth.hits, expected) << what;
  EXPECT_LE(differing, truth.ids.size() / 200 + 2) << what;
}

Camera outside_camera() { return camera_at({0.0, 0.5, 6.0}, {0.2, 0.1, 0.0}); }

TEST(Truth, of_a_cube_is_its_front_face_and_background_around_it) {
  Stage stage(cubes_at({{0.0, 0.0, 0.0}}), camera_at({0.03, 0.02, 5.0}, {0.03, 0.02, 0.0}),
              {33, 31});
  RayCaster caster(stage.scene, {});
  const FrameTruth truth = caster.trace(stage.frame);
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    EXPECT_EQ(truth.ids[i], brute_force(stage.frame, stage.scene, centre_of(i, {33, 31}))) << i;
  }
  EXPECT_EQ(truth.ids.front(), none_id);
  EXPECT_NE(truth.ids[truth.ids.size() / 2], none_id);
  EXPECT_EQ(truth.visible().size(), 2U);
  EXPECT_EQ(truth.jittered_samples, 33U * 31U * 16U);
}

TEST(Truth, equals_a_brute_force_in_double_on_random_triangles) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Stage stage(random_triangles(12, 2.0, 1.0, seed), outside_camera(), {41, 29});
    RayCaster caster(stage.scene, {.jitter_per_pixel = 3, .seed = seed, .threads = 2});
    expect_truth(stage, caster, "seed " + std::to_string(seed));
  }
}

TEST(Truth, equals_a_brute_force_from_inside_with_triangles_cut_by_near_and_far_plane) {
  for (std::uint64_t seed = 4; seed <= 6; ++seed) {
    Stage stage(random_triangles(12, 1.0, 2.0, seed),
                camera_at({0.0, 0.0, 0.0}, {1.0, 0.3, 0.2}, 0.4, 1.7), {40, 30});
    RayCaster caster(stage.scene, {.jitter_per_pixel = 2, .seed = seed, .threads = 2});
    expect_truth(stage, caster, "seed " + std::to_string(seed));
  }
}

TEST(Truth, follows_off_centre_orthographic_and_infinite_cameras) {
  Camera off_centre = outside_camera();
  off_centre.lens.left *= 0.2;
  off_centre.lens.top *= 1.5;
  Camera infinite = outside_camera();
  infinite.lens.far_m = std::numeric_limits<double>::infinity();
  Camera orthographic = outside_camera();
  orthographic.lens = orthographic_lens(5.0, 1.0, 1.0, 9.0);
  Camera behind = outside_camera();
  behind.pose.eye = {0.0, 0.0, 0.0};
  behind.lens = orthographic_lens(5.0, 1.0, -2.0, 2.0);
  int number = 0;
  for (const Camera& camera : {off_centre, infinite, orthographic, behind}) {
    Stage stage(random_triangles(10, 2.0, 1.0, 7), camera, {30, 30});
    RayCaster caster(stage.scene, {.jitter_per_pixel = 4, .seed = 1, .threads = 1});
    expect_truth(stage, caster, "camera " + std::to_string(number++));
  }
}

TEST(Truth, follows_a_camera_and_a_scene_far_from_the_worlds_origin) {
  const glm::dvec3 far_away(40000.0, 300.0, -70000.0);
  Stage stage(cubes_at({far_away, far_away + glm::dvec3(3.0, 0.0, -1.0)}),
              camera_at(far_away + glm::dvec3(0.3, 0.5, 6.0), far_away), {40, 40});
  RayCaster caster(stage.scene, {.jitter_per_pixel = 1, .seed = 1, .threads = 1});
  expect_truth(stage, caster, "far away");
}

TEST(Truth, follows_objects_that_move_hide_and_come_back) {
  Stage stage(cubes_at({{-2.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, -3.0}, {0.0, 2.5, 0.0}}),
              camera_at({0.0, 1.0, 9.0}, {0.0, 0.0, 0.0}), {36, 36});
  RayCaster caster(stage.scene, {.jitter_per_pixel = 1, .seed = 1, .threads = 2});
  expect_truth(stage, caster, "as built");
  stage.apply(changes({1}, {box_transform({0.5, 0.4, 1.0}, glm::dvec3(0.7))}));
  expect_truth(stage, caster, "one moved");
  stage.apply(changes({1}, {box_transform({0.0, -1.0, 1.0}, glm::dvec3(0.7))}, {}, {0}));
  expect_truth(stage, caster, "it moved again, another hidden");
  stage.apply(changes({}, {}, {}, {1, 2}));
  expect_truth(stage, caster, "more hidden");
  stage.apply(changes({0}, {box_transform({1.0, 1.0, 1.0}, glm::dvec3(0.5))}, {0, 1}));
  expect_truth(stage, caster, "back, moved meanwhile");
  stage.apply(changes({}, {}, {}, {0, 1, 3}));
  expect_truth(stage, caster, "nothing shown");
  EXPECT_TRUE(caster.trace(stage.frame).visible().empty());
  stage.state.reset();
  stage.frame.objects = stage.state.view();
  expect_truth(stage, caster, "as built again");
}

TEST(Truth, follows_many_objects_that_start_to_move_one_after_another) {
  std::vector<glm::dvec3> centers;
  for (int i = 0; i < 9; ++i) centers.emplace_back(3.0 * (i % 3) - 3.0, 3.0 * (i / 3) - 3.0, 0.0);
  Stage stage(cubes_at(centers), camera_at({0.0, 1.0, 14.0}, {0.0, 0.0, 0.0}), {24, 24});
  RayCaster caster(stage.scene, {.jitter_per_pixel = 1, .seed = 1, .threads = 2});
  for (ObjectId object = 0; object < 9; ++object) {
    const glm::dvec3 to = centers[object] + glm::dvec3(0.5, 0.25, 1.0);
    stage.apply(changes({object}, {box_transform(to, glm::dvec3(0.9))}));
    expect_truth(stage, caster, "object " + std::to_string(object));
  }
}

TEST(Truth, of_a_scene_too_large_to_flatten_is_that_of_its_instances) {
  // More than RayScene::flat_triangle_limit triangles, most of them far behind the camera.
  Scene built;
  built.meshes.push_back(cube_mesh());
  const std::size_t count = RayScene::flat_triangle_limit / 12 + 1000;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 center = i < 20 ? glm::dvec3(3.0 * (i % 5) - 6.0, 3.0 * (i / 5) - 4.0, 0.0)
                                     : glm::dvec3(0.0, 0.0, 100.0 + static_cast<double>(i));
    built.objects.push_back({0, box_transform(center, glm::dvec3(1.0)), none_id});
  }
  Stage stage(std::move(built), camera_at({0.0, 0.5, 15.0}, {0.0, 0.0, 0.0}), {20, 20});
  RayCaster caster(stage.scene, {.jitter_per_pixel = 2, .seed = 1, .threads = 2});
  const auto expect_equal_to_flat = [&](const std::string& what) {
    // The same near objects in a scene of their own.
    Scene near_objects;
    near_objects.meshes.push_back(cube_mesh());
    for (ObjectId object = 0; object < 20; ++object) {
      if (std::ranges::binary_search(stage.frame.objects.shown, object)) {
        near_objects.objects.push_back({0, stage.frame.objects.transforms[object], none_id});
      } else {
        near_objects.objects.push_back({0, box_transform({0, 0, 500.0}, glm::dvec3(1.0)), none_id});
      }
    }
    Stage flat(std::move(near_objects), stage.frame.camera, stage.frame.viewport);
    RayCaster flat_caster(flat.scene, {.jitter_per_pixel = 2, .seed = 1, .threads = 2});
    const FrameTruth a = caster.trace(stage.frame);
    const FrameTruth b = flat_caster.trace(flat.frame);
    for (std::size_t i = 0; i < a.ids.size(); ++i) {
      if (a.ids[i] == b.ids[i]) continue;
      EXPECT_TRUE(is_disputed(flat.frame, flat.scene, centre_of(i, {20, 20}), a.ids[i], b.ids[i]))
          << what << " pixel " << i;
    }
    EXPECT_EQ(a.visible(), b.visible()) << what;
  };
  expect_equal_to_flat("as built");
  stage.apply(changes({3}, {box_transform({0.0, 0.0, 4.0}, glm::dvec3(0.8))}, {}, {7, 12}));
  expect_equal_to_flat("moved and hidden");
  stage.apply(changes({}, {}, {7}));
  expect_equal_to_flat("shown again");
}

TEST(Truth, is_the_same_with_one_and_with_two_threads_and_again) {
  // Coincident triangles too: which of them is hit must not depend on threads either.
  Scene built = random_triangles(200, 3.0, 0.6, 11);
  const Scene again = built;
  for (const Object& object : again.objects) built.objects.push_back(object);
  Stage stage(std::move(built), camera_at({0.0, 0.0, 9.0}, {0.0, 0.0, 0.0}), {101, 67});
  RayCaster one(stage.scene, {.jitter_per_pixel = 16, .seed = 1, .threads = 1});
  RayCaster two(stage.scene, {.jitter_per_pixel = 16, .seed = 1, .threads = 2});
  const FrameTruth truth = one.trace(stage.frame);
  EXPECT_EQ(truth, two.trace(stage.frame));
  EXPECT_EQ(truth, two.trace(stage.frame));
}

TEST(Truth, of_set_j_depends_on_the_seed) {
  Stage stage(random_triangles(50, 3.0, 0.6, 12), outside_camera(), {64, 64});
  RayCaster first(stage.scene, {.jitter_per_pixel = 4, .seed = 1, .threads = 2});
  RayCaster same(stage.scene, {.jitter_per_pixel = 4, .seed = 1, .threads = 2});
  RayCaster other(stage.scene, {.jitter_per_pixel = 4, .seed = 2, .threads = 2});
  const FrameTruth truth = first.trace(stage.frame);
  EXPECT_EQ(truth.hits, same.trace(stage.frame).hits);
  EXPECT_NE(truth.hits, other.trace(stage.frame).hits);
  EXPECT_EQ(truth.ids, other.trace(stage.frame).ids);
}

TEST(RayCaster, casts_among_kept_triangles_only_and_tells_planar_depth) {
  Stage stage(cubes_at({{0.0, 0.0, 0.0}, {0.0, 0.0, -10.0}}),
              camera_at({0.0, 0.0, 5.0}, {0.0, 0.0, 0.0}), {32, 32});
  RayCaster caster(stage.scene, {});
  const std::vector<glm::dvec2> positions = {{15.3, 15.2}, {14.1, 17.0}, {0.5, 0.5}};
  const auto all = caster.cast(stage.frame, positions, nullptr);
  EXPECT_EQ(stage.scene.object_of(all[0].triangle), 0U);
  EXPECT_NEAR(all[0].depth, 4.0, 1e-5);
  EXPECT_NEAR(all[1].depth, 4.0, 1e-5);
  EXPECT_EQ(all[2].triangle, none_id);
  const VisibleSet second = objects_where(stage, [](ObjectId object) { return object == 1; });
  const auto behind = caster.cast(stage.frame, positions, &second);
  EXPECT_EQ(stage.scene.object_of(behind[0].triangle), 1U);
  EXPECT_NEAR(behind[0].depth, 14.0, 1e-5);
  EXPECT_EQ(behind[2].triangle, none_id);
  const VisibleSet nothing;
  EXPECT_EQ(caster.cast(stage.frame, positions, &nothing)[0].triangle, none_id);
}

TEST(RayCaster, refuses_settings_out_of_range) {
  Stage stage(cubes_at({{0.0, 0.0, 0.0}}), outside_camera(), {8, 8});
  EXPECT_THROW(RayCaster(stage.scene, {.jitter_per_pixel = 0, .seed = 1, .threads = 1}),
               InputError);
  EXPECT_THROW(RayCaster(stage.scene, {.jitter_per_pixel = 1, .seed = 1, .threads = 0}),
               InputError);
}

TEST(TruthKey, differs_for_whatever_changes_truth_and_for_nothing_else) {
  Stage stage(cubes_at({{0.0, 0.0, 0.0}, {3.0, 0.0, 0.0}}), outside_camera(), {32, 32});
  const TruthSettings settings;
  const std::string key = truth_key(stage.frame, stage.scene, settings);
  EXPECT_EQ(key.size(), 32U);
  Frame later = stage.frame;
  later.index = 7;
  later.last_frame_ms = 3.0;
  EXPECT_EQ(truth_key(later, stage.scene, settings), key);
  EXPECT_EQ(truth_key(stage.frame, stage.scene, {16, 1, 1}), key) << "threads do not count";
  EXPECT_NE(truth_key(stage.frame, stage.scene, {16, 2, 2}), key);
  EXPECT_NE(truth_key(stage.frame, stage.scene, {4, 1, 2}), key);
  Frame wider = stage.frame;
  wider.viewport.width = 33;
  EXPECT_NE(truth_key(wider, stage.scene, settings), key);
  Frame nearer = stage.frame;
  nearer.camera.lens.near_m *= 1.5;
  EXPECT_NE(truth_key(nearer, stage.scene, settings), key);
  stage.apply(changes({}, {}, {}, {1}));
  const std::string hidden = truth_key(stage.frame, stage.scene, settings);
  EXPECT_NE(hidden, key);
  stage.apply(changes({1}, {box_transform({4, 0, 0}, glm::dvec3(1.0))}, {1}));
  EXPECT_NE(truth_key(stage.frame, stage.scene, settings), key);
  Stage other(cubes_at({{0.0, 0.0, 0.0}, {3.0, 0.0, 0.1}}), outside_camera(), {32, 32});
  EXPECT_NE(truth_key(other.frame, other.scene, settings), key);
}

}  // namespace
}  // namespace vislab
