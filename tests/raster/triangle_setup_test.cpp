#include "common/raster/triangle_setup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/random.h"

namespace vislab {
namespace {

/// A camera at the origin that looks along -z, whose pixels are 1/32 m wide at depth 1 m.
Camera plain_camera(const Viewport& size) {
  Camera camera;
  camera.lens.right = size.width / 64.0;
  camera.lens.left = -camera.lens.right;
  camera.lens.top = size.height / 64.0;
  camera.lens.bottom = -camera.lens.top;
  camera.lens.near_m = 1.0;
  camera.lens.far_m = 100.0;
  return camera;
}

/// What is at a window position at some depth.
WindowPoint at(double x, double y, double depth) { return {x * depth, y * depth, depth}; }

TEST(TriangleSetup, FansCoverEveryPixelExactlyOnce) {
  const Viewport size{64, 48};
  const WindowTransform window(plain_camera(size), size);
  Random random(31);
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<int> count(64 * 48, 0);
    // Around a point; half of the points are on pixel centres and corners, so are edges.
    const auto coordinate = [&](double range) {
      const double x = random.uniform(0.0, range);
      return trial % 2 == 0 ? std::floor(2.0 * x) / 2.0 : x;
    };
    const WindowPoint middle = at(coordinate(64.0), coordinate(48.0), random.uniform(2.0, 9.0));
    const std::array<std::array<double, 2>, 4> frame{
        {{-9.0, -9.0}, {80.0, -9.0}, {80.0, 60.0}, {-9.0, 60.0}}};
    std::vector<WindowPoint> around;
    for (std::size_t side = 0; side < 4; ++side) {
      const auto& from = frame[side];
      const auto& to = frame[(side + 1) % 4];
      for (int i = 0; i < 5; ++i) {
        const double t = trial % 2 == 0 ? i / 5.0 : (i == 0 ? 0.0 : (i + random.uniform()) / 6.0);
        around.push_back(at(from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]), 4.0));
      }
    }
    for (std::size_t i = 0; i < around.size(); ++i) {
      std::array<SetupTriangle, max_setup_pieces> pieces;
      const SetupResult result = set_up_triangle(
          window, {middle, around[i], around[(i + 1) % around.size()]}, 0, {}, pieces);
      for (int piece = 0; piece < result.count; ++piece) {
        for_each_covered_pixel(pieces[static_cast<std::size_t>(piece)], [&](int x, int y, float) {
          ++count[static_cast<std::size_t>(y * 64 + x)];
        });
      }
    }
    EXPECT_EQ(std::ranges::count(count, 1), 64 * 48) << "trial " << trial;
  }
}

TEST(TriangleSetup, TrianglesOnAGridOfPixelCentresCoverEveryPixelExactlyOnce) {
  const Viewport size{40, 24};
  const WindowTransform window(plain_camera(size), size);
  std::vector<int> count(40 * 24, 0);
  Random random(34);
  for (int j = -1; j < 24; j += 3) {
    for (int i = -1; i < 40; i += 5) {
      const auto corner = [&](int right, int up) {
        return at(i + 0.5 + 5 * right, j + 0.5 + 3 * up, 4.0);
      };
      const bool other = random.below(2) == 0;
      for (const auto& t :
           {std::array{corner(0, 0), corner(1, 0), other ? corner(1, 1) : corner(0, 1)},
            std::array{corner(0, 1), corner(1, 1), other ? corner(0, 0) : corner(1, 0)}}) {
        std::array<SetupTriangle, max_setup_pieces> pieces;
        const SetupResult result = set_up_triangle(window, t, 0, {}, pieces);
        for (int piece = 0; piece < result.count; ++piece) {
          for_each_covered_pixel(pieces[static_cast<std::size_t>(piece)], [&](int x, int y, float) {
            ++count[static_cast<std::size_t>(y * 40 + x)];
          });
        }
      }
    }
  }
  EXPECT_EQ(std::ranges::count(count, 1), 40 * 24);
}

struct Corners {
  std::array<WindowPoint, 3> p;
};

/// By how much a window position lies inside of the triangle's edges, in pixels; the triangle is
/// counter-clockwise or not.
double inside_by(const Corners& t, double x, double y) {
  double least = INFINITY;
  const auto px = [&](std::size_t i) { return t.p[i % 3].x / t.p[i % 3].depth; };
  const auto py = [&](std::size_t i) { return t.p[i % 3].y / t.p[i % 3].depth; };
  const double area = (px(1) - px(0)) * (py(2) - py(0)) - (py(1) - py(0)) * (px(2) - px(0));
  for (std::size_t i = 0; i < 3; ++i) {
    const double dx = px(i + 1) - px(i), dy = py(i + 1) - py(i);
    const double side = (dx * (y - py(i)) - dy * (x - px(i))) / std::hypot(dx, dy);
    least = std::min(least, area > 0.0 ? side : -side);
  }
  return least;
}

/// The nearness of the triangle's plane at a window position.
double exact_nearness(const Corners& t, double x, double y) {
  const auto px = [&](std::size_t i) { return static_cast<long double>(t.p[i].x) / t.p[i].depth; };
  const auto py = [&](std::size_t i) { return static_cast<long double>(t.p[i].y) / t.p[i].depth; };
  const long double ux = px(1) - px(0), uy = py(1) - py(0), vx = px(2) - px(0), vy = py(2) - py(0);
  const long double qx = x - px(0), qy = y - py(0), area = ux * vy - uy * vx;
  const long double s = (qx * vy - qy * vx) / area, r = (ux * qy - uy * qx) / area;
  const auto n = [&](std::size_t i) { return 1.0L / t.p[i].depth; };
  return static_cast<double>(n(0) + s * (n(1) - n(0)) + r * (n(2) - n(0)));
}

TEST(TriangleSetup, LoweredDepthsAndWholePixelsAreNeverTooMuch) {
  const Viewport size{160, 90};
  const WindowTransform window(plain_camera(size), size);
  Random random(32);
  std::size_t covered = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double reach = trial % 3 == 0 ? 8.0 : 90.0;
    const double x0 = random.uniform(0.0, 160.0), y0 = random.uniform(0.0, 90.0);
    Corners t;
    for (WindowPoint& p : t.p) {
      p = at(x0 + random.uniform(-reach, reach), y0 + random.uniform(-reach, reach),
             random.uniform(1.5, 40.0));
    }
    for (const Coverage coverage : {Coverage::centres, Coverage::whole_pixels}) {
      std::array<SetupTriangle, max_setup_pieces> pieces;
      const SetupResult result =
          set_up_triangle(window, t.p, 0, {coverage, DepthRounding::lowered}, pieces);
      for (int piece = 0; piece < result.count; ++piece) {
        for_each_covered_pixel(pieces[static_cast<std::size_t>(piece)],
                               [&](int x, int y, float nearness) {
                                 ++covered;
                                 if (coverage == Coverage::centres) {
                                   EXPECT_LE(nearness, exact_nearness(t, x + 0.5, y + 0.5));
                                   return;
                                 }
                                 for (int corner = 0; corner < 4; ++corner) {
                                   const double cx = x + (corner & 1), cy = y + corner / 2;
                                   EXPECT_GE(inside_by(t, cx, cy), 0.0);
                                   EXPECT_LE(nearness, exact_nearness(t, cx, cy));
                                 }
                               });
      }
    }
  }
  EXPECT_GT(covered, 100'000U);
}

TEST(TriangleSetup, LoweredTrianglesThatLeaveTheImageStayWithinTheirEdges) {
  const Viewport size{160, 90};
  const WindowTransform window(plain_camera(size), size);
  Random random(33);
  std::size_t covered = 0, beside = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    // An edge runs past the centre of a pixel by about what snapping can move it, and out of the
    // image.
    const int x = static_cast<int>(random.below(160)), y = static_cast<int>(random.below(90));
    const double turn = random.uniform(0.0, 6.283);
    const double dx = std::cos(turn), dy = std::sin(turn);
    const double past = random.uniform(-2.0, 2.0) / 256.0;
    const double cx = x + 0.5 - dy * past, cy = y + 0.5 + dx * past;
    const auto along = [&](double far, double aside) {
      return at(cx + far * dx - aside * dy, cy + far * dy + aside * dx, random.uniform(1.5, 40.0));
    };
    const Corners t{{along(-random.uniform(200.0, 400.0), 0.0),
                     along(random.uniform(5.0, 90.0), 0.0),
                     along(random.uniform(-50.0, 50.0), random.uniform(20.0, 90.0))}};
    std::array<SetupTriangle, max_setup_pieces> pieces;
    const SetupResult result =
        set_up_triangle(window, t.p, 0, {Coverage::centres, DepthRounding::lowered}, pieces);
    ASSERT_LE(result.count, 1);
    const bool exact = inside_by(t, x + 0.5, y + 0.5) >= 0.0;
    const bool drawn = result.count == 1 && pieces[0].covers(x, y);
    EXPECT_FALSE(drawn && !exact) << trial;
    covered += drawn ? 1 : 0;
    beside += exact ? 0 : 1;
  }
  EXPECT_GT(covered, 200U);
  EXPECT_GT(beside, 1000U);
}

TEST(TriangleSetup, PairsAreThePartitionOfTheirQuadrilateral) {
  const Viewport size{160, 90};
  const WindowTransform window(plain_camera(size), size);
  Random random(33);
  int joined = 0;
  for (int trial = 0; trial < 500; ++trial) {
    // A parallelogram in space.
    std::array<WindowPoint, 4> p;
    p[0] = at(random.uniform(0.0, 160.0), random.uniform(0.0, 90.0), random.uniform(5.0, 20.0));
    for (std::size_t i : {1U, 3U}) {
      const WindowPoint to =
          at(random.uniform(0.0, 160.0), random.uniform(0.0, 90.0), random.uniform(5.0, 20.0));
      p[i] = to;
    }
    p[2] = {p[1].x + p[3].x - p[0].x, p[1].y + p[3].y - p[0].y,
            p[1].depth + p[3].depth - p[0].depth};
    SetupResult result;
    std::array<SetupTriangle, 2> pair;
    if (!set_up_pair(window, p, 7, {}, result, pair)) continue;
    ++joined;
    for (int half = 0; half < result.count; ++half) {
      const auto i = static_cast<std::size_t>(half);
      EXPECT_EQ(pair[i].id, 7 + i);
      std::array<SetupTriangle, max_setup_pieces> alone;
      const SetupResult one = set_up_triangle(window, {p[0], p[1 + i], p[2 + i]}, 7, {}, alone);
      for (int y = 0; y < 90; ++y) {
        for (int x = 0; x < 160; ++x) {
          EXPECT_EQ(pair[i].covers(x, y) && one.count > 0, one.count > 0 && alone[0].covers(x, y));
        }
      }
      EXPECT_EQ(one.facing, result.facing);
    }
  }
  EXPECT_GT(joined, 300);
}

TEST(TriangleSetup, WhatIsNotFiniteIsNotDrawn) {
  const Viewport size{16, 16};
  const WindowTransform window(plain_camera(size), size);
  std::array<SetupTriangle, max_setup_pieces> pieces;
  for (const double bad : {std::nan(""), static_cast<double>(INFINITY)}) {
    EXPECT_EQ(
        set_up_triangle(window, {at(1, 1, 2), at(9, 1, 2), {bad, 2.0, 2.0}}, 0, {}, pieces).count,
        0);
  }
}

}  // namespace
}  // namespace vislab
