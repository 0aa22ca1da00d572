#include "common/raster/depth_raster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/random.h"
#include "common/raster/brute_force_raster.h"
#include "common/scene/error.h"
#include "common/simd/simd_target.h"

namespace vislab {
namespace {

#ifdef __SANITIZE_ADDRESS__
constexpr int trials = 1;
#else
constexpr int trials = 4;
#endif

glm::vec3 random_point(Random& random, const glm::vec3& center, float reach) {
  glm::vec3 p;
  for (int axis = 0; axis < 3; ++axis) {
    p[axis] = center[axis] + reach * static_cast<float>(random.uniform(-1.0, 1.0));
  }
  return p;
}

/// Triangles of all kinds before, around and behind an eye at the origin that looks along -z:
/// small and huge ones, slivers, edge-on ones, without area, across the near plane.
Mesh random_soup(Random& random, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const auto kind = random.below(8);
    glm::vec3 center = random_point(random, {0.0F, 0.0F, -20.0F}, 18.0F);
    if (kind == 0) center = random_point(random, {}, 2.0F);
    const std::array<float, 8> sizes{1.0F, 0.02F, 0.3F, 1.0F, 6.0F, 60.0F, 3.0F, 2.0F};
    const float size = sizes[kind];
    std::array<glm::vec3, 3> p;
    for (glm::vec3& corner : p) corner = random_point(random, center, size);
    if (kind == 3) p[2] = p[1] + 0.001F * (p[2] - p[1]);  // sliver
    if (kind == 6) p[2] = p[0] * 0.5F + p[1] * 0.5F;      // about no area
    if (kind == 7) p[2] = p[0] * 1.5F;                    // seen edge-on
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::vec3& corner : p) mesh.positions.push_back(corner);
    mesh.triangles.emplace_back(base, base + 1, base + 2);
    // Neighbours with a common edge.
    if (kind == 2 && base > 2) mesh.triangles.emplace_back(base, base + 2, base - 1);
  }
  return mesh;
}

/// A closed box, whose faces go out of the window and behind each other.
Mesh box_mesh() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1,
                                (i & 4) != 0 ? 1 : -1);
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

struct Stage {
  RasterMesh soup, box;
  std::vector<glm::dmat4x3> transforms;
  std::vector<RasterDraw> draws;
};

Stage random_stage(Random& random, int triangles, int boxes) {
  Stage stage;
  stage.soup = RasterMesh(random_soup(random, triangles));
  stage.box = RasterMesh(box_mesh());
  stage.transforms.emplace_back(1.0);
  for (int i = 0; i < boxes; ++i) {
    glm::dmat4x3 m(1.0);
    for (int c = 0; c < 3; ++c) {
      const glm::vec3 column = random_point(random, {}, 1.5F);
      m[c] = glm::dvec3(column) + 0.5 * m[c];
    }
    m[3] = glm::dvec3(random_point(random, {0.0F, 0.0F, -15.0F}, 25.0F));
    stage.transforms.push_back(m);  // mirrored ones, too
  }
  const auto count = static_cast<std::uint32_t>(stage.soup.triangles().size());
  const auto cut = static_cast<std::uint32_t>(random.below(count));
  stage.draws.push_back({&stage.soup, &stage.transforms[0], cut, count - cut, 1000 + cut, false});
  std::uint32_t id = 100'000;
  for (int i = 1; i <= boxes; ++i) {
    stage.draws.push_back({&stage.box, &stage.transforms[static_cast<std::size_t>(i)], 0, 12, id,
                           random.below(4) != 0});
    id += 12;
  }
  stage.draws.push_back({&stage.soup, &stage.transforms[0], 0, cut, 1000, true});
  stage.draws.push_back({&stage.soup, &stage.transforms[0], 0, 0, 0, false});
  return stage;
}

Camera random_camera(Random& random, const Viewport& size) {
  Camera camera;
  camera.pose = look_at(glm::dvec3(random_point(random, {}, 1.0F)),
                        glm::dvec3(random_point(random, {0.0F, 0.0F, -20.0F}, 8.0F)));
  switch (random.below(3)) {
    case 0:
      camera.lens = perspective_lens(1.2, size.aspect(), 0.3, 60.0);
      break;
    case 1:
      camera.lens = orthographic_lens(15.0, size.aspect(), 0.5, 45.0);
      break;
    default:
      camera.lens = perspective_lens(0.9, size.aspect(), 0.05, 1000.0);
      camera.lens.left *= 0.2;
      camera.lens.top *= 1.7;
  }
  return camera;
}

template <typename Raster>
void expect_equal(const Raster& raster, const BruteForceRaster& truth, const Viewport& size,
                  const std::string& what, bool ids) {
  int wrong = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool same = raster.nearness(x, y) == truth.nearness(x, y) &&
                        (!ids || raster.id(x, y) == truth.id(x, y));
      if (same || wrong++ > 3) continue;
      ADD_FAILURE() << what << ": pixel " << x << ", " << y << " has " << raster.nearness(x, y)
                    << ", not " << truth.nearness(x, y);
    }
  }
  EXPECT_EQ(wrong, 0) << what;
}

void expect_bounds_hold(const DepthRaster& raster, const std::string& what) {
  const TileStore& tiles = raster.tiles();
  int wrong = 0;
  for (int y = 0; y < tiles.height(); ++y) {
    for (int x = 0; x < tiles.width(); ++x) {
      const std::size_t tile = tiles.index(x / tile_size, y / tile_size);
      const float here = raster.nearness(x, y);
      wrong += here < tiles.farthest()[tile] || here > tiles.nearest()[tile] ? 1 : 0;
    }
  }
  EXPECT_EQ(wrong, 0) << what;
}

constexpr std::array<SetupOptions, 3> all_options{
    SetupOptions{Coverage::centres, DepthRounding::nearest},
    SetupOptions{Coverage::whole_pixels, DepthRounding::lowered},
    SetupOptions{Coverage::centres, DepthRounding::lowered}};

void compare_with_brute_force(const Viewport& size, std::uint64_t seed, int triangles, int boxes) {
  Random random(seed);
  for (int trial = 0; trial < trials; ++trial) {
    const Stage stage = random_stage(random, triangles, boxes);
    const Camera camera = random_camera(random, size);
    const SetupOptions& options = all_options[static_cast<std::size_t>(trial % 3)];
    BruteForceRaster truth(size, options);
    truth.begin(camera);
    const std::size_t drawn = truth.draw(stage.draws);
    for (const std::string& target : simd_targets()) {
      const SimdTargetScope scope(target);
      for (const int threads : {1, 2}) {
        for (const bool ids : {false, true}) {
          DepthRaster raster(size, {options, ids, threads});
          raster.begin(camera);
          const std::string what = target + " with " + std::to_string(threads) +
                                   " threads, trial " + std::to_string(trial) +
                                   (ids ? ", ids" : "");
          EXPECT_EQ(raster.draw(stage.draws), drawn) << what;
          expect_equal(raster, truth, size, what, ids);
          expect_bounds_hold(raster, what);
        }
      }
    }
  }
}

TEST(DepthRaster, EqualsBruteForceInOnePixel) { compare_with_brute_force({1, 1}, 11, 200, 200); }
TEST(DepthRaster, EqualsBruteForceInSevenByFive) { compare_with_brute_force({7, 5}, 12, 300, 200); }
TEST(DepthRaster, EqualsBruteForceInASmallImage) {
  compare_with_brute_force({160, 90}, 13, 300, 150);
}
TEST(DepthRaster, EqualsBruteForceInAnOddImage) {
  compare_with_brute_force({1023, 769}, 14, 60, 90);
}
TEST(DepthRaster, EqualsBruteForceInAWideImage) {
  compare_with_brute_force({1024, 512}, 15, 60, 90);
}

TEST(DepthRaster, EqualsBruteForceWhereEdgesMeetPixelCentresAndDepthsTie) {
  // Corners on a grid of half pixels, few depths: parallel to the image, doubled, some as squares.
  Random random(21);
  const Viewport size{67, 45};
  Camera camera;
  camera.lens = orthographic_lens(45.0, size.aspect(), 1.0, 100.0);
  const auto place = [&](int range) {
    return 0.5F * static_cast<float>(random.below(static_cast<std::uint64_t>(2 * range)));
  };
  for (int trial = 0; trial < 3 * trials; ++trial) {
    Mesh mesh;
    for (int i = 0; i < 60; ++i) {
      const auto base = static_cast<std::uint32_t>(mesh.positions.size());
      const float z = -10.0F - static_cast<float>(random.below(3));
      const float x = place(67) - 33.5F, y = place(45) - 22.5F, w = 0.5F + place(20),
                  h = 0.5F + place(20);
      const float skew = place(8);
      mesh.positions.insert(
          mesh.positions.end(),
          {{x, y, z}, {x + w, y, z}, {x + w + skew, y + h, z}, {x + skew, y + h, z}});
      // Both diagonals, from both ends.
      const auto turn = static_cast<std::uint32_t>(random.below(4));
      const auto corner = [&](std::uint32_t k) { return base + (k + turn) % 4; };
      mesh.triangles.emplace_back(corner(0), corner(1), corner(2));
      mesh.triangles.emplace_back(corner(0), corner(2), corner(3));
      if (i % 3 == 0) std::swap(mesh.triangles.back().x, mesh.triangles.back().y);
      if (i % 5 == 0) mesh.triangles.emplace_back(base + 1, base + 3, base);
    }
    const RasterMesh raster_mesh(mesh);
    const glm::dmat4x3 identity(1.0);
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    const RasterDraw draw{&raster_mesh, &identity, 0, count, 0, trial % 2 == 1};
    BruteForceRaster truth(size, {});
    truth.begin(camera);
    truth.draw({&draw, 1});
    for (const std::string& target : simd_targets()) {
      const SimdTargetScope scope(target);
      DepthRaster raster(size, {{}, true, 1}), plain(size, {});
      for (DepthRaster* one : {&raster, &plain}) {
        one->begin(camera);
        one->draw({&draw, 1});
        expect_equal(*one, truth, size, target, one == &raster);
      }
    }
  }
}

TEST(DepthRaster, IsClearedByANewFrame) {
  Random random(16);
  const Stage stage = random_stage(random, 100, 50);
  const Viewport size{33, 17};
  DepthRaster raster(size, {{}, true, 1});
  BruteForceRaster truth(size, {});
  const Camera camera = random_camera(random, size);
  raster.begin(camera);
  raster.draw(stage.draws);
  raster.begin(camera);
  truth.begin(camera);
  expect_equal(raster, truth, size, "cleared", true);
  EXPECT_EQ(raster.draw({}), 0U);
}

TEST(DepthRaster, OrderOfDrawingDoesNotMatter) {
  Random random(17);
  const Viewport size{160, 90};
  Stage stage = random_stage(random, 200, 100);
  const Camera camera = random_camera(random, size);
  BruteForceRaster truth(size, {});
  truth.begin(camera);
  truth.draw(stage.draws);
  std::ranges::reverse(stage.draws);
  DepthRaster raster(size, {});
  raster.begin(camera);
  for (const RasterDraw& draw : stage.draws) raster.draw({&draw, 1});
  expect_equal(raster, truth, size, "reversed", false);
}

TEST(DepthRaster, HidesRectanglesExactlyAsItsPixelsSay) {
  Random random(18);
  const Viewport size{61, 43};
  for (int trial = 0; trial < trials; ++trial) {
    const Stage stage = random_stage(random, 100, 100);
    DepthRaster raster(size, {});
    raster.begin(random_camera(random, size));
    raster.draw(stage.draws);
    int hidden = 0;
    for (int i = 0; i < 3000; ++i) {
      BoxWindow box;
      box.x0 = static_cast<int>(random.below(61));
      box.y0 = static_cast<int>(random.below(43));
      box.x1 =
          box.x0 + 1 + static_cast<int>(random.below(std::min<std::uint64_t>(20, 61 - box.x0)));
      box.y1 =
          box.y0 + 1 + static_cast<int>(random.below(std::min<std::uint64_t>(20, 43 - box.y0)));
      const float other = raster.nearness(box.x0, box.y0);
      box.nearness = i % 3 == 0 ? std::nextafter(other, -INFINITY)
                                : other - std::abs(other) * static_cast<float>(random.uniform());
      bool all = true;
      for (int y = box.y0; y < box.y1; ++y) {
        for (int x = box.x0; x < box.x1; ++x) all = all && raster.nearness(x, y) > box.nearness;
      }
      EXPECT_EQ(raster.hides(box), all);
      hidden += all ? 1 : 0;
    }
    EXPECT_GT(hidden, 0);
  }
}

TEST(DepthRaster, DrawsWhatIsVisibleOnlyAndLosesNothing) {
  Random random(19);
  const Viewport size{160, 90};
  int skipped = 0;
  for (int trial = 0; trial < 2 * trials; ++trial) {
    Stage stage = random_stage(random, 10, 400);
    const Camera camera = random_camera(random, size);
    // Near first, as far as their middles say.
    std::ranges::sort(stage.draws, {}, [&](const RasterDraw& draw) {
      return camera.planar_depth((*draw.transform)[3]);
    });
    std::vector<std::uint8_t> first;
    for (const std::string& target : simd_targets()) {
      const SimdTargetScope scope(target);
      DepthRaster raster(size, {});
      raster.begin(camera);
      std::vector<std::uint8_t> hidden(stage.draws.size());
      raster.draw_visible(stage.draws, hidden);
      if (first.empty()) first = hidden;
      EXPECT_EQ(hidden, first) << target;
      BruteForceRaster all(size, {}), kept(size, {});
      all.begin(camera);
      kept.begin(camera);
      all.draw(stage.draws);
      for (std::size_t i = 0; i < hidden.size(); ++i) {
        if (hidden[i] == 0) kept.draw({&stage.draws[i], 1});
        skipped += hidden[i];
      }
      expect_equal(kept, all, size, "without the hidden", false);
      expect_equal(raster, all, size, target, false);
    }
  }
  EXPECT_GT(skipped, 100);
}

TEST(DepthRaster, DrawsBoxesInOrderAsIfTestedOneByOne) {
  Random random(20);
  const Viewport size{160, 90};
  std::size_t skipped = 0;
  for (int trial = 0; trial < 2 * trials; ++trial) {
    const Stage stage = random_stage(random, 1, 300);
    const Camera camera = random_camera(random, size);
    std::vector<BoxColumns> boxes(stage.draws.size() / BoxColumns::width + 1);
    std::vector<std::pair<double, std::uint32_t>> by_depth;
    for (std::uint32_t i = 0; i < stage.draws.size(); ++i) {
      Aabb box;  // not valid for the soup: never left out
      for (int corner = 0; corner < 8 && stage.draws[i].mesh == &stage.box; ++corner) {
        const glm::dvec4 p((corner & 1) * 2 - 1, (corner & 2) - 1, (corner & 4) / 2 - 1, 1.0);
        box.extend(glm::vec3(*stage.draws[i].transform * p));
      }
      if (!box.empty()) box = {box.min - 1e-4F, box.max + 1e-4F};
      boxes[i / BoxColumns::width].put(i % BoxColumns::width, box);
      by_depth.emplace_back(camera.planar_depth((*stage.draws[i].transform)[3]), i);
    }
    std::sort(by_depth.begin(), by_depth.end());
    std::vector<std::uint32_t> order;
    for (const auto& [depth, i] : by_depth) order.push_back(i);
    BruteForceRaster all(size, {});
    all.begin(camera);
    all.draw(stage.draws);
    for (const std::string& target : simd_targets()) {
      const SimdTargetScope scope(target);
      DepthRaster raster(size, {});
      raster.begin(camera);
      std::vector<std::uint8_t> hidden(stage.draws.size(), 7);
      raster.draw_visible(stage.draws, boxes, order, hidden);
      expect_equal(raster, all, size, target, false);
      for (std::size_t i = 0; i < hidden.size(); ++i) {
        EXPECT_LE(hidden[i], stage.draws[i].mesh == &stage.soup ? 0 : 1);
        skipped += hidden[i];
      }
    }
  }
  EXPECT_GT(skipped, 100U);
}

TEST(DepthRaster, RefusesSizesThatItCannotHold) {
  EXPECT_THROW(DepthRaster({0, 4}, {}), InputError);
  EXPECT_THROW(DepthRaster({4, 16'385}, {}), InputError);
  DepthRaster largest({16'384, 8}, {});
  largest.begin(Camera{});
  EXPECT_GT(largest.bytes(), 0U);
}

}  // namespace
}  // namespace vislab
