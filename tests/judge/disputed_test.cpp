#include "common/judge/disputed.h"

#include <gtest/gtest.h>

#include "tests/judge/judge_scenes.h"

namespace vislab {
namespace {

constexpr Viewport viewport{100, 100};

/// A camera at the origin that looks along -z; at depth 1 the image is 2 m wide, so that a pixel is
/// 0.02 m.
Camera square_camera(double near_m = 0.1, double far_m = 100.0) {
  return {Pose{}, {Projection::perspective, -near_m, near_m, -near_m, near_m, near_m, far_m}};
}

/// Triangle with corners at window positions, at one depth each.
void add_window_triangle(Scene& scene, const std::array<glm::vec2, 3>& window_px,
                         const std::array<float, 3>& depth) {
  std::array<glm::vec3, 3> corner;
  for (int i = 0; i < 3; ++i) {
    corner[i] = glm::vec3((window_px[i] - 50.0F) * 0.02F * depth[i], -depth[i]);
  }
  add_triangle(scene, corner[0], corner[1], corner[2]);
}

TEST(WindowTriangle, lies_where_its_corners_are_projected_to) {
  Scene scene;
  add_window_triangle(scene, {{{10, 20}, {70, 20}, {10, 80}}}, {2.0F, 3.0F, 5.0F});
  Stage stage(std::move(scene), square_camera(), viewport);
  const WindowTriangle triangle = window_triangle(stage.frame, stage.scene, 0);
  EXPECT_NEAR(triangle.edge_distance({30.0, 25.0}), 5.0, 1e-4);
  EXPECT_NEAR(triangle.edge_distance({4.0, 50.0}), 6.0, 1e-4);
  EXPECT_NEAR(triangle.edge_distance({7.0, 16.0}), 5.0, 1e-4) << "the corner is nearest";
  EXPECT_TRUE(triangle.contains({30.0, 25.0}));
  EXPECT_FALSE(triangle.contains({4.0, 50.0}));
  EXPECT_NEAR(triangle.depth({10.0, 20.0}), 2.0, 1e-5);
  EXPECT_NEAR(triangle.depth({70.0, 20.0}), 3.0, 1e-5);
  EXPECT_NEAR(triangle.depth({10.0, 80.0}), 5.0, 1e-5);
  EXPECT_NEAR(glm::length(triangle.min() - glm::dvec2(10, 20)), 0.0, 1e-4);
  EXPECT_NEAR(glm::length(triangle.max() - glm::dvec2(70, 80)), 0.0, 1e-4);
}

TEST(WindowTriangle, is_cut_at_the_near_plane_and_the_far_plane) {
  // A floor 1 m under the eye, from behind it to the horizon.
  Scene scene;
  add_triangle(scene, {-500, -1, 500}, {500, -1, 500}, {0, -1, -500});
  Stage stage(std::move(scene), square_camera(0.5, 10.0), viewport);
  const WindowTriangle floor = window_triangle(stage.frame, stage.scene, 0);
  ASSERT_FALSE(floor.empty());
  // The near plane cuts it below the image, the far plane at 1 m / 10 m under the middle: 5 pixels.
  EXPECT_NEAR(floor.max().y, 45.0, 1e-6);
  EXPECT_NEAR(floor.min().y, 50.0 - 100.0, 1e-6);
  EXPECT_NEAR(floor.edge_distance({50.0, 40.0}), 5.0, 1e-6);
  EXPECT_TRUE(floor.contains({50.0, 40.0}));
  EXPECT_FALSE(floor.contains({50.0, 46.0}));
  EXPECT_NEAR(floor.depth({50.0, 40.0}), 5.0, 1e-9);
}

TEST(WindowTriangle, behind_the_eye_is_empty) {
  Scene scene;
  add_triangle(scene, {-1, -1, 1}, {1, -1, 1}, {0, 1, 1});
  Stage stage(std::move(scene), square_camera(), viewport);
  const WindowTriangle triangle = window_triangle(stage.frame, stage.scene, 0);
  EXPECT_TRUE(triangle.empty());
  EXPECT_FALSE(triangle.contains({50.0, 50.0}));
  EXPECT_FALSE(is_disputed(stage.frame, stage.scene, {50.0, 50.0}, 0, none_id));
}

TEST(Disputed, is_a_sample_within_a_128th_pixel_of_an_edge_of_either_triangle) {
  Scene scene;
  add_window_triangle(scene, {{{10, 10}, {90, 10}, {10, 90}}}, {2.0F, 2.0F, 2.0F});
  add_window_triangle(scene, {{{30, 5}, {95, 5}, {30, 95}}}, {4.0F, 4.0F, 4.0F});
  Stage stage(std::move(scene), square_camera(), viewport);
  const auto disputed = [&](double x, double y, TriangleId a, TriangleId b) {
    const bool answer = is_disputed(stage.frame, stage.scene, {x, y}, a, b);
    EXPECT_EQ(answer, is_disputed(stage.frame, stage.scene, {x, y}, b, a)) << "order matters";
    return answer;
  };
  EXPECT_FALSE(disputed(40.0, 30.0, 0, 1));
  EXPECT_TRUE(disputed(40.0, 10.0 + 0.9 / 128, 0, 1));
  EXPECT_TRUE(disputed(40.0, 10.0 - 0.9 / 128, 0, 1));
  EXPECT_FALSE(disputed(40.0, 10.0 + 1.1 / 128, 0, 1));
  EXPECT_TRUE(disputed(30.0 - 0.9 / 128, 40.0, 0, 1)) << "the other triangle's edge";
  EXPECT_FALSE(disputed(30.0 - 0.9 / 128, 40.0, 0, none_id));
  EXPECT_TRUE(disputed(40.0, 10.0 - 0.9 / 128, 0, none_id));
  EXPECT_FALSE(disputed(40.0, 10.0, none_id, none_id));
}

TEST(Disputed, is_a_sample_where_two_triangles_have_the_same_depth) {
  Scene scene;
  const std::array<glm::vec2, 3> large = {{{5, 5}, {95, 5}, {5, 95}}};
  const std::array<glm::vec2, 3> small = {{{10, 10}, {40, 10}, {10, 40}}};
  add_window_triangle(scene, large, {2.0F, 2.0F, 2.0F});
  add_window_triangle(scene, small, {2.0001F, 2.0001F, 2.0001F});
  add_window_triangle(scene, small, {2.001F, 2.001F, 2.001F});
  Stage stage(std::move(scene), square_camera(), viewport);
  EXPECT_TRUE(is_disputed(stage.frame, stage.scene, {15.0, 15.0}, 0, 1));
  EXPECT_FALSE(is_disputed(stage.frame, stage.scene, {15.0, 15.0}, 0, 2));
  EXPECT_FALSE(is_disputed(stage.frame, stage.scene, {45.0, 15.0}, 0, 1))
      << "only one of them is there";
}

TEST(Disputed, with_a_device_is_what_its_depth_buffer_cannot_tell) {
  // At 4,000 near distances two steps are 0.19 m, and 1e-4 of the depth 0.04 m.
  Scene scene;
  const std::array<glm::vec2, 3> large = {{{5, 5}, {95, 5}, {5, 95}}};
  for (const float depth : {400.0F, 400.02F, 400.22F, 400.25F}) {
    add_window_triangle(scene, large, {depth, depth, depth});
  }
  Stage stage(std::move(scene), square_camera(0.1, 1000.0), viewport);
  EXPECT_NEAR(depth_step_m(stage.frame.camera.lens, 400.0), 0.0954, 1e-4);
  const glm::dvec2 pixel(25.5, 25.5);
  Disputes rays(stage.frame, stage.scene);
  Disputes device(stage.frame, stage.scene, DepthSteps::device);
  EXPECT_TRUE(rays(pixel, 0, 1));
  EXPECT_FALSE(rays(pixel, 0, 2));
  EXPECT_TRUE(device(pixel, 0, 2));
  EXPECT_FALSE(device(pixel, 0, 3));
  const Lens orthographic = orthographic_lens(2.0, 1.0, 1.0, 1.0 + 0x1p24);
  EXPECT_EQ(depth_step_m(orthographic, 5.0), 1.0) << "the same everywhere";
}

TEST(Disputed, knows_the_edge_that_the_near_plane_cuts) {
  // A floor that begins behind the eye, and one that begins before it but nearer than the near
  // plane.
  for (const float begin : {500.0F, -0.5F}) {
    Scene scene;
    add_triangle(scene, {-500, -1, begin}, {500, -1, begin}, {0, -1, -500});
    // The near plane at 2 m cuts the floor 25 pixels under the middle.
    Stage stage(std::move(scene), square_camera(2.0, 1000.0), viewport);
    EXPECT_TRUE(is_disputed(stage.frame, stage.scene, {50.0, 25.0 + 0.9 / 128}, 0, none_id));
    EXPECT_TRUE(is_disputed(stage.frame, stage.scene, {50.0, 25.0 - 0.9 / 128}, 0, none_id));
    EXPECT_FALSE(is_disputed(stage.frame, stage.scene, {50.0, 25.0 + 1.1 / 128}, 0, none_id));
    EXPECT_FALSE(window_triangle(stage.frame, stage.scene, 0).contains({50.0, 24.0}));
  }
}

}  // namespace
}  // namespace vislab
