#include "common/raster/box_samples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/random.h"
#include "common/raster/brute_force_raster.h"
#include "common/raster/covered_area.h"
#include "common/raster/depth_raster.h"
#include "common/simd/simd_target.h"

namespace vislab {
namespace {

#ifdef __SANITIZE_ADDRESS__
constexpr int trials = 6;
#else
constexpr int trials = 40;
#endif

glm::vec3 random_point(Random& random, const glm::vec3& center, float reach) {
  glm::vec3 p;
  for (int axis = 0; axis < 3; ++axis) {
    p[axis] = center[axis] + reach * static_cast<float>(random.uniform(-1.0, 1.0));
  }
  return p;
}

/// Triangles of all sizes before an eye at the origin that looks along -z, some across the near
/// plane.
RasterMesh random_triangles(Random& random, int count) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 3 * static_cast<std::uint32_t>(count); i += 3) {
    const glm::vec3 center = random_point(random, {0.0F, 0.0F, -12.0F}, 12.0F);
    const auto size = static_cast<float>(std::exp(random.uniform(-3.0, 2.0)));
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(random_point(random, center, size));
    mesh.triangles.push_back({i, i + 1, i + 2});
  }
  return RasterMesh(mesh);
}

Aabb random_box(Random& random) {
  const glm::vec3 center = random_point(random, {0.0F, 0.0F, -12.0F}, 14.0F);
  const auto size = static_cast<float>(std::exp(random.uniform(-3.0, 2.0)));
  const glm::vec3 half = glm::abs(random_point(random, glm::vec3(0.0F), size));
  Aabb box{center - half, center + half};
  // Seen head-on, flat, or where what is drawn is: what ties are made of.
  if (random.below(4) == 0) box.min.z = box.max.z = std::round(center.z);
  return box;
}

Camera camera_of(Random& random, const Viewport& size) {
  Camera camera;
  camera.lens = random.below(3) == 0 ? orthographic_lens(12.0, size.aspect(), 0.5, 40.0)
                                     : perspective_lens(1.2, size.aspect(), 0.4, 40.0);
  if (random.below(2) == 0) {
    camera.pose = look_at(glm::dvec3(random_point(random, glm::vec3(0.0F), 1.0F)),
                          glm::dvec3(random_point(random, {0.0F, 0.0F, -12.0F}, 5.0F)));
  }
  return camera;
}

constexpr std::array<std::array<std::size_t, 4>, 6> faces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

/// Every pixel of every front face, without tiles.
std::uint64_t passed_by_hand(const BruteForceRaster& raster, const Aabb& box) {
  const WindowTransform& window = raster.window();
  std::uint64_t passed = 0;
  const auto count = [&](const SetupTriangle& triangle) {
    for_each_covered_pixel(triangle, [&](int x, int y, float nearness) {
      passed += nearness >= raster.nearness(x, y) ? 1U : 0U;
    });
  };
  for (const std::array<std::size_t, 4>& face : faces) {
    std::array<WindowPoint, 4> points;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t corner = face[i];
      points[i] = window.world()({(corner & 1) != 0 ? box.max.x : box.min.x,
                                  (corner & 2) != 0 ? box.max.y : box.min.y,
                                  (corner & 4) != 0 ? box.max.z : box.min.z});
    }
    SetupResult result;
    std::array<SetupTriangle, 2> pair;
    if (set_up_pair(window, points, 0, {}, result, pair)) {
      if (result.facing != Facing::front) continue;
      for (int i = 0; i < result.count; ++i) count(pair[static_cast<std::size_t>(i)]);
      continue;
    }
    for (const std::array<std::size_t, 3>& corners :
         {std::array<std::size_t, 3>{0, 1, 2}, std::array<std::size_t, 3>{0, 2, 3}}) {
      std::array<SetupTriangle, max_setup_pieces> pieces;
      result = set_up_triangle(window, {points[corners[0]], points[corners[1]], points[corners[2]]},
                               0, {}, pieces);
      if (result.facing != Facing::front) continue;
      for (int i = 0; i < result.count; ++i) count(pieces[static_cast<std::size_t>(i)]);
    }
  }
  return passed;
}

TEST(BoxSamples, EqualBruteForceWithEveryInstructionSet) {
  Random random(31);
  std::uint64_t seen = 0, hidden = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const std::array<Viewport, 4> sizes{{{160, 90}, {67, 45}, {7, 5}, {1, 1}}};
    const Viewport size = sizes[static_cast<std::size_t>(trial % 4)];
    const RasterMesh mesh = random_triangles(random, 30);
    const glm::dmat4x3 identity(1.0);
    const RasterDraw draw{&mesh, &identity, 0, 30, 0, false};
    const Camera camera = camera_of(random, size);
    BruteForceRaster truth(size, {});
    truth.begin(camera);
    truth.draw({&draw, 1});
    DepthRaster raster(size, {});
    raster.begin(camera);
    raster.draw({&draw, 1});
    for (int i = 0; i < 40; ++i) {
      const Aabb box = random_box(random);
      const std::uint64_t expected = passed_by_hand(truth, box);
      ++(expected > 0 ? seen : hidden);
      for (const std::string& target : simd_targets()) {
        const SimdTargetScope scope(target);
        ASSERT_EQ(count_box_samples(raster.window(), raster.tiles(), box).passed, expected)
            << target << ", trial " << trial << ", box " << i;
      }
    }
  }
  EXPECT_GT(seen, 100U / (trials < 40 ? 4U : 1U));
  EXPECT_GT(hidden, 100U / (trials < 40 ? 4U : 1U));
}

Camera straight_camera(const Viewport& size) {
  Camera camera;
  camera.lens = orthographic_lens(static_cast<double>(size.height), size.aspect(), 1.0, 100.0);
  return camera;
}

TEST(BoxSamples, CountWhatIsEquallyNear) {
  const Viewport size{64, 64};
  Mesh mesh;
  mesh.positions = {
      {-8.0F, -8.0F, -20.0F}, {8.0F, -8.0F, -20.0F}, {8.0F, 8.0F, -20.0F}, {-8.0F, 8.0F, -20.0F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const RasterMesh square(mesh);
  const glm::dmat4x3 identity(1.0);
  const RasterDraw draw{&square, &identity, 0, 2, 0, false};
  DepthRaster raster(size, {});
  raster.begin(straight_camera(size));
  raster.draw({&draw, 1});
  const auto passed = [&](float front) {
    const Aabb box{{-8.0F, -8.0F, -30.0F}, {8.0F, 8.0F, front}};
    const BoxSamples samples = count_box_samples(raster.window(), raster.tiles(), box);
    EXPECT_EQ(samples.covered, 256U);
    return samples.passed;
  };
  EXPECT_EQ(passed(-20.0F), 256U);
  EXPECT_EQ(passed(-19.0F), 256U);
  EXPECT_EQ(passed(-21.0F), 0U);
}

TEST(BoxSamples, AreNoneForBoxesThatAreBrokenOrBesideOrBehindTheView) {
  const Viewport size{64, 64};
  DepthRaster raster(size, {});
  raster.begin(straight_camera(size));
  const auto count = [&](const Aabb& box) {
    return count_box_samples(raster.window(), raster.tiles(), box);
  };
  EXPECT_EQ(count(Aabb{}), BoxSamples{});
  EXPECT_EQ(count({{40.0F, 0.0F, -20.0F}, {50.0F, 9.0F, -10.0F}}), BoxSamples{});
  EXPECT_EQ(count({{-5.0F, -5.0F, 10.0F}, {5.0F, 5.0F, 20.0F}}), BoxSamples{});
  EXPECT_EQ(count({{-5.0F, -5.0F, -200.0F}, {5.0F, 5.0F, -150.0F}}).passed, 0U) << "beyond far";
  EXPECT_GT(count({{-5.0F, -5.0F, -200.0F}, {5.0F, 5.0F, -50.0F}}).passed, 0U);
}

TEST(CoveredArea, IsTheNumberOfSamplesWithinTheImage) {
  const Viewport size{64, 40};
  Mesh mesh;
  // Wholly inside, wholly around, half outside, all outside; then behind another and turned away.
  mesh.positions = {{-8.0F, -8.0F, -20.0F},     {8.0F, -8.0F, -20.0F},     {8.0F, 8.0F, -20.0F},
                    {-900.0F, -900.0F, -30.0F}, {900.0F, -900.0F, -30.0F}, {0.0F, 900.0F, -30.0F},
                    {16.0F, -8.0F, -20.0F},     {48.0F, -8.0F, -20.0F},    {48.0F, 8.0F, -20.0F},
                    {16.0F, 8.0F, -20.0F},      {70.0F, 0.0F, -20.0F},     {90.0F, 0.0F, -20.0F},
                    {80.0F, 9.0F, -20.0F}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {6, 8, 9}, {10, 11, 12}, {0, 2, 1}};
  const RasterMesh triangles(mesh);
  const glm::dmat4x3 identity(1.0);
  const auto range = [&](std::uint32_t first, std::uint32_t count, bool front_only = false) {
    return RasterDraw{&triangles, &identity, first, count, 0, front_only};
  };
  const std::array<RasterDraw, 6> draws{range(0, 1), range(1, 1), range(2, 2),
                                        range(4, 1), range(5, 1), range(5, 1, true)};
  const std::array<std::uint64_t, 6> expected{128, 64 * 40, 16 * 16, 0, 128, 0};
  for (const std::string& target : simd_targets()) {
    const SimdTargetScope scope(target);
    DepthRaster raster(size, {}), plain(size, {});
    raster.begin(straight_camera(size));
    plain.begin(straight_camera(size));
    std::array<std::uint64_t, 6> samples{};
    raster.draw_counted(draws, samples);
    EXPECT_EQ(samples, expected) << target;
    plain.draw(draws);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) ASSERT_EQ(raster.nearness(x, y), plain.nearness(x, y));
    }
  }
}

TEST(CoveredArea, AgreesWithCountedPixelsOfRandomTriangles) {
  Random random(33);
  const Viewport size{160, 90};
  std::uint64_t by_area = 0, by_pixel = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Camera camera = camera_of(random, size);
    const WindowTransform window(camera, size);
    for (int i = 0; i < 40; ++i) {
      std::array<WindowPoint, 3> points;
      const auto reach = static_cast<float>(std::exp(random.uniform(-1.0, 3.0)));
      for (WindowPoint& point : points) {
        point = window.world()(glm::dvec3(random_point(random, {0.0F, 0.0F, -12.0F}, reach)));
      }
      std::array<SetupTriangle, max_setup_pieces> pieces;
      const SetupResult result = set_up_triangle(window, points, 0, {}, pieces);
      for (int piece = 0; piece < result.count; ++piece) {
        const SetupTriangle& triangle = pieces[static_cast<std::size_t>(piece)];
        const std::uint64_t area = samples_of_area(covered_area(triangle, size));
        std::uint64_t pixels = 0;
        for_each_covered_pixel(triangle, [&](int, int, float) { ++pixels; });
        // They differ along the outline only.
        const double outline = triangle.x1 - triangle.x0 + triangle.y1 - triangle.y0;
        ASSERT_NEAR(static_cast<double>(area), static_cast<double>(pixels), outline + 2.0);
        by_area += area;
        by_pixel += pixels;
      }
    }
  }
  EXPECT_NEAR(static_cast<double>(by_area) / static_cast<double>(by_pixel), 1.0, 0.01);
}

}  // namespace
}  // namespace vislab
