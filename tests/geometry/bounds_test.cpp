#include "common/geometry/bounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/geometry/random.h"
#include "common/geometry/rounding.h"

namespace vislab {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

/// 113 bits: sums and products of a few floats and doubles are exact enough to be the truth.
using Exact = __float128;

glm::vec3 random_point(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach),
          random.uniform(-reach, reach)};
}

Aabb random_box(Random& random) {
  Aabb box;
  box.extend(random_point(random, 100.0));
  box.extend(random_point(random, 100.0));
  return box;
}

glm::vec3 corner(const Aabb& box, int index) {
  return {(index & 1) != 0 ? box.max.x : box.min.x, (index & 2) != 0 ? box.max.y : box.min.y,
          (index & 4) != 0 ? box.max.z : box.min.z};
}

TEST(Aabb, IsEmptyUntilItIsExtended) {
  Aabb box;
  EXPECT_TRUE(box.empty());
  EXPECT_FALSE(box.valid());
  box.extend(glm::vec3(1.0F, 2.0F, 3.0F));
  EXPECT_FALSE(box.empty());
  EXPECT_TRUE(box.valid());
  EXPECT_EQ(box.min, box.max);
}

TEST(Aabb, IsNotValidWithBoundsThatAreNotFinite) {
  const Aabb good{glm::vec3(-1.0F), glm::vec3(1.0F)};
  EXPECT_TRUE(good.valid());
  for (const float bad : {infinity, -infinity, not_a_number}) {
    for (int axis = 0; axis < 3; ++axis) {
      Aabb low = good;
      low.min[axis] = bad;
      EXPECT_FALSE(low.valid());
      Aabb high = good;
      high.max[axis] = bad;
      EXPECT_FALSE(high.valid());
    }
  }
}

TEST(Aabb, IsNotValidIfItsExtentOverflows) {
  EXPECT_FALSE((Aabb{glm::vec3(-3e38F), glm::vec3(3e38F)}.valid()));
}

TEST(Bounds, ATransformedBoxHoldsEveryTransformedCornerInExactArithmetic) {
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const Aabb box = random_box(random);
    glm::dmat4x3 transform(1.0);
    for (int column = 0; column < 4; ++column) {
      const double reach = column == 3 ? 1e6 : 2.0;
      for (int row = 0; row < 3; ++row) transform[column][row] = random.uniform(-reach, reach);
    }
    const Aabb result = transformed(box, transform);
    for (int k = 0; k < 8; ++k) {
      const glm::vec3 p = corner(box, k);
      for (int row = 0; row < 3; ++row) {
        Exact value = transform[3][row];
        for (int column = 0; column < 3; ++column) {
          value += static_cast<Exact>(transform[column][row]) * static_cast<Exact>(p[column]);
        }
        ASSERT_LE(static_cast<Exact>(result.min[row]), value);
        ASSERT_GE(static_cast<Exact>(result.max[row]), value);
      }
    }
  }
}

TEST(Bounds, ATransformedBoxHoldsCornersThatDoubleRoundsOntoAFloat) {
  // The corners are at 1 ± 2^-60: double, and so float, would put the box's faces at 1.
  const Aabb box{glm::vec3(-1.0F), glm::vec3(1.0F)};
  glm::dmat4x3 transform(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    transform[axis][axis] = 0x1p-60;
    transform[3][axis] = 1.0;
  }
  const Aabb result = transformed(box, transform);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(result.min[axis], 1.0F);
    EXPECT_GT(result.max[axis], 1.0F);
  }
}

TEST(Bounds, ATransformedBoxIsNoLargerThanRoundingNeeds) {
  const Aabb box{glm::vec3(-1.0F), glm::vec3(1.0F)};
  const Aabb result = transformed(box, glm::dmat4x3(1.0));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(result.min[axis], -1.0F, 2e-7F);
    EXPECT_NEAR(result.max[axis], 1.0F, 2e-7F);
  }
}

TEST(Bounds, AnEmptyBoxStaysEmptyWhenTransformed) {
  EXPECT_TRUE(transformed(Aabb(), glm::dmat4x3(2.0)).empty());
}

TEST(Bounds, TheCircumscribedSphereHoldsEveryCornerInExactArithmetic) {
  Random random(12);
  for (int i = 0; i < 5000; ++i) {
    const Aabb box = random_box(random);
    const Sphere sphere = circumscribed(box);
    for (int k = 0; k < 8; ++k) {
      const glm::vec3 p = corner(box, k);
      Exact squared = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const Exact gap = static_cast<Exact>(p[axis]) - static_cast<Exact>(sphere.center[axis]);
        squared += gap * gap;
      }
      const auto radius = static_cast<Exact>(sphere.radius);
      ASSERT_LE(squared, radius * radius);
    }
  }
}

TEST(Bounds, DistanceIsZeroInsideAndMeasuredToTheNearestPointOutside) {
  const Aabb box{glm::vec3(-1.0F), glm::vec3(1.0F)};
  EXPECT_EQ(distance_squared(box, {0.5, -0.5, 1.0}), 0.0);
  EXPECT_EQ(distance_squared(box, {3.0, 0.0, 0.0}), 4.0);
  EXPECT_EQ(distance_squared(box, {2.0, -3.0, 3.0}), 1.0 + 4.0 + 4.0);
}

TEST(Plane, ThroughThreePointsIsInsideWhereTheyAppearCounterClockwise) {
  const Plane plane = plane_through({0.0, 0.0, 2.0}, {1.0, 0.0, 2.0}, {0.0, 1.0, 2.0});
  EXPECT_DOUBLE_EQ(plane.signed_distance({5.0, 7.0, 3.0}), 1.0);
  EXPECT_DOUBLE_EQ(plane.signed_distance({0.0, 0.0, 0.0}), -2.0);
}

TEST(Rounding, ToTheNearestFloatLeavesNoMoreDigitsThanAFloatHas) {
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 v(random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0),
                       random.uniform(-9.0, 9.0));
    const glm::dvec3 rounded = rounded_to_float(v);
    for (int axis = 0; axis < 3; ++axis) {
      int exponent = 0;
      const double digits = std::ldexp(std::frexp(rounded[axis], &exponent), 24);
      EXPECT_EQ(digits, std::floor(digits));
      EXPECT_LE(std::abs(rounded[axis] - v[axis]), std::ldexp(1.0, exponent - 25));
    }
  }
}

}  // namespace
}  // namespace vislab
