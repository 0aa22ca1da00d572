#include "common/judge/cullable.h"

#include <gtest/gtest.h>

#include "common/scene/generators/generators.h"

namespace vislab {
namespace {

/// Two cubes of 12 triangles; the camera looks at the first along -z, the second is behind it.
struct Stage {
  explicit Stage(const glm::dvec3& first_size = glm::dvec3(1.0)) {
    scene.meshes.push_back(cube_mesh());
    scene.objects.push_back({0, box_transform({0.0, 0.0, 0.0}, first_size), none_id});
    scene.objects.push_back({0, box_transform({0.0, 0.0, 20.0}, glm::dvec3(1.0)), none_id});
    scene.finish();
    state.emplace(scene);
    frame.camera = {look_at({0.0, 0.0, 8.0}, {0.0, 0.0, 0.0}),
                    perspective_lens(1.0, 1.0, 0.1, 50.0)};
    frame.objects = state->view();
  }
  Scene scene;
  std::optional<SceneState> state;
  Frame frame;
};

TEST(CullableTriangles, AllButTheNearFacesOfACubeFaceAway) {
  const Stage stage;
  const CullableTriangles triangles(stage.frame, stage.scene);
  // Of each cube only the side towards the eye is seen from the front.
  EXPECT_EQ(triangles.back_facing({}), (CulledOf{20, 20}));
  EXPECT_EQ(triangles.back_facing(VisibleSet({{0, 24}})), (CulledOf{20, 0}));
  EXPECT_EQ(triangles.back_facing(VisibleSet({{0, 12}})), (CulledOf{20, 10}));
}

TEST(CullableTriangles, MirrorsDoNotTurnTheFacesRound) {
  const Stage stage({-1.0, 1.0, 1.0});
  EXPECT_EQ(CullableTriangles(stage.frame, stage.scene).back_facing({}), (CulledOf{20, 20}));
}

TEST(CullableTriangles, WhatLiesBehindTheEyeIsOutside) {
  const Stage stage;
  const CullableTriangles triangles(stage.frame, stage.scene);
  EXPECT_EQ(triangles.outside({}), (CulledOf{12, 12}));
  EXPECT_EQ(triangles.outside(VisibleSet({{0, 18}})), (CulledOf{12, 6}));
}

TEST(CullableTriangles, ATriangleAcrossTheWholeFrustumIsNotOutside) {
  // Every corner of the long box is outside, but its sides cross the view.
  const Stage stage({100.0, 0.5, 0.5});
  const CulledOf outside = CullableTriangles(stage.frame, stage.scene).outside({});
  EXPECT_EQ(outside.cullable, 12U + 4U) << "only the two ends of the long box";
}

TEST(CullableTriangles, HiddenObjectsDoNotCount) {
  Stage stage;
  Changes changes;
  changes.hidden = {1};
  stage.state->apply(changes);
  stage.frame.objects = stage.state->view();
  EXPECT_EQ(CullableTriangles(stage.frame, stage.scene).outside({}), CulledOf{});
}

}  // namespace
}  // namespace vislab
