#include "common/judge/samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/judge/judge_scenes.h"

namespace vislab {
namespace {

std::vector<EightPositions> tile_of(const JitteredSamples& samples, int x, int y) {
  std::vector<EightPositions> packets(samples.packets_per_tile());
  samples.tile(x, y, packets.data());
  return packets;
}

TEST(JitteredSamples, put_one_sample_into_each_stratum_and_none_on_an_edge) {
  for (const auto& [count, columns, rows] :
       {std::array{16, 4, 4}, {1, 1, 1}, {4, 2, 2}, {8, 4, 2}, {6, 3, 2}, {7, 7, 1}}) {
    const JitteredSamples samples({40, 20}, count, 3);
    std::map<std::array<int, 2>, int> in_stratum;
    for (const EightPositions& packet : tile_of(samples, 2, 5)) {
      for (int lane = 0; lane < 8; ++lane) {
        const glm::dvec2 p = packet[lane];
        const double column = p.x * columns;
        const double row = p.y * rows;
        ++in_stratum[{static_cast<int>(column), static_cast<int>(row)}];
        EXPECT_NE(column, std::floor(column));
        EXPECT_NE(row, std::floor(row));
      }
    }
    EXPECT_EQ(in_stratum.size(), 8U * count) << count << " samples a pixel";
    EXPECT_EQ(in_stratum.begin()->first, (std::array{2 * 4 * columns, 5 * 2 * rows}));
  }
}

TEST(JitteredSamples, are_the_same_again_and_others_for_another_seed) {
  const Viewport viewport{64, 64};
  const JitteredSamples samples(viewport, 16, 1);
  const JitteredSamples again(viewport, 16, 1);
  const JitteredSamples other(viewport, 16, 2);
  int same = 0;
  for (int y = 0; y < 8; ++y) {
    const auto a = tile_of(samples, 3, y);
    const auto b = tile_of(again, 3, y);
    const auto c = tile_of(other, 3, y);
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].x, b[i].x);
      EXPECT_EQ(a[i].y, b[i].y);
      for (int lane = 0; lane < 8; ++lane) same += a[i][lane] == c[i][lane] ? 1 : 0;
    }
  }
  EXPECT_EQ(same, 0);
}

TEST(JitteredSamples, are_those_written_here_on_every_machine_and_in_every_build) {
  const JitteredSamples samples({512, 512}, 16, 1);
  const EightPositions packet = tile_of(samples, 10, 20)[3];
  EXPECT_EQ(packet[0], glm::dvec2(0x1.489af3p+5, 0x1.448b67p+5));
  EXPECT_EQ(packet[7], glm::dvec2(0x1.4e6d39p+5, 0x1.477ed1p+5));
}

TEST(JitteredSamples, are_spread_evenly_within_their_strata) {
  const JitteredSamples samples({512, 512}, 1, 5);
  double sum_x = 0.0;
  double sum_y = 0.0;
  double sum_xy = 0.0;
  int count = 0;
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 128; ++x) {
      const EightPositions packet = tile_of(samples, x, y).front();
      for (int lane = 0; lane < 8; ++lane) {
        const double dx = packet.x[lane] - std::floor(packet.x[lane]) - 0.5;
        const double dy = packet.y[lane] - std::floor(packet.y[lane]) - 0.5;
        sum_x += dx;
        sum_y += dy;
        sum_xy += dx * dy;
        ++count;
      }
    }
  }
  // Five standard deviations of a uniform variable's mean.
  EXPECT_NEAR(sum_x / count, 0.0, 5.0 * 0.2887 / std::sqrt(count));
  EXPECT_NEAR(sum_y / count, 0.0, 5.0 * 0.2887 / std::sqrt(count));
  EXPECT_NEAR(sum_xy / count, 0.0, 5.0 / 12.0 / std::sqrt(count));
}

TEST(Samples, of_the_scalar_twin_are_the_same_bits) {
  const Viewport viewport{333, 77};
  const Camera camera = camera_at({1.3, 2.1, -7.7}, {0.1, 0.2, 0.3});
  for (const int count : {1, 5, 16}) {
    const JitteredSamples fast(viewport, count, 9, true);
    const JitteredSamples scalar(viewport, count, 9, false);
    const RayMaker fast_rays(camera, viewport, {100.0, 0.0, 3.0}, true);
    const RayMaker scalar_rays(camera, viewport, {100.0, 0.0, 3.0}, false);
    for (int x = 0; x < 80; ++x) {
      const auto a = tile_of(fast, x, x % 38);
      const auto b = tile_of(scalar, x, x % 38);
      std::vector<EightVectors> rays_a(a.size());
      std::vector<EightVectors> rays_b(b.size());
      fast_rays.vary(a, rays_a.data());
      scalar_rays.vary(b, rays_b.data());
      for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].x, b[i].x);
        ASSERT_EQ(a[i].y, b[i].y);
        ASSERT_EQ(rays_a[i].x, rays_b[i].x);
        ASSERT_EQ(rays_a[i].y, rays_b[i].y);
        ASSERT_EQ(rays_a[i].z, rays_b[i].z);
      }
    }
  }
}

TEST(RayMaker, makes_the_cameras_rays) {
  const Viewport viewport{64, 32};
  const glm::dvec3 origin(5.0, 6.0, 7.0);
  Camera perspective = camera_at({1.0, 2.0, 3.0}, {4.0, 1.0, -2.0}, 0.5, 50.0, 2.0);
  perspective.lens.left *= 0.3;
  Camera orthographic = perspective;
  orthographic.lens = orthographic_lens(6.0, 2.0, -3.0, 40.0);
  for (const Camera& camera : {perspective, orthographic}) {
    const RayMaker maker(camera, viewport, origin);
    const EightPositions positions = pixel_centres(7, 3);
    EightVectors varying;
    maker.vary({&positions, 1}, &varying);
    for (int lane = 0; lane < 8; ++lane) {
      const Ray ray = camera.ray(positions[lane] / glm::dvec2(viewport.width, viewport.height));
      const glm::dvec3 v(varying.x[lane], varying.y[lane], varying.z[lane]);
      const glm::dvec3 start = maker.orthographic() ? v : glm::dvec3(maker.common());
      const glm::dvec3 direction = maker.orthographic() ? glm::dvec3(maker.common()) : v;
      for (const double depth : {camera.lens.near_m, camera.lens.far_m}) {
        const glm::dvec3 expected = ray.origin + ray.direction * depth - origin;
        const glm::dvec3 got = start + direction * (depth - maker.depth_offset());
        EXPECT_LT(glm::length(expected - got), 1e-5);
      }
    }
  }
}

}  // namespace
}  // namespace vislab
