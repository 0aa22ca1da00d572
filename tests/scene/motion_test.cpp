#include "common/scene/paths/motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/scene/generators/generators.h"
#include "tests/input_error.h"
#include "tests/scene/repository_data.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

const std::vector<double> quarters{0.0, 0.25, 0.5, 0.75, 1.0};

Scene box_field(std::uint32_t count) {
  BoxFieldParameters parameters;
  parameters.count = count;
  parameters.extent_m = 30.0;
  Scene scene = make_box_field(parameters);
  scene.finish();
  return scene;
}

glm::dvec3 middle(const Scene& scene, ObjectId id, const glm::dmat4x3& transform) {
  return transform * glm::dvec4(scene.mesh_of(id).bounds.center(), 1.0);
}

glm::dvec3 middle(const Scene& scene, ObjectId id) {
  return middle(scene, id, scene.objects[id].transform);
}

bool same(const std::vector<Changes>& a, const std::vector<Changes>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Changes& x, const Changes& y) {
    return x.moved == y.moved && x.transforms == y.transforms && x.shown == y.shown &&
           x.hidden == y.hidden;
  });
}

/// Every kind, on a scene of 40 boxes.
std::vector<Motion> all_kinds() {
  Motion revolve{RevolveMotion{}, 2.0, 7};
  Motion drift{DriftMotion{0.5, 5.0, 50.0, 1.2}, 2.0, 7};
  Motion churn{ChurnMotion{6}, 2.0, 7};
  Motion depart{DepartMotion{0.3, 2.0}, 2.0, 7};
  return {revolve, drift, churn, depart};
}

TEST(Motion, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const Scene scene = box_field(40);
  for (Motion motion : all_kinds()) {
    const std::vector<Changes> first = changes_of(motion, scene, quarters);
    EXPECT_TRUE(same(first, changes_of(motion, scene, quarters)));
    motion.seed = 8;
    EXPECT_FALSE(same(first, changes_of(motion, scene, quarters)));
  }
}

TEST(Motion, LeavesTheFirstFrameAsBuiltAndCanBePlayedAgainAfterAReset) {
  const Scene scene = box_field(40);
  for (const Motion& motion : all_kinds()) {
    const std::vector<Changes> changes = changes_of(motion, scene, quarters);
    ASSERT_EQ(changes.size(), quarters.size());
    EXPECT_TRUE(changes[0].empty());
    SceneState state(scene);
    std::vector<Aabb> first_round;
    for (int round = 0; round < 2; ++round) {
      state.reset();
      for (const Changes& step : changes) state.apply(step);  // throws for unsorted ids
      const auto bounds = state.view().bounds;
      if (round == 0) first_round.assign(bounds.begin(), bounds.end());
      EXPECT_TRUE(std::equal(bounds.begin(), bounds.end(), first_round.begin()));
    }
  }
}

TEST(Motion, GoesThroughTheSamePlacesHoweverFinelyItIsSampled) {
  const Scene scene = box_field(40);
  for (const Motion& motion : all_kinds()) {
    if (std::holds_alternative<ChurnMotion>(motion.kind)) continue;  // counts frames
    const std::vector<Changes> fine = changes_of(motion, scene, quarters);
    const std::vector<Changes> coarse = changes_of(motion, scene, {0.0, 0.5, 1.0});
    EXPECT_TRUE(same({fine[2], fine[4]}, {coarse[1], coarse[2]}));
  }
}

TEST(Motion, AtNoSpeedNothingIsReported) {
  const Scene scene = box_field(10);
  for (const Changes& step :
       changes_of({DriftMotion{1.0, 0.0, 0.0, 1.0}, 2.0, 1}, scene, quarters)) {
    EXPECT_TRUE(step.empty());
  }
}

TEST(Revolution, KeepsHeightAndDistanceAndGoesAtItsSpeed) {
  const Scene scene = box_field(40);
  const RevolveMotion revolve{{3.0, 0.0, -2.0}, 2.0, 4.0, 90.0};
  constexpr double duration_s = 0.5;
  const std::vector<Changes> changes = changes_of({revolve, duration_s, 1}, scene, {0.0, 1.0});
  ASSERT_EQ(changes[1].moved.size(), 40U);
  std::set<double> speeds;
  for (std::size_t i = 0; i < 40; ++i) {
    const ObjectId id = changes[1].moved[i];
    const glm::dvec3 from = middle(scene, id) - revolve.center;
    const glm::dvec3 to = middle(scene, id, changes[1].transforms[i]) - revolve.center;
    EXPECT_NEAR(to.y, from.y, 1e-9);
    const double distance = std::hypot(from.x, from.z);
    EXPECT_NEAR(std::hypot(to.x, to.z), distance, 1e-9);
    // Counter-clockwise seen from above: from +x towards -z.
    const double angle = std::atan2(from.z * to.x - from.x * to.z, from.x * to.x + from.z * to.z);
    const double speed_m_s = angle * distance / duration_s;
    EXPECT_GE(speed_m_s, 2.0 - 1e-9);
    EXPECT_LE(speed_m_s, 4.0 + 1e-9);
    speeds.insert(speed_m_s);
    // Spinning neither stretches nor mirrors.
    const glm::dmat3 built(scene.objects[id].transform);
    const glm::dmat3 now(changes[1].transforms[i]);
    EXPECT_NEAR(glm::determinant(now), glm::determinant(built), 1e-9);
    EXPECT_NEAR(glm::length(now[0]), glm::length(built[0]), 1e-12);
  }
  EXPECT_GT(speeds.size(), 30U);
}

TEST(Revolution, OfAnObjectOnTheAxisOnlySpins) {
  Scene scene;
  scene.meshes.push_back(cube_mesh());
  scene.objects.push_back({0, box_transform({0.0, 5.0, 0.0}, {1.0, 2.0, 3.0}), none_id});
  scene.finish();
  const std::vector<Changes> changes =
      changes_of({RevolveMotion{{0.0, 0.0, 0.0}, 1.0, 2.0, 90.0}, 1.0, 1}, scene, quarters);
  for (std::size_t i = 1; i < quarters.size(); ++i) {
    ASSERT_EQ(changes[i].moved.size(), 1U);
    EXPECT_LT(glm::distance(middle(scene, 0, changes[i].transforms[0]), glm::dvec3(0.0, 5.0, 0.0)),
              1e-12);
  }
}

TEST(Drift, MovesItsShareOfTheObjectsWithinTheBorders) {
  const Scene scene = box_field(200);
  for (const double share : {0.005, 0.1, 1.0}) {
    const DriftMotion drift{share, 20.0, 400.0, 1.5};
    const std::vector<Changes> changes = changes_of({drift, 2.0, 1}, scene, quarters);
    const auto movers = static_cast<std::size_t>(std::lround(share * 200));
    bool outside_of_scene = false;
    for (std::size_t i = 1; i < quarters.size(); ++i) {
      EXPECT_EQ(changes[i].moved.size(), movers);
      EXPECT_EQ(changes[i].moved, changes[1].moved);
      for (std::size_t j = 0; j < movers; ++j) {
        const glm::dvec3 p = middle(scene, changes[i].moved[j], changes[i].transforms[j]);
        const glm::dvec3 from_center = glm::abs(p - scene.bounds().center());
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_LE(from_center[axis], 1.5 * scene.bounds().half_size()[axis] + 1e-9);
        }
        outside_of_scene = outside_of_scene || !scene.bounds().contains(p);
      }
    }
    EXPECT_TRUE(share < 1.0 || outside_of_scene);
  }
}

TEST(Drift, GoesStraightOnUntilItTurnsBack) {
  const Scene scene = box_field(50);
  const std::vector<Changes> changes =
      changes_of({DriftMotion{1.0, 1.0, 2.0, 100.0}, 1.0, 1}, scene, quarters);
  for (std::size_t j = 0; j < 50; ++j) {
    const glm::dvec3 first = middle(scene, changes[1].moved[j], changes[1].transforms[j]) -
                             middle(scene, changes[1].moved[j]);
    const glm::dvec3 all = middle(scene, changes[4].moved[j], changes[4].transforms[j]) -
                           middle(scene, changes[4].moved[j]);
    EXPECT_LT(glm::distance(4.0 * first, all), 1e-9);
    EXPECT_GE(glm::length(all), 1.0 - 1e-9);
    EXPECT_LE(glm::length(all), 2.0 + 1e-9);
  }
}

TEST(Churn, HidesAsManyAsItShowsAgain) {
  const Scene scene = box_field(20);
  for (const std::uint32_t count : {1U, 7U, 10U}) {
    const std::vector<double> times(30, 0.5);
    const std::vector<Changes> changes = changes_of({ChurnMotion{count}, 2.0, 1}, scene, times);
    SceneState state(scene);
    std::set<ObjectId> ever_hidden;
    for (std::size_t i = 0; i < times.size(); ++i) {
      state.apply(changes[i]);
      EXPECT_EQ(changes[i].hidden.size(), i == 0 ? 0 : count);
      EXPECT_EQ(state.view().shown.size(), i == 0 ? 20 : 20 - count);
      EXPECT_EQ(changes[i].shown, i == 0 ? std::vector<ObjectId>() : changes[i - 1].hidden);
      ever_hidden.insert(changes[i].hidden.begin(), changes[i].hidden.end());
    }
    EXPECT_EQ(ever_hidden.size(), 20U);
  }
}

TEST(Departure, EndsAtItsFactorOfTheCubeAboutTheScene) {
  const Scene scene = box_field(40);
  const glm::dvec3 half = scene.bounds().half_size();
  const double cube = std::max({half.x, half.y, half.z});
  for (const double factor : {0.5, 1.0, 2.0}) {
    const std::vector<Changes> changes =
        changes_of({DepartMotion{0.25, factor}, 2.0, 1}, scene, quarters);
    ASSERT_EQ(changes[4].moved.size(), 10U);
    for (std::size_t j = 0; j < 10; ++j) {
      const glm::dvec3 p = glm::abs(middle(scene, changes[4].moved[j], changes[4].transforms[j]) -
                                    scene.bounds().center());
      EXPECT_NEAR(std::max({p.x, p.y, p.z}), factor * cube, 1e-9 * cube);
    }
    const Aabb reach = reach_of(scene, changes);
    EXPECT_EQ(factor > 1.0, !(reach == scene.bounds()) && reach.half_size().x > 1.5 * half.x);
  }
}

TEST(Motion, RefusesMoreThanMemoryHolds) {
  const Scene scene = box_field(20'001);
  const std::vector<double> times(1000, 0.5);
  const std::string message = input_error([&]() {
    changes_of({RevolveMotion{}, 2.0, 1}, scene, times);
  });
  EXPECT_TRUE(says(message, "20001 objects that move in 1000 frames"));
}

class MovingPaths : public testing::Test {
 protected:
  Path load(const std::string& motion, int frames = 0) {
    const std::string walk =
        "kind = \"walk\"\npoints = [[0, 5, 90], [10, 5, 90]]\nframes = 5\n[motion]\n";
    return load_path(folder_.write("path.toml", walk + motion).string(), scene_, {512, 512}, frames,
                     test::repository_data());
  }
  std::string refused(const std::string& motion) {
    return input_error([&]() { load(motion); });
  }

  TemporaryFolder folder_;
  Scene scene_ = box_field(40);
};

TEST_F(MovingPaths, CarryTheChangesOfTheirTable) {
  const Path path =
      load("kind = \"drift\"\nshare = 0.25\nmin_speed_m_s = 1.0\nmax_speed_m_s = 2.0\n");
  ASSERT_EQ(path.frames.size(), 5U);
  EXPECT_TRUE(path.frames[0].changes.empty());
  for (std::size_t i = 1; i < 5; ++i) EXPECT_EQ(path.frames[i].changes.moved.size(), 10U);
  const std::string still = "kind = \"drift\"\nmin_speed_m_s = 0.0\nmax_speed_m_s = 0.0\n";
  EXPECT_NE(load(still).content_hash(), path.content_hash());
  EXPECT_EQ(load("kind = \"churn\"\ncount = 4\n", 9).frames[8].changes.hidden.size(), 4U);
}

TEST_F(MovingPaths, SeeAllThatMovesBeforeTheFarPlane) {
  const Path path = load("kind = \"depart\"\nfactor = 20.0\n");
  SceneState state(scene_);
  for (const PathFrame& frame : path.frames) {
    state.apply(frame.changes);
    for (const Aabb& box : state.view().bounds) {
      EXPECT_LT(frame.camera.planar_depth(box.center()), frame.camera.lens.far_m);
    }
  }
}

TEST_F(MovingPaths, GoRoundTheMiddleOfTheSceneUnlessACentreIsGiven) {
  const std::string speeds = "kind = \"revolve\"\nmin_speed_m_s = 1.0\nmax_speed_m_s = 2.0\n";
  const glm::dvec3 center = scene_.bounds().center();
  const std::string same_center =
      "center = [" + std::to_string(center.x) + ", 0.0, " + std::to_string(center.z) + "]\n";
  const glm::dmat4x3 a = load(speeds).frames[4].changes.transforms[0];
  const glm::dmat4x3 b = load(speeds + same_center).frames[4].changes.transforms[0];
  const glm::dmat4x3 c = load(speeds + "center = [50, 0, 0]\n").frames[4].changes.transforms[0];
  EXPECT_LT(glm::distance(a[3], b[3]), 1e-4);
  EXPECT_GT(glm::distance(a[3], c[3]), 1e-2);
}

TEST_F(MovingPaths, RefuseTablesThatAreWrong) {
  EXPECT_TRUE(says(refused("kind = \"jump\"\n"), "known: churn, depart, drift, revolve"));
  EXPECT_TRUE(says(refused("kind = \"drift\"\n"), "`min_speed_m_s` is missing"));
  EXPECT_TRUE(says(refused("kind = \"drift\"\nmin_speed_m_s = 3\nmax_speed_m_s = 2\n"),
                   "`max_speed_m_s` is wrong"));
  EXPECT_TRUE(says(refused("kind = \"depart\"\nshare = 0.0\n"), "`share` is wrong"));
  EXPECT_TRUE(says(refused("kind = \"depart\"\nspeed = 1.0\n"), "`speed` is not a key"));
  EXPECT_TRUE(says(refused("kind = \"churn\"\n"), "`count` is missing"));
  EXPECT_TRUE(says(refused("kind = \"churn\"\ncount = 21\n"), "twice as many"));
  EXPECT_TRUE(says(refused("kind = \"churn\"\ncount = 2\nseed = -1\n"), "`seed` is wrong"));
}

TEST(Motion, OneObjectSlidesAtItsVelocityAndTurnsBackAtItsReach) {
  const Scene scene = box_field(3);
  const Motion motion{SlideMotion{1, {3.0, 0.0, 4.0}, 10.0}, 8.0, 1};  // 10 m in a quarter
  const std::vector<Changes> changes = changes_of(motion, scene, quarters);
  const glm::dvec3 built = scene.objects[1].transform[3];
  const double way_m[] = {0.0, 10.0, 0.0, -10.0, 0.0};
  for (std::size_t i = 1; i < quarters.size(); ++i) {
    EXPECT_EQ(changes[i].moved, std::vector<ObjectId>{1});
    const glm::dvec3 moved = changes[i].transforms[0][3] - built;
    EXPECT_NEAR(glm::length(moved - glm::dvec3(0.6, 0.0, 0.8) * way_m[i]), 0.0, 1e-9) << i;
  }
  EXPECT_TRUE(changes[0].empty());
}

TEST(Motion, OneObjectIsHiddenAndShownInTurn) {
  const Scene scene = box_field(3);
  const Motion motion{ToggleMotion{2, 2.0}, 2.0, 1};  // a toggle in each quarter
  const std::vector<Changes> changes = changes_of(motion, scene, quarters);
  EXPECT_TRUE(changes[0].empty());
  for (const std::size_t i : {1, 3}) EXPECT_EQ(changes[i].hidden, std::vector<ObjectId>{2});
  for (const std::size_t i : {2, 4}) EXPECT_EQ(changes[i].shown, std::vector<ObjectId>{2});
  SceneState state(scene);
  for (const Changes& change : changes) state.apply(change);
  EXPECT_EQ(state.view().shown.size(), 3U);
}

TEST(Motion, OnlyWhatIsThereSlidesOrToggles) {
  const Scene scene = box_field(3);
  EXPECT_TRUE(says(input_error([&] {
                     changes_of({SlideMotion{3, {1.0, 0.0, 0.0}, 1.0}, 1.0, 1}, scene, quarters);
                   }),
                   "objects 0 to 2"));
  EXPECT_TRUE(says(input_error([&] {
                     changes_of({ToggleMotion{7, 1.0}, 1.0, 1}, scene, quarters);
                   }),
                   "object 7"));
}

}  // namespace
}  // namespace vislab
