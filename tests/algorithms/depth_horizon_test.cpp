// The occlusion horizon: its columns, the rectangles that objects cover, and the culler on cities.
#include "algorithms/depth/horizon_columns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "algorithms/depth/convex_parts.h"
#include "algorithms/depth/covered_hull.h"
#include "common/geometry/random.h"
#include "common/raster/depth_raster.h"
#include "common/scene/generators/generators.h"
#include "experiments/contract/small_scenes.h"
#include "tests/algorithms/depth_damage.h"

namespace vislab {
namespace {

using namespace depth_culling;

#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
constexpr int trials = 100;
#else
constexpr int trials = 2000;
#endif

BoxWindow random_rectangle(Random& random, const Viewport& size) {
  BoxWindow r;
  r.x0 = static_cast<int>(random.below(static_cast<std::uint32_t>(size.width)));
  r.y0 = static_cast<int>(random.below(static_cast<std::uint32_t>(size.height)));
  r.x1 = r.x0 + 1 + static_cast<int>(random.below(static_cast<std::uint32_t>(size.width - r.x0)));
  r.y1 = r.y0 + 1 + static_cast<int>(random.below(static_cast<std::uint32_t>(size.height - r.y0)));
  return r;
}

TEST(HorizonColumns, HideOnlyWhatRectanglesCover) {
  constexpr Viewport size{71, 23};
  Random random(3);
  std::uint64_t hidden = 0;
  for (int trial = 0; trial < trials / 10; ++trial) {
    HorizonColumns horizon(Ground::covered);
    horizon.begin(size);
    std::vector<bool> covered(static_cast<std::size_t>(size.width * size.height));
    const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * size.width + x); };
    for (int i = 0; i < 12; ++i) {
      const BoxWindow added = random_rectangle(random, size);
      horizon.add(added);
      EXPECT_EQ(i > 0 || horizon.hides(added), true);
      for (int y = added.y0; y < added.y1; ++y) {
        for (int x = added.x0; x < added.x1; ++x) covered[at(x, y)] = true;
      }
      const BoxWindow asked = random_rectangle(random, size);
      if (!horizon.hides(asked)) continue;
      ++hidden;
      for (int y = asked.y0; y < asked.y1; ++y) {
        for (int x = asked.x0; x < asked.x1; ++x) ASSERT_TRUE(covered[at(x, y)]);
      }
    }
  }
  EXPECT_GT(hidden, static_cast<std::uint64_t>(trials / 40));
}

TEST(HorizonColumns, JoinWhatTouchesAndKeepTheTallerOfWhatDoesNot) {
  HorizonColumns horizon(Ground::covered);
  horizon.begin({4, 100});
  horizon.add({0, 10, 4, 20, 0.0F});
  horizon.add({0, 20, 2, 30, 0.0F});
  EXPECT_TRUE(horizon.hides({0, 10, 2, 30, 0.0F}));
  EXPECT_FALSE(horizon.hides({0, 10, 3, 30, 0.0F}));
  EXPECT_FALSE(horizon.hides({0, 9, 1, 30, 0.0F}));
  horizon.add({0, 50, 4, 65, 0.0F});  // shorter than in the first columns, taller than in the last
  EXPECT_TRUE(horizon.hides({0, 10, 2, 30, 0.0F}));
  EXPECT_TRUE(horizon.hides({2, 50, 4, 65, 0.0F}));
  EXPECT_FALSE(horizon.hides({2, 10, 4, 20, 0.0F}));
}

TEST(HorizonColumns, HideEverythingBelowIfTheGroundIsAssumed) {
  HorizonColumns horizon(Ground::assumed);
  horizon.begin({4, 100});
  horizon.add({1, 40, 3, 60, 0.0F});
  EXPECT_TRUE(horizon.hides({1, 0, 3, 60, 0.0F}));
  EXPECT_FALSE(horizon.hides({1, 0, 3, 61, 0.0F}));
  EXPECT_FALSE(horizon.hides({0, 0, 3, 10, 0.0F}));
}

TEST(CoveredHull, FindsAllOfARectangle) {
  std::array<glm::dvec2, 4> points{glm::dvec2(3.0, 4.0), {20.0, 4.0}, {20.0, 9.0}, {3.0, 9.0}};
  BoxWindow found;
  ASSERT_TRUE(largest_covered(points, {64, 64}, found));
  EXPECT_EQ(found, (BoxWindow{3, 4, 20, 9, 0.0F}));
  ASSERT_TRUE(largest_covered(points, {10, 6}, found));  // the image ends before it does
  EXPECT_EQ(found, (BoxWindow{3, 4, 10, 6, 0.0F}));
  EXPECT_FALSE(largest_covered(points, {3, 64}, found));
}

TEST(CoveredHull, FindsNothingInWhatHasNoArea) {
  std::array<glm::dvec2, 3> line{glm::dvec2(1.0, 1.0), {5.0, 5.0}, {9.0, 9.0}};
  std::array<glm::dvec2, 3> upright{glm::dvec2(1.5, 1.0), {1.5, 5.0}, {1.5, 9.0}};
  std::array<glm::dvec2, 2> two{glm::dvec2(1.0, 1.0), {5.0, 5.0}};
  BoxWindow found;
  EXPECT_FALSE(largest_covered(line, {64, 64}, found));
  EXPECT_FALSE(largest_covered(upright, {64, 64}, found));
  EXPECT_FALSE(largest_covered(two, {64, 64}, found));
  EXPECT_FALSE(largest_covered({}, {64, 64}, found));
}

/// How far the point lies inside of the points' convex hull, by the half-planes of all pairs that
/// have every point on one side.
double depth_in_hull(std::span<const glm::dvec2> points, const glm::dvec2& at) {
  double least = INFINITY;
  for (const glm::dvec2& a : points) {
    for (const glm::dvec2& b : points) {
      if (a == b) continue;
      const glm::dvec2 inward = glm::normalize(glm::dvec2(a.y - b.y, b.x - a.x));
      const bool is_side = std::ranges::all_of(
          points, [&](const glm::dvec2& p) { return glm::dot(inward, p - a) >= -1e-9; });
      if (is_side) least = std::min(least, glm::dot(inward, at - a));
    }
  }
  return least;
}

TEST(CoveredHull, KeepsPixelCentresADeviceMarginInside) {
  Random random(7);
  constexpr Viewport size{40, 30};
  int found = 0, close = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<glm::dvec2> points(3 + random.below(8));
    for (glm::dvec2& p : points) {
      p = {random.uniform(-5.0, 45.0), random.uniform(-5.0, 35.0)};
      // Edges along rows and columns, about as far from their centres as the margin is wide.
      if (trial % 3 == 0) p = glm::floor(p) + random.uniform(0.45, 0.55);
    }
    const std::vector<glm::dvec2> all = points;
    BoxWindow r;
    if (!largest_covered(points, size, r)) continue;
    ++found;
    ASSERT_TRUE(r.x0 >= 0 && r.y0 >= 0 && r.x1 <= size.width && r.y1 <= size.height);
    double least = INFINITY;  // the corners' are the least of all centres'
    for (const int x : {r.x0, r.x1 - 1}) {
      for (const int y : {r.y0, r.y1 - 1}) {
        least = std::min(least, depth_in_hull(all, {x + 0.5, y + 0.5}));
      }
    }
    ASSERT_GE(least, 1.0 / 32.0 - 1e-9) << "trial " << trial;
    close += least < 2.0 / 32.0 ? 1 : 0;
  }
  EXPECT_GT(found, trials / 4);
  EXPECT_GT(close, trials / 40);
}

/// Two cubes and a third one without its first face.
Mesh three_cubes() {
  Mesh mesh;
  const Mesh cube = cube_mesh();
  for (const float x : {0.0F, 5.0F, 20.0F}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::vec3& p : cube.positions) mesh.positions.push_back(p + glm::vec3(x, 0, 0));
    for (const glm::uvec3& t : cube.triangles) {
      if (x < 20.0F || &t >= cube.triangles.data() + 2) mesh.triangles.push_back(t + first);
    }
  }
  return mesh;
}

TEST(ConvexParts, AreThoseThatAreClosedAndConvex) {
  const std::vector<ConvexPart> cube = convex_parts(cube_mesh());
  ASSERT_EQ(cube.size(), 1U);
  EXPECT_EQ(cube[0].points.size(), 8U);
  EXPECT_EQ(cube[0].planes.size(), 6U);
  EXPECT_EQ(convex_parts(three_cubes()).size(), 2U);
  const std::vector<ConvexPart> sphere = convex_parts(sphere_mesh(8));
  ASSERT_EQ(sphere.size(), 1U);
  EXPECT_FALSE(sphere[0].all_points);

  Mesh dented = cube_mesh();
  for (glm::vec3& p : dented.positions) {
    if (p == glm::vec3(1.0F)) p = glm::vec3(-0.5F);
  }
  EXPECT_TRUE(convex_parts(dented).empty());
  Mesh inward = cube_mesh();
  for (glm::uvec3& t : inward.triangles) std::swap(t.x, t.y);
  EXPECT_TRUE(convex_parts(inward).empty());
}

TEST(ConvexParts, CoverTheirRectanglesAtLeastAsNearAsTheySay) {
  const std::array meshes{cube_mesh(), sphere_mesh(4), sphere_mesh(8), sphere_mesh(12)};
  Random random(5);
  constexpr Viewport size{61, 47};
  int found = 0, cut = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Mesh& mesh = meshes[static_cast<std::size_t>(trial) % meshes.size()];
    const auto vector = [&](double r) {
      return glm::dvec3(random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r));
    };
    glm::dmat4x3 transform{vector(2.0), vector(2.0), vector(2.0), vector(6.0)};
    if (trial % 2 == 0) {
      transform = placed(vector(6.0), glm::abs(vector(4.0)) + 0.1);
    }
    Camera camera{look_at(vector(6.0), {0.0, 0.0, 0.0}),
                  perspective_lens(degrees(70.0), size.aspect(), 0.1, 50.0)};
    if (trial % 5 == 0) camera.lens = orthographic_lens(8.0, size.aspect(), 0.1, 50.0);
    const WindowTransform window(camera, size);
    BoxWindow rectangle;
    if (!covered_rectangle(window, transform, convex_parts(mesh).front(), rectangle)) continue;
    ++found;
    DepthRaster raster(size, RasterOptions{});
    raster.begin(camera);
    const RasterMesh drawn(mesh);
    raster.draw(std::array{RasterDraw{
        &drawn, &transform, 0, static_cast<std::uint32_t>(mesh.triangles.size()), 0, false}});
    Aabb box;
    for (const glm::vec3& p : mesh.positions) box.extend(p);
    BoxWindow around;
    if (project_box(window, transformed(box, transform), Coverage::centres, around) ==
        BoxPlace::undecided) {
      ++cut;
    }
    for (int y = rectangle.y0; y < rectangle.y1; ++y) {
      for (int x = rectangle.x0; x < rectangle.x1; ++x) {
        ASSERT_GE(raster.nearness(x, y), rectangle.nearness)
            << "trial " << trial << ", pixel " << x << ", " << y;
      }
    }
  }
  EXPECT_GT(found, trials / 4);
  EXPECT_GT(cut, trials / 100);
}

/// The nearness of the mesh's first surface at a window position, by all of its triangles' planes
/// and edges in double; -infinity if there is none.
double exact_nearness(const WindowTransform& window, const glm::dmat4x3& transform,
                      const Mesh& mesh, const glm::dvec2& px) {
  const Viewport& size = window.viewport();
  const Ray ray = window.camera().ray({px.x / size.width, px.y / size.height});
  double nearest = -INFINITY;
  for (const glm::uvec3& t : mesh.triangles) {
    std::array<glm::dvec3, 3> corners;
    for (int i = 0; i < 3; ++i) {
      corners[static_cast<std::size_t>(i)] =
          transform * glm::dvec4(glm::dvec3(mesh.positions[t[i]]), 1.0) - ray.origin;
    }
    const auto& [a, b, c] = corners;
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double approach = glm::dot(normal, ray.direction);
    const glm::dvec3 at = ray.direction * (glm::dot(normal, a) / approach);
    const double slack = -1e-9 * glm::dot(normal, normal);
    if (glm::dot(glm::cross(b - a, at - a), normal) < slack ||
        glm::dot(glm::cross(c - b, at - b), normal) < slack ||
        glm::dot(glm::cross(a - c, at - c), normal) < slack) {
      continue;
    }
    const double depth = window.world()(ray.origin + at).depth;
    if (depth > window.camera().lens.near_m) nearest = std::max(nearest, window.nearness(depth));
  }
  return nearest;
}

TEST(ConvexParts, StayBelowTheExactNearnessByADevicesMargin) {
  const std::array meshes{cube_mesh(), sphere_mesh(4)};
  Random random(11);
  constexpr Viewport size{61, 47};
  int found = 0, close = 0;
  for (int trial = 0; trial < trials / 4; ++trial) {
    const Mesh& mesh = meshes[static_cast<std::size_t>(trial) % meshes.size()];
    const auto vector = [&](double r) {
      return glm::dvec3(random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r));
    };
    // Faces towards the eye, along which the nearness is the same, and walls that run away from it.
    const bool upright = trial % 4 < 2;
    const glm::dmat4x3 transform = placed({0.0, 0.0, 0.0}, glm::abs(vector(3.0)) + 0.2);
    const glm::dvec3 eye = upright ? glm::dvec3(0.0, 0.0, 9.0) : vector(4.0) + glm::dvec3(6.0);
    Camera camera{look_at(eye, {0.0, 0.0, 0.0}),
                  perspective_lens(degrees(70.0), size.aspect(), 0.1, 50.0)};
    if (trial % 5 == 0) camera.lens = orthographic_lens(8.0, size.aspect(), 0.1, 50.0);
    const WindowTransform window(camera, size);
    BoxWindow r;
    if (!covered_rectangle(window, transform, convex_parts(mesh).front(), r)) continue;
    ++found;
    double least = INFINITY;
    // A device's snapping moves surfaces by less than 1/64 pixel.
    for (const int x : {r.x0, r.x1 - 1}) {
      for (const int y : {r.y0, r.y1 - 1}) {
        for (int corner = 0; corner < 4; ++corner) {
          const double across = (corner & 1) != 0 ? 0.5 + 1.0 / 64.0 : 0.5 - 1.0 / 64.0;
          const double up = (corner & 2) != 0 ? 0.5 + 1.0 / 64.0 : 0.5 - 1.0 / 64.0;
          least = std::min(least, exact_nearness(window, transform, mesh, {x + across, y + up}));
        }
      }
    }
    ASSERT_LE(r.nearness, least - window.device_margin()) << "trial " << trial;
    close += r.nearness > least - 1.1 * window.device_margin() - 1e-5 * std::abs(least) ? 1 : 0;
  }
  EXPECT_GT(found, trials / 16);
  EXPECT_GT(close, trials / 32);
}

Play city(std::uint32_t bridges = 0) {
  CityParameters parameters;
  parameters.blocks_x = parameters.blocks_z = 8;
  parameters.roof_share = 0.3;
  parameters.street_boxes = 300;
  parameters.bridges = bridges;
  parameters.bridge_clearance = 0.3;
  Play play;
  play.scene = make_city(parameters);
  play.scene.finish();
  return play;
}

Camera city_camera(const Viewport& viewport, const glm::dvec3& eye, const glm::dvec3& target,
                   const glm::dvec3& up = {0.0, 1.0, 0.0}) {
  return {look_at(eye, target, up),
          perspective_lens(degrees(60.0), viewport.aspect(), 0.3, 3000.0)};
}

void look_around(Play& play, const Viewport& viewport) {
  const auto add = [&](const glm::dvec3& eye, const glm::dvec3& target,
                       const glm::dvec3& up = {0.0, 1.0, 0.0}) {
    play.steps.push_back({city_camera(viewport, eye, target, up), {}});
  };
  add({0.0, 1.7, 0.0}, {60.0, 4.0, 0.0});
  add({-50.0, 1.7, 25.0}, {0.0, 1.7, -60.0});
  add({12.5, 5.0, 12.5}, {90.0, 4.0, 30.0});                 // inside of a house
  add({-90.0, 45.0, 3.0}, {0.0, 5.0, 0.0});                  // from above
  add({0.0, 1.7, 0.0}, {30.0, 4.0, 60.0}, {1.0, 1.0, 0.0});  // rolled
}

TEST(Horizon, LeavesTheImageAsItIs) {
  for (const Viewport& viewport : {Viewport{512, 512}, Viewport{160, 90}, Viewport{1023, 769}}) {
    Play play = city(2);
    look_around(play, viewport);
    if (viewport.width > 1000) play.steps.resize(2);
    play.steps[1].camera.lens = orthographic_lens(60.0, viewport.aspect(), 0.3, 500.0);
    const Damage done = damage("depth.horizon", play, viewport, true);
    EXPECT_EQ(done.image_px, 0U) << viewport.width;
    EXPECT_LT(done.kept, done.offered / 2);
  }
}

TEST(Horizon, SeesUnderABridgeUnlessTheGroundIsAssumed) {
  constexpr Viewport viewport{256, 256};
  Play play = city(1);
  play.steps.push_back({city_camera(viewport, {-90.0, 1.7, 0.0}, {0.0, 3.0, 0.0}), {}});
  play.steps.push_back({city_camera(viewport, {0.0, 1.7, 40.0}, {0.0, 3.0, 0.0}), {}});
  EXPECT_EQ(damage("depth.horizon", play, viewport).false_px, 0U);
  EXPECT_GT(damage("depth.horizon[ground=assumed]", play, viewport).false_px, 0U);
}

TEST(Horizon, HidesWhatIsBehindABuildingAndFollowsIt) {
  constexpr Viewport viewport{64, 64};
  Play play;
  play.scene.meshes = {cube_mesh()};
  play.scene.objects = {{0, placed({0.0, 0.0, 0.0}, {4.0, 4.0, 0.5}), none_id},
                        {0, placed({0.0, 0.0, -8.0}), none_id}};
  play.scene.finish();
  const Camera camera = city_camera(viewport, {0.0, 0.0, 10.0}, {0.0, 0.0, 0.0});
  Changes aside;
  aside.moved = {0};
  aside.transforms = {placed({30.0, 0.0, 0.0}, {4.0, 4.0, 0.5})};
  Changes back;
  back.moved = {0};
  back.transforms = {placed({0.0, 0.0, 1.0}, {4.0, 4.0, 0.5})};
  Changes hidden;
  hidden.hidden = {0};
  CullerRun run("depth.horizon", play.scene);
  EXPECT_EQ(run.objects(camera), (std::vector<ObjectId>{0}));
  run.update(camera, aside);
  EXPECT_EQ(run.objects(camera), (std::vector<ObjectId>{1}));
  run.update(camera, back);
  EXPECT_EQ(run.objects(camera), (std::vector<ObjectId>{0}));
  run.update(camera, hidden);
  EXPECT_EQ(run.objects(camera), (std::vector<ObjectId>{1}));
}

TEST(Horizon, LetsBatchesOfAFrameHideEachOtherWhicheverComesFirst) {
  Scene scene;
  scene.meshes = {cube_mesh()};
  scene.objects = {{0, placed({0.0, 0.0, 0.0}, {4.0, 4.0, 0.5}), none_id},
                   {0, placed({0.0, 0.0, -8.0}), none_id},
                   {0, placed({0.0, 0.0, 4.0}, glm::dvec3(0.5)), none_id}};
  scene.finish();
  const Camera camera = camera_at({0.0, 0.0, 10.0}, {0.0, 0.0, 0.0});
  CullerRun run("depth.horizon", scene);
  const Frame frame = run.frame(camera);
  RecordingSink sink;
  const auto ask = [&](ObjectId object) {
    const std::array ids{object};
    const std::array<std::span<const ObjectId>, 1> runs{ids};
    sink.start(scene, frame);
    run.culler().cull(frame, Candidates::of(runs), sink);
    return sink.emitted().size();
  };
  EXPECT_EQ(ask(0), 1U);
  EXPECT_EQ(ask(1), 0U);  // behind it
  EXPECT_EQ(ask(2), 1U);  // before it
}

}  // namespace
}  // namespace vislab
