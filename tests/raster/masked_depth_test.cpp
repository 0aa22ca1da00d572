#include "common/raster/masked_depth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/random.h"
#include "common/raster/brute_force_raster.h"
#include "common/scene/error.h"
#include "common/simd/simd_target.h"

namespace vislab {
namespace {

glm::vec3 random_point(Random& random, const glm::vec3& center, float reach) {
  glm::vec3 p;
  for (int axis = 0; axis < 3; ++axis) {
    p[axis] = center[axis] + reach * static_cast<float>(random.uniform(-1.0, 1.0));
  }
  return p;
}

/// Small, large and thin triangles about an eye at the origin that looks along -z.
RasterMesh random_mesh(Random& random, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const auto kind = random.below(5);
    const glm::vec3 center = random_point(random, {0.0F, 0.0F, -20.0F}, 19.0F);
    const float size = kind == 0 ? 0.1F : kind == 1 ? 1.0F : kind == 2 ? 30.0F : 5.0F;
    const glm::vec3 p = random_point(random, center, size);
    const glm::vec3 q = random_point(random, center, size);
    glm::vec3 r = random_point(random, center, size);
    if (kind == 3) r = q + 0.01F * (r - q);
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {p, q, r});
    mesh.triangles.emplace_back(base, base + 1, base + 2);
  }
  return RasterMesh(mesh);
}

Camera camera_of(const Viewport& size, bool perspective) {
  Camera camera;
  camera.lens = perspective ? perspective_lens(1.0, size.aspect(), 0.1, 100.0)
                            : orthographic_lens(20.0, size.aspect(), 0.1, 100.0);
  return camera;
}

const glm::dmat4x3 in_place(1.0);

template <typename Raster>
void draw_all(Raster& raster, const RasterMesh& mesh) {
  const RasterDraw draw{&mesh, &in_place, 0, static_cast<std::uint32_t>(mesh.triangles().size()),
                        0,     false};
  raster.draw({&draw, 1});
}

/// Two triangles that make up a rectangle at a depth.
RasterMesh rectangle(float x0, float y0, float x1, float y1, float depth) {
  Mesh mesh;
  mesh.positions = {{x0, y0, -depth}, {x1, y0, -depth}, {x1, y1, -depth}, {x0, y1, -depth}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return RasterMesh(mesh);
}

TEST(TileCoverage, IsTheSameWithAndWithoutSimd) {
  Random random(1);
  std::vector<PartialTile> tiles(200);
  for (const std::string& target : simd_targets()) {
    const SimdTargetScope scope(target);
    for (int trial = 0; trial < 50; ++trial) {
      TileSteps steps{};
      const int size = 1 << random.below(24);
      const auto number = [&] { return static_cast<std::int32_t>(random.uniform(-size, size)); };
      for (std::size_t e = 0; e < 3; ++e) {
        steps.a[e] = number();
        steps.b[e] = number();
      }
      steps.x = static_cast<float>(random.uniform(-1.0, 1.0));
      steps.y = static_cast<float>(random.uniform(-1.0, 1.0));
      for (PartialTile& tile : tiles) {
        tile = {};
        for (std::size_t e = 0; e < 3; ++e) tile.edge[e] = 8 * number();
        tile.nearness = static_cast<float>(random.uniform(-5.0, 5.0));
      }
      std::vector<TileCoverage> fast(tiles.size()), plain(tiles.size());
      cover_tiles(steps, tiles, fast);
      cover_tiles_scalar(steps, tiles, plain);
      ASSERT_EQ(fast, plain) << target;
    }
  }
}

TEST(MaskedDepth, IsNeverNearerThanWhatWasDrawnAndTheSameOnEveryInstructionSet) {
  Random random(2);
  for (const Viewport& size : {Viewport{1, 1}, Viewport{7, 5}, Viewport{160, 90}, {203, 121}}) {
    for (const LayerMerge merge : {LayerMerge::distance, LayerMerge::volume}) {
      for (const bool perspective : {true, false}) {
        for (const Coverage coverage : {Coverage::centres, Coverage::whole_pixels}) {
          const RasterMesh mesh = random_mesh(random, 80);
          const RasterOptions options{{coverage, DepthRounding::lowered}, false, 1};
          const Camera camera = camera_of(size, perspective);
          BruteForceRaster exact(size, options.setup);
          exact.begin(camera);
          draw_all(exact, mesh);
          MaskedDepth plain(size, options, merge);
          plain.use_scalar();
          plain.begin(camera);
          draw_all(plain, mesh);
          for (const std::string& target : simd_targets()) {
            const SimdTargetScope scope(target);
            MaskedDepth masked(size, options, merge);
            masked.begin(camera);
            draw_all(masked, mesh);
            for (int y = 0; y < size.height; ++y) {
              for (int x = 0; x < size.width; ++x) {
                ASSERT_EQ(masked.nearness(x, y), plain.nearness(x, y)) << target;
                ASSERT_LE(masked.nearness(x, y), exact.nearness(x, y)) << x << ", " << y;
              }
            }
          }
        }
      }
    }
  }
}

TEST(MaskedDepth, HidesARectangleIfAllItsPixelsAreNearer) {
  Random random(3);
  const Viewport size{61, 43};
  MaskedDepth masked(size, {{Coverage::centres, DepthRounding::lowered}, false, 1});
  masked.begin(camera_of(size, true));
  draw_all(masked, random_mesh(random, 60));
  std::size_t hidden = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    BoxWindow box;
    box.x0 = static_cast<int>(random.below(61));
    box.y0 = static_cast<int>(random.below(43));
    box.x1 = box.x0 + 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(61 - box.x0)));
    box.y1 = box.y0 + 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(43 - box.y0)));
    box.nearness = masked.nearness(box.x0, box.y0) * static_cast<float>(random.uniform(0.3, 1.1));
    bool all = true;
    for (int y = box.y0; y < box.y1; ++y) {
      for (int x = box.x0; x < box.x1; ++x) all = all && masked.nearness(x, y) > box.nearness;
    }
    ASSERT_EQ(masked.hides(box), all);
    hidden += all ? 1 : 0;
  }
  EXPECT_GT(hidden, 1000U);
  EXPECT_LT(hidden, 19'000U);
}

TEST(MaskedDepth, JoinsTrianglesThatFillATileTogether) {
  const Viewport size{64, 64};
  MaskedDepth masked(size, {{Coverage::centres, DepthRounding::lowered}, false, 1});
  masked.begin(camera_of(size, true));
  // Their common edge runs through tiles.
  draw_all(masked, rectangle(-50.0F, -50.0F, 0.1F, 50.0F, 5.0F));
  draw_all(masked, rectangle(0.1F, -50.0F, 50.0F, 50.0F, 6.0F));
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) ASSERT_GT(masked.nearness(x, y), 1.0F / 6.01F) << x << ", " << y;
  }
}

TEST(MaskedDepth, ForgetsAThirdSurfaceInATileUnlessItIsDrawnInOrder) {
  const Viewport size{8, 8};
  const RasterMesh half = rectangle(-50.0F, -50.0F, 0.0F, 50.0F, 2.0F);
  const RasterMesh middle = rectangle(-50.0F, -50.0F, 2.0F, 50.0F, 8.0F);
  const RasterMesh back = rectangle(-50.0F, -50.0F, 50.0F, 50.0F, 9.0F);
  MaskedDepth masked(size, {{Coverage::centres, DepthRounding::lowered}, false, 1});
  masked.begin(camera_of(size, true));
  for (const RasterMesh* mesh : {&half, &middle, &back}) draw_all(masked, *mesh);
  EXPECT_GT(masked.nearness(7, 4), 1.0F / 9.1F);
  EXPECT_LT(masked.nearness(0, 4), 1.0F / 7.9F);  // the near half is joined with the middle
  masked.begin(camera_of(size, true));
  for (const RasterMesh* mesh : {&back, &middle, &half}) draw_all(masked, *mesh);
  EXPECT_GT(masked.nearness(0, 4), 1.0F / 2.1F);
}

TEST(MaskedDepth, RefusesSizesThatAreNone) {
  const RasterOptions options;
  EXPECT_THROW(MaskedDepth({0, 5}, options), InputError);
  EXPECT_THROW(MaskedDepth({5, 16'385}, options), InputError);
}

}  // namespace
}  // namespace vislab
