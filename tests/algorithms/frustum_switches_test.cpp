// The switches of the frustum test on every culler that has them, among moving objects.
#include <gtest/gtest.h>

#include <limits>

#include "common/geometry/frustum_side.h"
#include "common/geometry/random.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/run_culler.h"

namespace vislab {
namespace {

constexpr std::size_t object_count = 500;

glm::dmat4x3 random_placement(Random& random) {
  const auto number = [&](double low, double high) { return random.uniform(low, high); };
  const glm::dvec3 at(number(-40.0, 40.0), number(-40.0, 40.0), number(-40.0, 40.0));
  return placed(at, {number(0.1, 3.0), number(0.1, 3.0), number(0.1, 3.0)});
}

Scene random_field(Random& random) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  for (std::size_t i = 0; i < object_count; ++i) {
    scene.objects.push_back({0, random_placement(random), none_id});
  }
  scene.finish();
  return scene;
}

struct Step {
  Camera camera;
  Changes changes;
};

/// A camera that turns, nods, moves, stands and does several at once, among objects that move,
/// leave the scene's bounds, disappear and come back, but rest at times.
std::vector<Step> random_path(Random& random) {
  std::vector<Step> path;
  glm::dvec3 eye(0.0);
  double yaw = 0.0;
  double pitch = 0.0;
  Lens lens = perspective_lens(degrees(60.0), 1.3, 0.1, 60.0);
  std::vector<ObjectId> hidden;
  for (int i = 0; i < 120; ++i) {
    switch (i / 10 % 6) {
      case 0:
      case 1:
        yaw += degrees(13.0);
        break;
      case 2:
        pitch += degrees(i % 10 < 5 ? 7.0 : -7.0);
        break;
      case 3:
        eye += glm::dvec3(0.4, 0.1, -0.3);
        break;
      case 4:
        break;
      default:
        yaw -= degrees(3.0);
        eye.x -= 0.5;
    }
    if (i == 60) lens.far_m = std::numeric_limits<double>::infinity();
    if (i == 80) lens = perspective_lens(degrees(100.0), 0.8, 0.1, 50.0);
    const glm::dvec3 way(std::sin(yaw) * std::cos(pitch), std::sin(pitch),
                         -std::cos(yaw) * std::cos(pitch));
    Step step{{look_at(eye, eye + way), lens}, {}};
    if (i % 7 == 3) {
      for (ObjectId object = static_cast<ObjectId>(random.below(40)); object < object_count;
           object += 40) {
        step.changes.moved.push_back(object);
        step.changes.transforms.push_back(random_placement(random));
        if (i % 14 == 3) step.changes.transforms.back()[3] *= 4.0;
      }
      step.changes.shown = hidden;
      hidden.clear();
      for (ObjectId object = static_cast<ObjectId>(random.below(30)); object < object_count;
           object += 30) {
        if (!std::ranges::binary_search(step.changes.shown, object)) hidden.push_back(object);
      }
      step.changes.hidden = hidden;
    }
    path.push_back(step);
  }
  return path;
}

std::vector<std::string> cullers_with_switches() {
  Registry registry;
  register_all_cullers(registry);
  std::vector<std::string> names;
  for (const auto& [name, entry] : registry.entries()) {
    if (std::ranges::find(entry.info.parameters, "octant", &ParameterSpec::name) !=
        entry.info.parameters.end()) {
      names.push_back(name);
    }
  }
  return names;
}

class EverySwitch : public testing::TestWithParam<std::string> {};

TEST_P(EverySwitch, NeverLosesAnObjectThatTheExactTestKeeps) {
  Random random(51);
  const Scene scene = random_field(random);
  const std::vector<Step> path = random_path(random);
  for (const char* switches :
       {"plane_coherence=true", "motion_coherence=true", "octant=true", "meta=sphere", "meta=box",
        "plane_coherence=true,motion_coherence=true,octant=true,meta=box"}) {
    const std::string spec = GetParam() + "[" + switches + "]";
    CullerRun plain(GetParam(), scene);
    CullerRun run(spec, scene);
    const bool same =
        spec.find("motion") == std::string::npos && spec.find("meta") == std::string::npos;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const auto& [camera, changes] = path[i];
      plain.update(camera, changes);
      run.update(camera, changes);
      std::vector<ObjectId> expected = plain.objects(camera);
      std::vector<ObjectId> kept = run.objects(camera);
      std::ranges::sort(expected);
      std::ranges::sort(kept);
      if (same) {
        ASSERT_EQ(kept, expected) << spec << ", step " << i;
        continue;
      }
      ASSERT_TRUE(std::ranges::includes(expected, kept)) << spec << ", step " << i;
      const ExactFrustum exact(camera);
      for (const ObjectId object : expected) {
        if (exact.side(run.frame(camera).objects.bounds[object]) == Side::outside) continue;
        ASSERT_TRUE(std::ranges::binary_search(kept, object))
            << spec << ", step " << i << ", object " << object;
      }
    }
    // It does save plane tests.
    EXPECT_LT(run.counter("plane_tests"), plain.counter("plane_tests")) << spec;
  }
}

INSTANTIATE_TEST_SUITE_P(Frustum, EverySwitch, testing::ValuesIn(cullers_with_switches()),
                         [](const testing::TestParamInfo<std::string>& param) {
                           return param.param.substr(param.param.find('.') + 1);
                         });

}  // namespace
}  // namespace vislab
