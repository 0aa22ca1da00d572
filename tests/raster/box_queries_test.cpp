#include "common/raster/box_queries.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/geometry/random.h"
#include "common/simd/simd_target.h"
#include "tests/geometry/adversarial_boxes.h"

namespace vislab {
namespace {

#ifdef __SANITIZE_ADDRESS__
constexpr int trials = 6;
#else
constexpr int trials = 40;
#endif
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

Camera camera_at(const glm::dvec3& eye, const glm::dvec3& target) {
  return {look_at(eye, target), perspective_lens(std::numbers::pi / 3.0, 1.5, 0.3, 300.0)};
}

Camera random_camera(Random& random, const Viewport& size) {
  const glm::dvec3 eye = test::random_vector(random, 8.0);
  Camera camera = camera_at(eye, test::random_vector(random, 3.0));
  camera.lens = perspective_lens(random.uniform(0.5, 2.0), size.aspect(), 0.3, 300.0);
  switch (random.below(4)) {
    case 0:  // off-centre
      camera.lens.left += 0.1;
      camera.lens.top += 0.2;
      break;
    case 1:
      camera.lens = orthographic_lens(random.uniform(4.0, 20.0), size.aspect(), -5.0, 300.0);
      break;
    case 2:
      camera.lens.far_m = std::numeric_limits<double>::infinity();
      break;
    default:
      break;
  }
  return camera;
}

Aabb random_box(Random& random, double reach, double greatest_half) {
  const glm::dvec3 center = test::random_vector(random, reach);
  glm::dvec3 half;
  for (int axis = 0; axis < 3; ++axis) {
    half[axis] = test::log_uniform(random, 0.01 * greatest_half, greatest_half);
  }
  return {glm::vec3(center - half), glm::vec3(center + half)};
}

std::vector<Aabb> random_boxes(Random& random, std::size_t count) {
  std::vector<Aabb> boxes;
  while (boxes.size() < count) boxes.push_back(random_box(random, 20.0, 1.5));
  return boxes;
}

/// Walls of two triangles, at random.
Mesh random_walls(Random& random, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const glm::dvec3 center = test::random_vector(random, 10.0);
    const glm::dvec3 u = test::random_vector(random, 6.0), v = test::random_vector(random, 6.0);
    for (const glm::dvec3& corner :
         {center - u - v, center + u - v, center + u + v, center - u + v})
      mesh.positions.emplace_back(corner);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.triangles.emplace_back(first, first + 2, first + 3);
  }
  return mesh;
}

void draw(DepthRaster& raster, const Mesh& mesh) {
  const RasterMesh raster_mesh(mesh);
  const glm::dmat4x3 place(1.0);
  const RasterDraw whole{&raster_mesh, &place, 0,
                         static_cast<std::uint32_t>(mesh.triangles.size())};
  raster.draw({&whole, 1});
}

/// Does a triangle show at a pixel's centre? Corners are moved by less than snapping moves them.
bool shows(const DepthRaster& raster, const std::array<glm::dvec3, 3>& corners, Random& random) {
  const WindowTransform& window = raster.window();
  std::array<WindowPoint, 3> points;
  for (std::size_t i = 0; i < 3; ++i) {
    points[i] = window.world()(corners[i]);
    const double w = window.perspective() ? points[i].depth : 1.0;
    points[i].x += random.uniform(-1.0, 1.0) / 512.0 * w;
    points[i].y += random.uniform(-1.0, 1.0) / 512.0 * w;
  }
  std::array<SetupTriangle, max_setup_pieces> pieces;
  const SetupResult result = set_up_triangle(window, points, 0, {}, pieces);
  bool seen = false;
  for (int i = 0; i < result.count; ++i) {
    for_each_covered_pixel(pieces[static_cast<std::size_t>(i)], [&](int x, int y, float nearness) {
      seen = seen || nearness > raster.nearness(x, y);
    });
  }
  return seen;
}

/// Does anything show of what may lie in a box: its faces, and triangles between points in it?
bool shows(const DepthRaster& raster, const Aabb& box, Random& random) {
  const auto corner = [&](unsigned i) {
    return glm::dvec3((i & 1U) != 0 ? box.max.x : box.min.x, (i & 2U) != 0 ? box.max.y : box.min.y,
                      (i & 4U) != 0 ? box.max.z : box.min.z);
  };
  constexpr std::array<std::array<unsigned, 4>, 6> faces{
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  for (const auto& f : faces) {
    if (shows(raster, {corner(f[0]), corner(f[1]), corner(f[2])}, random)) return true;
    if (shows(raster, {corner(f[0]), corner(f[2]), corner(f[3])}, random)) return true;
  }
  return false;
}

bool bit(const std::vector<std::uint64_t>& bits, std::size_t i) {
  return ((bits[i / 64] >> (i % 64)) & 1U) != 0;
}

std::vector<std::uint64_t> visible_of(BoxQueries& queries, const DepthRaster& raster) {
  std::vector<std::uint64_t> visible(BoxQueries::words_of(queries.size()), ~std::uint64_t{0});
  queries.test(raster, visible);
  return visible;
}

/// By the twins without SIMD, box by box.
bool visible_scalar(const DepthRaster& raster, const Aabb& box) {
  BoxColumns block;
  block.present = 1;
  for (int axis = 0; axis < 3; ++axis) {
    block.rows[static_cast<std::size_t>(axis)][0] = box.min[axis];
    block.rows[static_cast<std::size_t>(axis) + 3][0] = box.max[axis];
  }
  ColumnPlaces places;
  place_columns_scalar(ColumnView(raster.window(), raster.coverage()), block, places);
  if (places.undecided != 0) return true;
  if (places.inside == 0) return false;
  return !hides_silhouette_scalar(raster.tiles(), places.window(0),
                                  PixelRays(raster.window(), raster.coverage()).planes_of(box));
}

TEST(BoxColumns, ArePlacedWithTheSameBitsByAllInstructionSets) {
  Random random(1);
  std::uint32_t inside = 0, undecided = 0;
  for (int trial = 0; trial < 10 * trials; ++trial) {
    const bool adversarial = trial % 2 == 1;
    const Viewport size{static_cast<int>(1 + random.below(2000)),
                        static_cast<int>(1 + random.below(2000))};
    const Camera camera =
        adversarial ? test::adversarial_camera(random) : random_camera(random, size);
    const ColumnView view(WindowTransform(camera, size),
                          random.below(2) == 0 ? Coverage::centres : Coverage::whole_pixels);
    BoxColumns boxes;
    boxes.present = static_cast<std::uint32_t>(random.below(1U << 16U)) | 1U;
    boxes.always = static_cast<std::uint32_t>(random.below(1U << 16U)) & boxes.present & 0x1111U;
    for (std::size_t column = 0; column < BoxColumns::width; ++column) {
      Aabb box = random_box(random, test::log_uniform(random, 1.0, 1000.0),
                            test::log_uniform(random, 0.01, 100.0));
      if (adversarial) {
        box.min += glm::vec3(camera.pose.eye);
        box.max += glm::vec3(camera.pose.eye);
      }
      // Each column in its turn holds a box around the eye, and the next one a box in the image.
      const auto place = static_cast<std::size_t>(trial / 2 + 1) % BoxColumns::width;
      const auto next = (place + 1) % BoxColumns::width;
      if (!adversarial && (column == place || column == next)) {
        const Ray ray = camera.ray({0.5, 0.5});
        const bool around = column == place;
        const glm::vec3 center(around ? camera.pose.eye
                                      : ray.origin + 20.0 * glm::normalize(ray.direction));
        box = {center - (around ? 16.0F : 0.5F), center + (around ? 16.0F : 0.5F)};
        boxes.present |= 1U << column;
        boxes.always &= ~(1U << column);
      }
      for (int axis = 0; axis < 3; ++axis) {
        boxes.rows[static_cast<std::size_t>(axis)][column] = box.min[axis];
        boxes.rows[static_cast<std::size_t>(axis) + 3][column] = box.max[axis];
      }
    }
    ColumnPlaces expected;
    place_columns_scalar(view, boxes, expected);
    inside |= expected.inside;
    undecided |= expected.undecided;
    for (const std::string& target : simd_targets()) {
      const SimdTargetScope scope(target);
      ColumnPlaces places;
      place_columns(view, boxes, places);
      ASSERT_EQ(places.inside, expected.inside) << target << " trial " << trial;
      ASSERT_EQ(places.undecided, expected.undecided) << target << " trial " << trial;
      for (std::uint32_t left = expected.inside; left != 0; left &= left - 1) {
        const auto column = static_cast<std::size_t>(std::countr_zero(left));
        ASSERT_EQ(places.window(column), expected.window(column)) << target << " trial " << trial;
      }
    }
  }
  EXPECT_EQ(inside, 0xFFFFU);
  EXPECT_EQ(undecided, 0xFFFFU);
}

TEST(BoxColumns, HaveTheWindowOfDoublePrecisionOrABitMore) {
  Random random(2);
  int wider = 0, compared = 0;
  for (int trial = 0; trial < 200 * trials; ++trial) {
    const Viewport size{320, 200};
    const WindowTransform window(random_camera(random, size), size);
    const Aabb box = random_box(random, 20.0, 1.5);
    BoxColumns block;
    block.present = 1;
    for (int axis = 0; axis < 3; ++axis) {
      block.rows[static_cast<std::size_t>(axis)][0] = box.min[axis];
      block.rows[static_cast<std::size_t>(axis) + 3][0] = box.max[axis];
    }
    ColumnPlaces places;
    place_columns(ColumnView(window, Coverage::centres), block, places);
    BoxWindow exact;
    if (project_box(window, box, Coverage::centres, exact) != BoxPlace::inside) continue;
    ASSERT_EQ(places.undecided, 0U);
    if (places.inside == 0) continue;  // the image's sides tell more than the rectangle
    const BoxWindow found = places.window(0);
    // Both keep a margin; float's covers the rounding of float.
    EXPECT_LE(found.x0, exact.x0);
    EXPECT_LE(found.y0, exact.y0);
    EXPECT_GE(found.x1, exact.x1);
    EXPECT_GE(found.y1, exact.y1);
    EXPECT_NEAR(found.nearness, exact.nearness, 1e-4 * std::abs(exact.nearness) + 1e-4);
    ++compared;
    if (found.x1 - found.x0 + found.y1 - found.y0 > exact.x1 - exact.x0 + exact.y1 - exact.y0) {
      ++wider;
    }
  }
  EXPECT_GT(compared, 100);
  EXPECT_LT(wider * 50, compared);
}

TEST(BoxQueries, GiveTheSameAnswersWithAllInstructionSetsAndWithout) {
  Random random(3);
  for (int trial = 0; trial < trials; ++trial) {
    const Viewport size{static_cast<int>(20 + random.below(200)),
                        static_cast<int>(20 + random.below(150))};
    RasterOptions options;
    if (random.below(3) == 0) {
      options.setup = {Coverage::whole_pixels, DepthRounding::lowered};
    }
    DepthRaster raster(size, options);
    raster.begin(random_camera(random, size));
    draw(raster, random_walls(random, 6));
    const std::vector<Aabb> boxes = random_boxes(random, 700);
    BoxQueries queries(boxes);
    std::vector<std::uint64_t> expected(BoxQueries::words_of(boxes.size()));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (visible_scalar(raster, boxes[i])) expected[i / 64] |= std::uint64_t{1} << (i % 64);
    }
    for (const std::string& target : simd_targets()) {
      const SimdTargetScope scope(target);
      ASSERT_EQ(visible_of(queries, raster), expected) << target << " trial " << trial;
    }
  }
}

TEST(BoxQueries, HideNothingThatShowsAtAPixel) {
  Random random(4);
  int hidden = 0, shown = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Viewport size{static_cast<int>(20 + random.below(200)),
                        static_cast<int>(20 + random.below(150))};
    DepthRaster raster(size, {});
    raster.begin(random_camera(random, size));
    draw(raster, random_walls(random, 6));
    const std::vector<Aabb> boxes = random_boxes(random, 500);
    BoxQueries queries(boxes);
    const auto visible = visible_of(queries, raster);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const bool seen = shows(raster, boxes[i], random);
      hidden += seen ? 0 : 1;
      shown += seen ? 1 : 0;
      ASSERT_TRUE(!seen || bit(visible, i)) << "trial " << trial << " box " << i;
      ASSERT_TRUE(!seen || !raster.hides(boxes[i])) << "trial " << trial << " box " << i;
    }
  }
  EXPECT_GT(hidden, 100);
  EXPECT_GT(shown, 100);
}

TEST(BoxQueries, FindNearlyAllThatDoesNotShow) {
  Random random(5);
  int missed = 0, missed_by_rectangles = 0, hidden = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Viewport size{300, 200};
    DepthRaster raster(size, {});
    raster.begin(camera_at(test::random_vector(random, 4.0) + glm::dvec3(0.0, 0.0, 14.0), {}));
    draw(raster, random_walls(random, 6));
    // Larger than pixels: what is smaller may lie beside a centre by less than the margins.
    std::vector<Aabb> boxes = random_boxes(random, 500);
    for (Aabb& box : boxes) {
      const glm::dvec3 center = box.center(), half = glm::max(box.half_size(), 0.3);
      box = {glm::vec3(center - half), glm::vec3(center + half)};
    }
    BoxQueries queries(boxes);
    const auto visible = visible_of(queries, raster);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      BoxWindow window;
      if (project_box(raster.window(), boxes[i], Coverage::centres, window) != BoxPlace::inside ||
          shows(raster, boxes[i], random)) {
        continue;
      }
      ++hidden;
      missed += bit(visible, i) ? 1 : 0;
      missed_by_rectangles += raster.hides(window) ? 0 : 1;
    }
  }
  EXPECT_GT(hidden, trials);
  EXPECT_GT(missed_by_rectangles, trials / 4);
  EXPECT_LE(missed * 8, missed_by_rectangles);
}

TEST(BoxQueries, AtLowResolutionHideNothingThatShowsAtAnyHigherOne) {
  Random random(6);
  int hidden = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Viewport low{60, 40}, high{240, 160};
    const Camera camera = random_camera(random, high);
    const Mesh walls = random_walls(random, 4);
    DepthRaster coarse(low, {{Coverage::whole_pixels, DepthRounding::lowered}, false, 1});
    DepthRaster fine(high, {});
    coarse.begin(camera);
    fine.begin(camera);
    draw(coarse, walls);
    draw(fine, walls);
    const std::vector<Aabb> boxes = random_boxes(random, 300);
    BoxQueries queries(boxes);
    const auto visible = visible_of(queries, coarse);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      hidden += bit(visible, i) ? 0 : 1;
      ASSERT_TRUE(bit(visible, i) || !shows(fine, boxes[i], random)) << "trial " << trial;
    }
  }
  EXPECT_GT(hidden, 100);
}

TEST(BoxQueries, HideABoxWhoseSilhouetteIsHiddenThoughItsRectangleIsNot) {
  // The wall's upper edge is the diagonal x + y = 0 of the image.
  Mesh wall;
  wall.positions = {{-10.0F, -10.0F, -5.0F}, {10.0F, -10.0F, -5.0F}, {-10.0F, 10.0F, -5.0F}};
  wall.triangles = {{0, 1, 2}};
  DepthRaster raster({512, 512}, {});
  raster.begin({look_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}),
                perspective_lens(std::numbers::pi / 2.0, 1.0, 0.1, 100.0)});
  draw(raster, wall);
  // Deep boxes: all of the first is below the diagonal, but the left end of its far side and the
  // upper end of its near side make a corner of the rectangle that is not.
  const std::vector<Aabb> boxes{{{-4.0F, -3.0F, -60.0F}, {-0.3F, 0.25F, -6.0F}},
                                {{-4.0F, -3.0F, -60.0F}, {-0.3F, 0.4F, -6.0F}}};
  BoxWindow window;
  ASSERT_EQ(project_box(raster.window(), boxes[0], Coverage::centres, window), BoxPlace::inside);
  EXPECT_FALSE(raster.hides(window));
  EXPECT_TRUE(raster.hides(boxes[0]));
  EXPECT_FALSE(raster.hides(boxes[1]));
  BoxQueries queries(boxes);
  EXPECT_EQ(visible_of(queries, raster), std::vector<std::uint64_t>{0b10});
}

TEST(BoxQueries, FollowBoxesThatMove) {
  Random random(7);
  const Viewport size{160, 90};
  DepthRaster raster(size, {});
  raster.begin(camera_at({0.0, 0.0, 15.0}, {}));
  draw(raster, random_walls(random, 5));
  std::vector<Aabb> boxes = random_boxes(random, 1000);
  BoxQueries moved(boxes);
  for (int step = 0; step < 3; ++step) {
    for (std::uint32_t id = static_cast<std::uint32_t>(step); id < 1000; id += 3) {
      boxes[id] = random_box(random, 20.0, 1.5);
      if (id % 50 == 0) boxes[id].min.x = nan;
      moved.update(id, boxes[id]);
    }
    BoxQueries anew(boxes);
    ASSERT_EQ(visible_of(moved, raster), visible_of(anew, raster)) << step;
  }
}

TEST(BoxQueries, OfSomeBoxesLeaveTheOthersAlone) {
  Random random(8);
  const Viewport size{160, 90};
  DepthRaster raster(size, {});
  raster.begin(camera_at({0.0, 0.0, 15.0}, {}));
  draw(raster, random_walls(random, 5));
  BoxQueries queries(random_boxes(random, 300));
  const auto all = visible_of(queries, raster);
  for (const std::uint64_t before : {std::uint64_t{0}, ~std::uint64_t{0}}) {
    std::vector<std::uint64_t> some(BoxQueries::words_of(300), before);
    std::vector<std::uint32_t> ids;
    for (std::uint32_t id = 7; id < 300; id += 5) ids.push_back(id);
    queries.test(raster, ids, some);
    for (std::uint32_t id = 0; id < 300; ++id) {
      EXPECT_EQ(bit(some, id), id >= 7 && (id - 7) % 5 == 0 ? bit(all, id) : before != 0) << id;
    }
  }
}

TEST(BoxQueries, KeepWhatIsNotValidHoldsTheEyeOrCrossesTheNearPlane) {
  Mesh wall;  // before everything
  wall.positions = {{-1e3F, -1e3F, -0.5F}, {1e3F, -1e3F, -0.5F}, {0.0F, 1e3F, -0.5F}};
  wall.triangles = {{0, 1, 2}};
  DepthRaster raster({64, 64}, {});
  raster.begin(camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}));
  draw(raster, wall);
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<Aabb> boxes{
      {{-1.0F, -1.0F, -1.0F}, {1.0F, 1.0F, 1.0F}},   // holds the eye
      {{-1.0F, -1.0F, -1.0F}, {1.0F, 1.0F, -0.3F}},  // touches the near plane
      {{nan, -1.0F, -9.0F}, {1.0F, 1.0F, -8.0F}},
      {{-1.0F, -1.0F, -9.0F}, {1.0F, infinity, -8.0F}},
      {},  // empty
      {{-1.0F, -1.0F, -1e30F}, {1.0F, 1.0F, -1e29F}},
      {{-1.0F, -1.0F, -9.0F}, {1.0F, 1.0F, -8.0F}},      // behind the wall
      {{-1.0F, -1.0F, 8.0F}, {1.0F, 1.0F, 9.0F}},        // behind the eye
      {{-1.0F, -1.0F, -500.0F}, {1.0F, 1.0F, -400.0F}},  // beyond the far plane
      {{20.0F, 0.0F, -3.0F}, {21.0F, 1.0F, -2.0F}},      // beside the image
      {{0.0F, 0.0F, -9.0F}, {0.0F, 0.0F, -9.0F}},        // a point behind the wall
  };
  BoxQueries queries(boxes);
  EXPECT_EQ(visible_of(queries, raster), std::vector<std::uint64_t>{0b111111});
}

TEST(BoxQueries, OfAnEmptyImageSeeWhatIsBeforeTheFarPlane) {
  DepthRaster raster({1, 1}, {});
  raster.begin(camera_at({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}));
  BoxQueries queries({});
  EXPECT_TRUE(visible_of(queries, raster).empty());
  BoxQueries some(std::vector<Aabb>{{{-1.0F, -1.0F, -9.0F}, {1.0F, 1.0F, -8.0F}},
                                    {{-200.0F, -200.0F, -299.9F}, {200.0F, 200.0F, -299.0F}},
                                    {{-200.0F, -200.0F, -302.0F}, {200.0F, 200.0F, -300.1F}}});
  EXPECT_EQ(visible_of(some, raster), std::vector<std::uint64_t>{0b011});
}

}  // namespace
}  // namespace vislab
