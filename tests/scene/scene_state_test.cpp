#include <gtest/gtest.h>

#include "common/scene/frame.h"
#include "common/scene/generators/generators.h"
#include "common/scene/path.h"
#include "tests/input_error.h"

namespace vislab {
namespace {

class SceneStateTest : public testing::Test {
 protected:
  void SetUp() override {
    scene_.meshes.push_back(cube_mesh());
    for (int i = 0; i < 4; ++i) {
      scene_.objects.push_back({0, box_transform({10.0 * i, 0.0, 0.0}, glm::dvec3(1.0)), none_id});
    }
    scene_.finish();
  }
  static std::vector<ObjectId> shown(const SceneState& state) {
    const auto ids = state.view().shown;
    return {ids.begin(), ids.end()};
  }
  std::string refused(SceneState& state, const Changes& changes) {
    return input_error([&]() { state.apply(changes); });
  }

  Scene scene_;
};

TEST_F(SceneStateTest, ShowsEverythingAsBuiltAtFirst) {
  const SceneState state(scene_);
  EXPECT_EQ(shown(state), (std::vector<ObjectId>{0, 1, 2, 3}));
  EXPECT_EQ(state.view().transforms[2], scene_.objects[2].transform);
  EXPECT_TRUE(state.view().bounds[2].contains({21.0, 1.0, -1.0}));
}

TEST_F(SceneStateTest, MovesAnObjectWithItsBox) {
  SceneState state(scene_);
  Changes changes;
  changes.moved = {1};
  changes.transforms = {box_transform({0.0, 50.0, 0.0}, glm::dvec3(2.0))};
  state.apply(changes);
  EXPECT_EQ(state.view().transforms[1], changes.transforms[0]);
  EXPECT_TRUE(state.view().bounds[1].contains({2.0, 52.0, 2.0}));
  EXPECT_FALSE(state.view().bounds[1].contains({10.0, 0.0, 0.0}));
}

TEST_F(SceneStateTest, HidesAndShowsInTheOrderOfIds) {
  SceneState state(scene_);
  Changes hide;
  hide.hidden = {0, 2};
  state.apply(hide);
  EXPECT_EQ(shown(state), (std::vector<ObjectId>{1, 3}));
  Changes show;
  show.shown = {2};
  state.apply(show);
  EXPECT_EQ(shown(state), (std::vector<ObjectId>{1, 2, 3}));
}

TEST_F(SceneStateTest, ResetBringsTheSceneAsBuiltBack) {
  SceneState state(scene_);
  Changes changes;
  changes.moved = {3};
  changes.transforms = {glm::dmat4x3(1.0)};
  changes.hidden = {0};
  state.apply(changes);
  state.reset();
  EXPECT_EQ(shown(state), (std::vector<ObjectId>{0, 1, 2, 3}));
  EXPECT_EQ(state.view().transforms[3], scene_.objects[3].transform);
  EXPECT_EQ(state.view().bounds[3], SceneState(scene_).view().bounds[3]);
}

TEST_F(SceneStateTest, RefusesWrongChangesAndStaysAsItWas) {
  SceneState state(scene_);
  Changes twice;
  twice.shown = {1};
  EXPECT_TRUE(says(refused(state, twice), "object 1 is shown already"));
  Changes range;
  range.hidden = {4};
  EXPECT_TRUE(says(refused(state, range), "object 4 is out of range"));
  Changes order;
  order.hidden = {2, 1};
  EXPECT_TRUE(says(refused(state, order), "ascending"));
  Changes count;
  count.moved = {1};
  EXPECT_TRUE(says(refused(state, count), "0 transforms"));
  Changes singular;
  singular.hidden = {0};
  singular.moved = {1};
  singular.transforms = {glm::dmat4x3(0.0)};
  EXPECT_TRUE(says(refused(state, singular), "singular"));
  EXPECT_EQ(shown(state), (std::vector<ObjectId>{0, 1, 2, 3}));

  Changes hide;
  hide.hidden = {1};
  state.apply(hide);
  EXPECT_TRUE(says(refused(state, hide), "object 1 is hidden already"));
}

TEST(PathHash, CountsCamerasAndChanges) {
  Path path;
  path.frames.resize(2);
  const std::string plain = path.content_hash();
  path.name = "another";
  EXPECT_EQ(path.content_hash(), plain);
  path.frames[1].changes.hidden = {0};
  const std::string hiding = path.content_hash();
  EXPECT_NE(hiding, plain);
  path.frames[1].changes.hidden.clear();
  path.frames[1].changes.shown = {0};
  EXPECT_NE(path.content_hash(), hiding);
  path.frames[1].changes.shown.clear();
  path.frames[0].camera.lens.far_m *= 2.0;
  EXPECT_NE(path.content_hash(), plain);
}

}  // namespace
}  // namespace vislab
