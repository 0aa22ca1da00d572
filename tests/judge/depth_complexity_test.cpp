#include "common/judge/depth_complexity.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numeric>

#include "common/judge/window_triangle.h"
#include "tests/judge/judge_scenes.h"

namespace vislab {
namespace {

/// Cubes of 2 m one behind the other along -z, 4 m apart, seen from the origin.
Scene row_of_cubes(int count) {
  std::vector<glm::dvec3> centers;
  for (int i = 0; i < count; ++i) centers.emplace_back(0.02, 0.03, -5.0 - 4.0 * i);
  return cubes_at(centers);
}

const Camera ahead = camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});

std::uint32_t at(const DepthComplexityMap& map, int x, int y) {
  return map.counts[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                    static_cast<std::size_t>(x)];
}

std::uint64_t sum(const DepthComplexityMap& map) {
  return std::accumulate(map.counts.begin(), map.counts.end(), std::uint64_t{0});
}

TEST(DepthComplexity, OfARowOfCubesIsTwoARayAndOneWithoutBackFaces) {
  Stage stage(row_of_cubes(3), ahead, {33, 33});
  const DepthComplexityMap rays = depth_complexity(stage.scene, stage.frame, DepthComplexity::rays);
  const DepthComplexityMap seen =
      depth_complexity(stage.scene, stage.frame, DepthComplexity::transparent);
  EXPECT_EQ(at(rays, 17, 17), 6U);
  EXPECT_EQ(at(seen, 17, 17), 3U);
  EXPECT_EQ(at(rays, 0, 0), 0U);
  EXPECT_EQ(at(seen, 0, 0), 0U);
}

TEST(DepthComplexity, CountsWhatLiesBetweenTheNearAndTheFarPlaneOnly) {
  const Camera camera = camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, 5.0, 11.0);
  Stage stage(row_of_cubes(3), camera, {33, 33});  // faces at 4, 6, 8, 10, 12 and 14 m
  for (const DepthComplexity definition : {DepthComplexity::rays, DepthComplexity::polygons}) {
    const DepthComplexityMap map = depth_complexity(stage.scene, stage.frame, definition);
    EXPECT_EQ(at(map, 18, 16), 3U) << to_string(definition);
  }
}

TEST(DepthComplexity, CountsShownObjectsOnlyAndWhereTheyAreNow) {
  Stage stage(row_of_cubes(3), ahead, {33, 33});
  stage.apply(changes({1}, {box_transform({50.0, 0.0, -5.0}, glm::dvec3(1.0))}, {}, {2}));
  for (const DepthComplexity definition : depth_complexities) {
    const DepthComplexityMap map = depth_complexity(stage.scene, stage.frame, definition);
    const std::uint32_t expected = definition == DepthComplexity::transparent ? 1 : 2;
    EXPECT_EQ(at(map, 18, 16), expected) << to_string(definition);
  }
}

TEST(DepthComplexity, MirroredSolidsHaveTheirFrontsOutsideToo) {
  Scene scene = row_of_cubes(2);
  scene.objects[1].transform[0] = -scene.objects[1].transform[0];
  Stage stage(std::move(scene), ahead, {33, 33});
  const DepthComplexityMap seen =
      depth_complexity(stage.scene, stage.frame, DepthComplexity::transparent);
  EXPECT_EQ(at(seen, 17, 17), 2U);
}

TEST(DepthComplexity, OfOpenMeshesBothSidesAreSeen) {
  Scene scene = cubes_at({{0.02, 0.03, -5.0}});
  scene.meshes[0].triangles.pop_back();  // of the side at +z, half
  Stage stage(std::move(scene), ahead, {33, 33});
  ASSERT_FALSE(stage.scene.meshes[0].solid);
  const auto of = [&](DepthComplexity definition) {
    return depth_complexity(stage.scene, stage.frame, definition);
  };
  EXPECT_EQ(of(DepthComplexity::rays).counts, of(DepthComplexity::transparent).counts);
}

/// Is the pixel's square met by the polygon? By cutting the polygon to the square.
bool overlaps(const WindowTriangle& triangle, int x, int y) {
  std::vector<glm::dvec2> polygon(triangle.corners().begin(), triangle.corners().end());
  for (int side = 0; side < 4; ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? 1.0 : -1.0;
    const double limit = (axis == 0 ? x : y) + (side % 2);
    std::vector<glm::dvec2> cut;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec2& a = polygon[i];
      const glm::dvec2& b = polygon[(i + 1) % polygon.size()];
      const double inside_a = sign * (a[axis] - limit);
      const double inside_b = sign * (b[axis] - limit);
      if (inside_a >= 0.0) cut.push_back(a);
      if ((inside_a < 0.0) != (inside_b < 0.0)) {
        cut.push_back(a + (b - a) * (inside_a / (inside_a - inside_b)));
      }
    }
    polygon = std::move(cut);
  }
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2& b = polygon[(i + 1) % polygon.size()];
    area += polygon[i].x * b.y - polygon[i].y * b.x;
  }
  return std::abs(area) > 1e-9;
}

TEST(DepthComplexity, CountsEveryPolygonInEveryPixelThatItOverlaps) {
  BoxFieldParameters parameters;
  parameters.count = 40;
  parameters.extent_m = 12.0;
  parameters.rotated = true;
  parameters.clear_radius_m = 0.5;
  Stage stage(make_box_field(parameters), camera_at({0.3, 0.2, 0.1}, {3.0, 1.0, 2.0}, 0.5),
              {31, 17});
  const DepthComplexityMap map =
      depth_complexity(stage.scene, stage.frame, DepthComplexity::polygons);
  std::vector<std::uint32_t> expected(map.counts.size(), 0);
  for (ObjectId id = 0; id < stage.scene.object_count(); ++id) {
    for (std::uint32_t t = 0; t < 12; ++t) {
      const WindowTriangle triangle(
          stage.frame.camera, stage.frame.viewport,
          world_triangle(stage.scene.mesh_of(id), stage.scene.objects[id].transform, t));
      if (triangle.empty()) continue;
      for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
          expected[static_cast<std::size_t>(y * map.width + x)] += overlaps(triangle, x, y);
        }
      }
    }
  }
  EXPECT_EQ(map.counts, expected);
  EXPECT_GT(sum(map), 500U);
}

TEST(DepthComplexity, OfARayIsNoLessThanWithoutBackFacesAndNoMoreThanOfItsPixel) {
  BoxFieldParameters parameters;
  parameters.count = 300;
  parameters.extent_m = 20.0;
  for (const bool orthographic : {false, true}) {
    Camera camera = camera_at({0.0, 0.0, 0.0}, {3.0, 1.0, 2.0}, 0.5);
    if (orthographic) camera.lens = orthographic_lens(8.0, 1.0, 0.5, 100.0);
    Stage stage(make_box_field(parameters), camera, {41, 41});
    const auto of = [&](DepthComplexity definition) {
      return depth_complexity(stage.scene, stage.frame, definition);
    };
    const DepthComplexityMap rays = of(DepthComplexity::rays);
    const DepthComplexityMap seen = of(DepthComplexity::transparent);
    const DepthComplexityMap polygons = of(DepthComplexity::polygons);
    for (std::size_t i = 0; i < rays.counts.size(); ++i) {
      EXPECT_LE(seen.counts[i], rays.counts[i]);
      EXPECT_LE(rays.counts[i], polygons.counts[i]);
    }
    EXPECT_GT(sum(seen), 100U);
  }
}

TEST(DepthComplexity, IsTheSameWithOneThread) {
  BoxFieldParameters parameters;
  parameters.count = 300;
  parameters.extent_m = 20.0;
  Stage stage(make_box_field(parameters), ahead, {64, 48});
  const auto of_rays = [&] {
    return depth_complexity(stage.scene, stage.frame, DepthComplexity::rays).counts;
  };
  const std::vector<std::uint32_t> many = of_rays();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(of_rays(), many);
}

TEST(DepthComplexity, FiguresAreOfAllPixels) {
  DepthComplexityMap map{20, 5, std::vector<std::uint32_t>(100, 0)};
  DepthComplexityFigures figures = figures_of(map);
  EXPECT_EQ(figures.mean, 0.0);
  EXPECT_EQ(figures.max, 0U);
  for (std::size_t i = 0; i < 6; ++i) map.counts[i * 7] = 10;
  map.counts[0] = 40;
  figures = figures_of(map);
  EXPECT_DOUBLE_EQ(figures.mean, 0.9);
  EXPECT_EQ(figures.p95, 10U);  // five pixels may exceed it, and one does
  EXPECT_EQ(figures.max, 40U);
  map.counts[42] = map.counts[35] = 0;
  EXPECT_EQ(figures_of(map).p95, 0U);
}

}  // namespace
}  // namespace vislab
