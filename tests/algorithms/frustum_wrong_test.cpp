// Every mistake of frustum.wrong on a scene made for it: the judge finds it there, and the right
// test is right there.
#include <gtest/gtest.h>

#include <set>

#include "common/geometry/random.h"
#include "common/judge/metrics.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

/// A scene and what happens in it.
struct Play {
  struct Step {
    Camera camera;
    Changes changes;
  };
  Scene scene;
  std::vector<Step> steps;
};

/// What a culler did in all steps together.
struct Damage {
  std::uint64_t false_objects = 0, false_px = 0, kept = 0, visible = 0;
};

Damage damage(const std::string& spec, const Play& play) {
  CullerRun run(spec, play.scene);
  TruthSettings settings;
  RayCaster caster(play.scene, settings);
  Damage sum;
  for (const Play::Step& step : play.steps) {
    run.update(step.camera, step.changes);
    const Frame frame = run.frame(step.camera);
    std::vector<VisibleSet::Run> runs;
    for (const TriangleRange& range : run.emitted(step.camera)) {
      runs.push_back({play.scene.first_triangle(range.object) + range.first, range.count});
    }
    const Verdict verdict = judge_set(frame, caster.trace(frame), VisibleSet(std::move(runs)),
                                      Granularity::object, caster);
    sum.false_objects += verdict.false_objects;
    sum.false_px += verdict.false_px;
    sum.kept += verdict.kept_objects;
    sum.visible += verdict.visible_objects;
  }
  return sum;
}

/// Cubes of random size around the origin, which stays free.
Scene field(std::uint64_t seed, const glm::dvec3& offset = glm::dvec3(0.0)) {
  Random random(seed);
  Scene scene;
  scene.meshes = {cube_mesh()};
  while (scene.objects.size() < 400) {
    const glm::dvec3 at(random.uniform(-30.0, 30.0), random.uniform(-30.0, 30.0),
                        random.uniform(-30.0, 30.0));
    const glm::dvec3 scale(random.uniform(0.3, 1.5), random.uniform(0.3, 1.5),
                           random.uniform(0.3, 1.5));
    if (glm::length(at) < 4.0) continue;
    scene.objects.push_back({0, placed(offset + at, scale), none_id});
  }
  scene.finish();
  return scene;
}

/// From `eye` to all sides, up and down.
std::vector<Play::Step> looks(const glm::dvec3& eye, double fov_deg = 60.0) {
  std::vector<Play::Step> steps;
  for (const glm::dvec3& way : {glm::dvec3(1, 0, 0), glm::dvec3(0.3, 0.5, 1),
                                glm::dvec3(-1, -1, 0.4), glm::dvec3(0.2, 0.1, -1)}) {
    Camera camera{look_at(eye, eye + way), perspective_lens(degrees(fov_deg), 1.0, 0.1, 200.0)};
    steps.push_back({camera, {}});
  }
  return steps;
}

Play field_play() { return {field(41), looks(glm::dvec3(0.0))}; }

/// The tangent of 22 radians is less than 0.01.
Play seen_at_44_degrees() { return {field(41), looks(glm::dvec3(0.0), 44.0)}; }

Play pitched() {
  Play play{field(42), {}};
  play.steps.push_back({camera_at({0.0, 0.0, 0.0}, {0.2, 1.0, 0.3}), {}});
  return play;
}

Play off_centre() {
  Play play = field_play();
  for (Play::Step& step : play.steps) {
    step.camera.lens.left *= 0.2;
    step.camera.lens.right *= 1.8;
  }
  return play;
}

/// A wall that the frustum pierces.
Play wall() {
  Play play;
  play.scene.meshes = {cube_mesh()};
  play.scene.objects = {{0, placed({0.0, 0.0, -20.0}, {100.0, 100.0, 1.0}), none_id}};
  play.scene.finish();
  play.steps = {{camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}), {}}};
  return play;
}

/// Many views: boxes are rounded outward to float, which makes up for most of the errors of planes.
Play far_from_the_origin() {
  const glm::dvec3 offset(3.1e7, 1.7e7, -2.3e7);
  Play play{field(43, offset), {}};
  Random random(46);
  for (int i = 0; i < 60; ++i) {
    const double angle = random.uniform(0.0, 360.0);
    const glm::dvec3 eye = offset + glm::dvec3(random.uniform(-2.0, 2.0));
    const glm::dvec3 way(std::sin(degrees(angle)), random.uniform(-1.0, 1.0),
                         std::cos(degrees(angle)));
    play.steps.push_back({camera_at(eye, eye + way), {}});
  }
  return play;
}

/// A sheet of paper across the view.
Play flat_box() {
  Play play;
  Mesh sheet;
  sheet.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  play.scene.meshes = {sheet};
  play.scene.objects = {{0, placed({0.0, 0.0, -5.0}), none_id}};
  play.scene.finish();
  play.steps = {{camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}), {}}};
  return play;
}

Play long_turn() {
  Play play{field(44), {}};
  for (int angle = 0; angle <= 170; angle += 10) {
    const glm::dvec3 way(std::sin(degrees(angle)), 0.0, -std::cos(degrees(angle)));
    play.steps.push_back({camera_at({0.0, 0.0, 0.0}, way), {}});
  }
  return play;
}

Play departing() {
  Play play;
  play.scene.meshes = {cube_mesh()};
  play.scene.objects = {{0, placed({0.0, 0.0, 20.0}), none_id}, {0, placed({0, 0, 30}), none_id}};
  play.scene.finish();
  const Camera camera = camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});
  play.steps = {{camera, {}}, {camera, {{0}, {placed({0.0, 0.0, -20.0})}, {}, {}}}};
  return play;
}

Play churn() {
  Play play = field_play();
  std::set<ObjectId> hidden;
  Random random(45);
  const Camera camera = play.steps.front().camera;
  for (int i = 0; i < 60; ++i) {
    Play::Step step{camera, {}};
    step.changes.shown.assign(hidden.begin(), hidden.end());
    std::set<ObjectId> now;
    while (now.size() < 20) {
      const auto object = static_cast<ObjectId>(random.below(play.scene.object_count()));
      if (!hidden.contains(object)) now.insert(object);
    }
    step.changes.hidden.assign(now.begin(), now.end());
    hidden = now;
    play.steps.push_back(step);
  }
  return play;
}

struct Case {
  std::string error;
  Play (*play)();
};

class EveryMistake : public testing::TestWithParam<Case> {};

TEST_P(EveryMistake, IsFoundByTheJudgeWhereTheRightTestIsRight) {
  const Play play = GetParam().play();
  const Damage right = damage("frustum.flat", play);
  const Damage wrong = damage("frustum.wrong[error=" + GetParam().error + "]", play);
  EXPECT_EQ(right.false_objects, 0U);
  EXPECT_EQ(right.false_px, 0U);
  EXPECT_GT(right.visible, 0U);
  EXPECT_GT(wrong.false_objects, 0U);
  EXPECT_GT(wrong.false_px, 0U);
  RecordProperty("false_objects", static_cast<int>(wrong.false_objects));
  std::cout << GetParam().error << ": " << wrong.false_objects << " of " << wrong.visible
            << " visible objects and " << wrong.false_px << " pixels are lost; " << wrong.kept
            << " kept, right are " << right.kept << "\n";
}

INSTANTIATE_TEST_SUITE_P(
    FrustumWrong, EveryMistake,
    testing::Values(Case{"all_corners_inside", field_play}, Case{"any_corner_inside", wall},
                    Case{"outward_vertex", field_play}, Case{"degrees", seen_at_44_degrees},
                    Case{"direction", field_play}, Case{"thesis_up", pitched},
                    Case{"symmetric_lens", off_centre}, Case{"one_eye", field_play},
                    Case{"float_planes", far_from_the_origin}, Case{"nan_outside", flat_box},
                    Case{"half_turn", long_turn}, Case{"fixed_root", departing},
                    Case{"stale_bounds", departing}, Case{"small_parents", field_play},
                    Case{"drops_on_remove", churn}),
    [](const testing::TestParamInfo<Case>& param) { return param.param.error; });

TEST(FrustumWrong, MistakesThatLeaveOutNothingKeepTooMuch) {
  const Damage all = damage("none", field_play());
  const Damage behind = damage("frustum.wrong[error=behind_all_planes]", field_play());
  EXPECT_EQ(behind.kept, all.kept);
  EXPECT_EQ(behind.false_objects, 0U);

  // The frustum that the thesis measured with: 58.3 degrees instead of 45.
  const Play play{field(41), looks(glm::dvec3(0.0), 45.0)};
  const Damage right = damage("frustum.flat", play);
  const Damage degrees_45 = damage("frustum.wrong[error=degrees]", play);
  const Damage wider = damage("frustum.flat", {field(41), looks(glm::dvec3(0.0), 58.31)});
  EXPECT_EQ(degrees_45.false_objects, 0U);
  EXPECT_GT(degrees_45.kept, right.kept);
  EXPECT_NEAR(static_cast<double>(degrees_45.kept), static_cast<double>(wider.kept), 1.0);
}

TEST(FrustumWrong, SmallMistakesByTheirAmount) {
  const Play play = field_play();
  EXPECT_EQ(damage("frustum.wrong[error=one_eye,amount=0]", play).false_objects, 0U);
  EXPECT_EQ(damage("frustum.wrong[error=small_parents,amount=0]", play).false_objects, 0U);
  EXPECT_GT(damage("frustum.wrong[error=one_eye,amount=3]", play).false_objects,
            damage("frustum.wrong[error=one_eye,amount=0.5]", play).false_objects);
  EXPECT_GT(damage("frustum.wrong[error=small_parents,amount=0.9]", play).false_objects,
            damage("frustum.wrong[error=small_parents,amount=0.3]", play).false_objects);
}

TEST(FrustumWrong, EachVariantSaysWhatIsWrong) {
  Registry registry;
  register_all_cullers(registry);
  std::set<std::string> summaries;
  const CullerInfo& info = registry.entry("frustum.wrong").info;
  for (const std::string& error : info.parameters.front().choices) {
    const auto culler = registry.make("frustum.wrong[error=" + error + "]");
    EXPECT_EQ(culler->info().guarantee, Guarantee::erroneous);
    EXPECT_NE(culler->info().summary.find("Wrong: "), std::string::npos);
    EXPECT_TRUE(summaries.insert(culler->info().summary).second) << error;
  }
  EXPECT_EQ(summaries.size(), 16U);
}

}  // namespace
}  // namespace vislab
