#include "common/judge/metrics.h"

#include <gtest/gtest.h>

#include <set>

#include "common/geometry/frustum.h"
#include "common/judge/disputed.h"
#include "tests/judge/judge_scenes.h"

namespace vislab {
namespace {

constexpr TruthSettings settings{.jitter_per_pixel = 4, .seed = 1, .threads = 2};

/// Cubes in front of a camera, beside it and behind it; some hide others.
Scene cube_garden() {
  std::vector<glm::dvec3> centers;
  for (int x = -4; x <= 4; ++x) {
    for (int z = -4; z <= 4; ++z) centers.emplace_back(4.0 * x, 0.3 * ((x + z) % 3), 4.0 * z);
  }
  return cubes_at(centers);
}

class Judged {
 public:
  Judged(Scene scene, const Camera& camera, const Viewport& viewport = {96, 80})
      : stage(std::move(scene), camera, viewport),
        caster(stage.scene, settings),
        truth(caster.trace(stage.frame)) {}

  Verdict judge(const VisibleSet& kept, Granularity granularity = Granularity::object) {
    return judge_set(stage.frame, truth, kept, granularity, caster);
  }
  /// Samples of C that show `triangle` and lie clear of its edges.
  std::uint64_t clear_pixels(TriangleId triangle) const {
    std::uint64_t count = 0;
    const WindowTriangle window = window_triangle(stage.frame, stage.scene, triangle);
    for (std::size_t i = 0; i < truth.ids.size(); ++i) {
      count += truth.ids[i] == triangle &&
                       window.edge_distance(centre_of(i, stage.frame.viewport)) >= disputed_edge_px
                   ? 1
                   : 0;
    }
    return count;
  }

  Stage stage;
  RayCaster caster;
  FrameTruth truth;
};

Camera garden_camera() { return camera_at({1.0, 2.5, 13.0}, {0.0, 0.0, 0.0}, 0.1, 60.0); }

TEST(JudgeSet, finds_nothing_wrong_with_everything_and_counts_what_is_too_much) {
  Judged judged(cube_garden(), garden_camera());
  const VisibleSet everything = all_but(judged.stage, {});
  const Verdict verdict = judged.judge(everything);
  const std::vector<TriangleId> visible = judged.truth.visible();
  std::set<ObjectId> visible_objects;
  for (const TriangleId id : visible) visible_objects.insert(judged.stage.scene.object_of(id));
  EXPECT_EQ(verdict.false_px, 0U);
  EXPECT_EQ(verdict.false_objects, 0U);
  EXPECT_EQ(verdict.false_triangles, 0U);
  EXPECT_EQ(verdict.false_jittered, 0U);
  EXPECT_EQ(verdict.pixels, 96U * 80U);
  EXPECT_EQ(verdict.jittered, 96U * 80U * 4U);
  EXPECT_EQ(verdict.scene_objects, 81U);
  EXPECT_EQ(verdict.scene_triangles, 81U * 12U);
  EXPECT_EQ(verdict.submitted_triangles, 81U * 12U);
  EXPECT_EQ(verdict.kept_objects, 81U);
  EXPECT_EQ(verdict.visible_triangles, visible.size());
  EXPECT_EQ(verdict.visible_objects, visible_objects.size());
  EXPECT_EQ(verdict.over_triangles_count, 81U * 12U - visible.size());
  EXPECT_EQ(verdict.over_objects_count, 81U - visible_objects.size());
  EXPECT_EQ(verdict.under_triangles_count, 0U);
  EXPECT_EQ(verdict.under_objects_count, 0U);
  EXPECT_TRUE(verdict.wrong_px.empty());
}

TEST(JudgeSet, finds_nothing_wrong_and_nothing_too_much_with_exactly_what_is_visible) {
  Judged judged(cube_garden(), garden_camera());
  std::vector<VisibleSet::Run> runs;
  for (const TriangleId id : judged.truth.visible()) runs.push_back({id, 1});
  const Verdict verdict = judged.judge(VisibleSet(runs), Granularity::triangle);
  EXPECT_EQ(verdict.false_px + verdict.false_jittered + verdict.false_objects, 0U);
  EXPECT_EQ(verdict.over_triangles_count + verdict.under_triangles_count, 0U);
  EXPECT_EQ(verdict.over_objects_count + verdict.under_objects_count, 0U);
}

TEST(JudgeSet, finds_all_of_it_wrong_if_nothing_is_kept) {
  Judged judged(cube_garden(), garden_camera());
  const Verdict verdict = judged.judge(VisibleSet());
  std::uint64_t shown_px = 0;
  for (const TriangleId id : judged.truth.ids) shown_px += id != none_id ? 1 : 0;
  EXPECT_EQ(verdict.false_px + verdict.disputed_lost_px, shown_px);
  EXPECT_GT(verdict.false_px, shown_px * 9 / 10);
  EXPECT_EQ(verdict.false_objects, verdict.visible_objects);
  EXPECT_EQ(verdict.under_objects_count, verdict.visible_objects);
  EXPECT_EQ(verdict.under_triangles_count, verdict.visible_triangles);
  EXPECT_EQ(verdict.wrong_px.size(), 64U);
}

TEST(JudgeSet, charges_a_dropped_triangle_with_exactly_its_undisputed_pixels) {
  // A lone cube: behind a dropped triangle there is the far side, whose edges are far from most
  // pixels, or nothing.
  Scene scene;
  add_triangle(scene, {-1.0F, -1.0F, 0.0F}, {1.0F, -1.0F, 0.0F}, {0.1F, 1.0F, 0.3F});
  add_triangle(scene, {-9.0F, -9.0F, -5.0F}, {9.0F, -9.0F, -5.0F}, {0.0F, 12.0F, -5.0F});
  Judged judged(std::move(scene), camera_at({0.0, 0.0, 4.0}, {0.0, 0.0, 0.0}));
  const Verdict verdict = judged.judge(all_but(judged.stage, {0}), Granularity::triangle);
  const auto own = static_cast<std::uint64_t>(std::ranges::count(judged.truth.ids, 0U));
  ASSERT_GT(own, 500U);
  EXPECT_EQ(verdict.false_px, judged.clear_pixels(0));
  EXPECT_EQ(verdict.max_false_px, verdict.false_px);
  EXPECT_EQ(verdict.disputed_lost_px, own - verdict.false_px);
  EXPECT_EQ(verdict.false_triangles, 1U);
  EXPECT_EQ(verdict.false_objects, 1U);
  EXPECT_EQ(verdict.under_triangles_count, 1U);
  ASSERT_EQ(judged.truth.hits.front().triangle, 0U);
  EXPECT_EQ(verdict.false_jittered, judged.truth.hits.front().clear_hits);
  for (const auto& [x, y] : verdict.wrong_px) EXPECT_EQ(judged.truth.ids[y * 96U + x], 0U);
}

TEST(JudgeSet, does_not_charge_a_dropped_triangle_that_is_invisible) {
  Judged judged(cube_garden(), garden_camera());
  const std::vector<TriangleId> visible = judged.truth.visible();
  std::vector<TriangleId> invisible;
  for (TriangleId id = 0; id < judged.stage.scene.triangle_count(); ++id) {
    if (!std::ranges::binary_search(visible, id)) invisible.push_back(id);
  }
  ASSERT_GT(invisible.size(), 300U);
  const Verdict verdict = judged.judge(all_but(judged.stage, invisible), Granularity::triangle);
  EXPECT_EQ(verdict.false_px + verdict.disputed_lost_px, 0U);
  EXPECT_EQ(verdict.over_triangles_count, 0U);
}

TEST(JudgeSet, excuses_a_triangle_at_the_same_place_as_one_that_is_kept) {
  Scene scene;
  const glm::vec3 a(-1.0F, -1.0F, 0.0F);
  const glm::vec3 b(1.0F, -1.0F, 0.0F);
  const glm::vec3 c(0.0F, 1.0F, 0.5F);
  add_triangle(scene, a, b, c);
  // The second covers the first in the same plane, with its edges elsewhere.
  const glm::vec3 middle = (a + b + c) / 3.0F;
  add_triangle(scene, middle + (a - middle) * 2.0F, middle + (b - middle) * 2.0F,
               middle + (c - middle) * 2.0F);
  Judged judged(std::move(scene), camera_at({0.0, 0.0, 4.0}, {0.0, 0.0, 0.0}));
  const bool first_is_seen = std::ranges::binary_search(judged.truth.visible(), 0U);
  for (const TriangleId dropped : {0U, 1U}) {
    const auto own = static_cast<std::uint64_t>(std::ranges::count(judged.truth.ids, dropped));
    const Verdict verdict = judged.judge(all_but(judged.stage, {dropped}), Granularity::triangle);
    EXPECT_EQ(verdict.false_px + verdict.disputed_lost_px, own) << "all lost, dropped " << dropped;
    if (dropped == 0) {
      EXPECT_EQ(verdict.false_px + verdict.false_jittered, 0U);
      EXPECT_EQ(verdict.false_triangles, 0U);
      EXPECT_EQ(verdict.false_objects, first_is_seen ? 1U : 0U)
          << "an object that has disputed samples only and loses them all is a finding";
    }
  }
}

TEST(JudgeSet, excuses_a_pixel_that_a_painted_image_gives_to_an_edge_beside_it) {
  constexpr std::size_t width = 96;
  constexpr std::size_t height = 80;
  // An upright edge 1/256 pixel to the right of the centres of column 60, 4 m away.
  const double ndc = 2.0 * (60.5 + 1.0 / 256.0) / width - 1.0;
  const auto x = static_cast<float>(4.0 * std::tan(std::numbers::pi / 6.0) * ndc);
  Scene scene;
  add_triangle(scene, {-20.0F, -20.0F, -5.0F}, {20.0F, -20.0F, -5.0F}, {0.0F, 30.0F, -5.0F});
  add_triangle(scene, {x, -20.0F, 0.0F}, {x + 20.0F, 0.0F, 0.0F}, {x, 20.0F, 0.0F});
  Judged judged(std::move(scene), camera_at({0.0, 0.0, 4.0}, {0.0, 0.0, 0.0}), {width, height});
  const VisibleSet kept = all_but(judged.stage, {0});
  const auto verdict = [&](TriangleId owner) {
    const std::vector<TriangleId> owners(width * height, owner);
    return judge_set(judged.stage.frame, judged.truth, kept, Granularity::triangle, judged.caster,
                     ShownImage{owners});
  };
  EXPECT_EQ(judged.judge(kept).false_px, 61U * height);
  EXPECT_EQ(verdict(1).false_px, 60U * height) << "only those beside the edge";
  EXPECT_EQ(verdict(none_id).false_px, 61U * height);
  EXPECT_EQ(verdict(0).false_px, 61U * height) << "the owner was left out itself";
}

TEST(JudgeSet, counts_an_object_false_only_if_it_loses_all_its_undisputed_samples) {
  Judged judged(cubes_at({{0.0, 0.0, 0.0}}), camera_at({2.0, 3.0, 5.0}, {0.0, 0.0, 0.0}));
  const std::vector<TriangleId> visible = judged.truth.visible();
  ASSERT_EQ(visible.size(), 6U) << "three faces are seen";
  const Verdict some =
      judged.judge(all_but(judged.stage, {visible[0], visible[1]}), Granularity::triangle);
  EXPECT_GT(some.false_px, 0U);
  EXPECT_EQ(some.false_triangles, 2U);
  EXPECT_EQ(some.false_objects, 0U);
  EXPECT_EQ(some.under_objects_count, 0U);
  const Verdict all = judged.judge(all_but(judged.stage, visible), Granularity::triangle);
  EXPECT_EQ(all.false_triangles, 6U);
  EXPECT_EQ(all.false_objects, 1U);
  EXPECT_EQ(all.kept_objects, 1U);
}

TEST(JudgeSet, names_the_worst_object_first) {
  Judged judged(cubes_at({{-3.0, 0.0, 0.0}, {3.0, 0.0, -20.0}}),
                camera_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0}));
  const Verdict verdict = judged.judge(VisibleSet());
  const Verdict near_only =
      judged.judge(objects_where(judged.stage, [](ObjectId o) { return o == 1; }));
  EXPECT_EQ(verdict.max_false_px, near_only.false_px);
  EXPECT_LT(verdict.max_false_px, verdict.false_px);
  const auto [x, y] = verdict.wrong_px.front();
  EXPECT_EQ(judged.stage.scene.object_of(judged.truth.ids[y * 96U + x]), 0U);
}

/// The judge must see these mistakes of a frustum test, and nothing in the right one.
class FrustumMistakes : public testing::Test {
 protected:
  FrustumMistakes()
      : judged_(cube_garden(), camera_at({2.0, 7.0, 22.0}, {-1.0, 0.0, 0.0}, 0.1, 60.0)),
        frustum_(frustum_of(judged_.stage.frame.camera)) {}

  template <typename Outside>
  Verdict judge_without(Outside&& outside) {
    return judged_.judge(objects_where(judged_.stage, [&](ObjectId object) {
      const Aabb& box = judged_.stage.frame.objects.bounds[object];
      return std::ranges::none_of(frustum_.span(),
                                  [&](const Plane& plane) { return outside(plane, box); });
    }));
  }

  Judged judged_;
  Frustum frustum_;
};

TEST_F(FrustumMistakes, none_in_the_right_test) {
  const Verdict verdict =
      judge_without([](const Plane& plane, const Aabb& box) { return surely_outside(plane, box); });
  EXPECT_EQ(verdict.false_px + verdict.false_jittered + verdict.false_objects, 0U);
  EXPECT_EQ(verdict.under_triangles_count, 0U);
  EXPECT_LT(verdict.kept_objects, verdict.scene_objects);
}

TEST_F(FrustumMistakes, one_planes_sign_flipped) {
  for (int flipped = 0; flipped < 6; ++flipped) {
    frustum_ = frustum_of(judged_.stage.frame.camera);
    frustum_.planes[flipped] = {-frustum_.planes[flipped].normal, -frustum_.planes[flipped].d,
                                frustum_.planes[flipped].magnitude};
    const Verdict verdict = judge_without(
        [](const Plane& plane, const Aabb& box) { return surely_outside(plane, box); });
    EXPECT_GT(verdict.false_px, 0U) << "plane " << flipped;
    EXPECT_GT(verdict.false_objects, 0U) << "plane " << flipped;
  }
}

TEST_F(FrustumMistakes, all_normals_flipped) {
  for (Plane& plane : frustum_.planes) plane = {-plane.normal, -plane.d, plane.magnitude};
  const Verdict verdict =
      judge_without([](const Plane& plane, const Aabb& box) { return surely_outside(plane, box); });
  EXPECT_GT(verdict.false_px, 0U);
}

TEST_F(FrustumMistakes, inside_only_if_all_corners_are_inside) {
  const Verdict verdict =
      judge_without([](const Plane& plane, const Aabb& box) { return !surely_inside(plane, box); });
  EXPECT_GT(verdict.false_px, 0U);
  EXPECT_GT(verdict.false_objects, 0U);
}

TEST(BackFaceMistake, of_dropping_front_faces_is_seen) {
  Judged judged(cubes_at({{0.0, 0.0, 0.0}}), camera_at({2.0, 3.0, 5.0}, {0.0, 0.0, 0.0}));
  std::vector<TriangleId> front;
  std::vector<TriangleId> back;
  for (TriangleId id = 0; id < 12; ++id) {
    const auto [a, b, c] =
        world_triangle(judged.stage.scene.mesh_of(0), judged.stage.frame.objects.transforms[0], id);
    const Plane plane = plane_through(a, b, c);
    (plane.signed_distance(judged.stage.frame.camera.pose.eye) > 0.0 ? front : back).push_back(id);
  }
  EXPECT_EQ(judged.judge(all_but(judged.stage, back), Granularity::triangle).false_px, 0U);
  EXPECT_GT(judged.judge(all_but(judged.stage, front), Granularity::triangle).false_px, 0U);
}

TEST(MetricTable, has_unique_names_and_says_what_they_mean) {
  std::set<std::string_view> names;
  for (const Metric& metric : metrics()) {
    EXPECT_TRUE(names.insert(metric.name).second) << metric.name;
    EXPECT_FALSE(metric.unit.empty()) << metric.name;
    EXPECT_FALSE(metric.meaning.empty()) << metric.name;
  }
  for (const char* name : {"false_px", "over", "under", "frame_ms", "efficiency"}) {
    EXPECT_TRUE(names.contains(name)) << name;
  }
}

}  // namespace
}  // namespace vislab
