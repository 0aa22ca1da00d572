#include "tests/geometry/exact_facing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/scene/generators/generators.h"

namespace vislab::test {
namespace {

Scene objects(Mesh mesh, const std::vector<glm::dmat4x3>& transforms) {
  Scene scene;
  scene.meshes = {std::move(mesh)};
  for (const glm::dmat4x3& transform : transforms) scene.objects.push_back({0, transform, none_id});
  scene.finish();
  return scene;
}

std::vector<Facing> facings(const Scene& scene, const Camera& camera) {
  const SceneState state(scene);
  return exact_facings(scene, {0, camera, Viewport{}, state.view(), 0.0});
}

Camera from(const glm::dvec3& eye) {
  Camera camera;
  camera.pose = look_at(eye, eye + glm::dvec3(0.0, 0.0, -1.0));
  return camera;
}

constexpr Facing back = Facing::back;
constexpr Facing edge_on = Facing::edge_on;
constexpr Facing front = Facing::front;

/// Seen from +z.
Mesh one_triangle() {
  Mesh mesh;
  mesh.positions = {{0.0F, 0.0F, 0.0F}, {3.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

TEST(ExactFacing, TellsTheSidesOfACubeApart) {
  const Scene scene = objects(cube_mesh(), {glm::dmat4x3(1.0)});
  // Sides: -x, +x, -y, +y, -z, +z, two triangles each.
  EXPECT_EQ(facings(scene, from({1.0, 0.5, 7.0})),
            (std::vector<Facing>{back, back, edge_on, edge_on, back, back, back, back, back, back,
                                 front, front}));
  Camera orthographic = from({50.0, 50.0, 7.0});
  orthographic.lens = orthographic_lens(5.0, 1.0, 0.1, 100.0);
  EXPECT_EQ(facings(scene, orthographic),
            (std::vector<Facing>{edge_on, edge_on, edge_on, edge_on, edge_on, edge_on, edge_on,
                                 edge_on, back, back, front, front}));
}

TEST(ExactFacing, TellsOneStepOfADoubleFromThePlane) {
  const Scene scene = objects(one_triangle(), {glm::dmat4x3(1.0)});
  const double least = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(facings(scene, from({700.0, -3.0, 0.0}))[0], edge_on);
  EXPECT_EQ(facings(scene, from({700.0, -3.0, least}))[0], front);
  EXPECT_EQ(facings(scene, from({700.0, -3.0, -least}))[0], back);
}

TEST(ExactFacing, FollowsMirrorsAndShearsFarFromTheOrigin) {
  glm::dmat4x3 sheared(1.0);
  sheared[0] = {1.0, 0.0, 3.0};  // x goes up along z: the plane is z = 3 x
  sheared[3] = {1e6, -1e6, 1e6};
  glm::dmat4x3 mirrored = sheared;
  mirrored[1] = -mirrored[1];  // the outside stays above
  const Scene scene = objects(one_triangle(), {sheared, mirrored});
  const auto at = [&](double x, double z) {
    return facings(scene, from(glm::dvec3(1e6, -1e6, 1e6) + glm::dvec3(x, 0.0, z)));
  };
  EXPECT_EQ(at(0.5, 1.5), (std::vector<Facing>{edge_on, edge_on}));
  EXPECT_EQ(at(0.5, 1.5 + 1e-9), (std::vector<Facing>{front, front}));
  EXPECT_EQ(at(0.5, 1.5 - 1e-9), (std::vector<Facing>{back, back}));
}

TEST(ExactFacing, SeesTrianglesWithoutAreaEdgeOn) {
  Mesh mesh = one_triangle();
  mesh.positions[2] = {6.0F, 0.0F, 0.0F};
  mesh.triangles.push_back({0, 0, 1});
  const Scene scene = objects(mesh, {glm::dmat4x3(1.0)});
  EXPECT_EQ(facings(scene, from({1.0, 2.0, 3.0})), (std::vector<Facing>{edge_on, edge_on}));
}

TEST(ExactFacing, CountsWhatIsLeftOutOfTheShownObjects) {
  const Scene scene = objects(cube_mesh(), {glm::dmat4x3(1.0), glm::dmat4x3(1.0)});
  SceneState state(scene);
  Changes hide;
  hide.hidden = {1};
  state.apply(hide);
  const Frame frame{0, from({1.0, 0.5, 7.0}), Viewport{}, state.view(), 0.0};
  const std::vector<Facing> seen = exact_facings(scene, frame);
  const std::vector<TriangleRange> kept{{0, 0, 1}, {0, 2, 1}, {0, 10, 1}, {0, 10, 1}};
  const FacingCounts counts = count_facings(scene, frame, seen, kept);
  EXPECT_EQ(counts.back, 8U);
  EXPECT_EQ(counts.back_left_out, 7U);
  EXPECT_EQ(counts.front_left_out, 1U);
  EXPECT_EQ(counts.edge_on_left_out, 1U);
  EXPECT_EQ(counts.twice, 1U);
  EXPECT_FALSE(counts.all_right());
  EXPECT_DOUBLE_EQ(counts.recall(), 7.0 / 8.0);
  const std::vector<TriangleRange> right{{0, 2, 2}, {0, 10, 2}};
  EXPECT_TRUE(count_facings(scene, frame, seen, right).all_right());
}

}  // namespace
}  // namespace vislab::test
