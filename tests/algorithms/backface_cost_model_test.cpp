#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/backface/culling_volume.h"
#include "tests/algorithms/facing_worlds.h"

namespace vislab {
namespace {

using namespace backface_culling;

#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
constexpr int effort = 1;
#else
constexpr int effort = 10;
#endif

TEST(CostModel, JoinsWhereItSavesTimeAndNotAsPrinted) {
  Random random(5);
  int joined = 0;
  int differ = 0;
  for (int i = 0; i < 10000; ++i) {
    const ClusterOdds a{random.uniform(), 1.0 + double(random.below(50))};
    const ClusterOdds b{random.uniform(), 1.0 + double(random.below(50))};
    const double probability = std::min(a.probability, b.probability) * random.uniform(0.5, 1.0);
    const double test_cost = random.uniform(0.0, 20.0);
    const double n = a.triangles + b.triangles;
    const double apart =
        2.0 * test_cost + (1.0 - a.probability) * a.triangles + (1.0 - b.probability) * b.triangles;
    const double together = test_cost + (1.0 - probability) * n;
    if (std::abs(apart - together) < 1e-9) continue;
    const bool should = should_join(a, b, probability, test_cost, JoinRule::derived);
    EXPECT_EQ(should, together < apart);
    joined += should ? 1 : 0;
    // C is culled no more often than A and B both are, so that nothing is ever joined.
    const bool printed = should_join(a, b, probability, test_cost, JoinRule::printed);
    EXPECT_FALSE(printed);
    differ += printed != should ? 1 : 0;
  }
  EXPECT_GT(joined, 1000);
  EXPECT_EQ(differ, joined);
}

double sampled_volume(const ClusterBound& bound, const Aabb& box, Random& random, int samples) {
  int inside = 0;
  for (int i = 0; i < samples; ++i) {
    double value = -double(bound.back);
    for (int axis = 0; axis < 3; ++axis) {
      const double e = random.uniform(box.min[axis], box.max[axis]) - bound.origin[axis];
      value += e * (e > 0.0 ? bound.high[axis] : bound.low[axis]);
    }
    inside += value <= 0.0 ? 1 : 0;
  }
  const glm::dvec3 extent = 2.0 * box.half_size();
  return extent.x * extent.y * extent.z * inside / samples;
}

TEST(CullingVolume, IsThatOfTheTestsOctantByOctant) {
  Random random(11);
  constexpr int samples = 4000;
  int partly = 0;
  for (int i = 0; i < 100 * effort; ++i) {
    const auto vector = [&](double reach) { return glm::vec3(test::vector_in(random, reach)); };
    ClusterBound bound;
    bound.origin = vector(1.0);
    const glm::vec3 one = vector(1.0), other = vector(1.0);
    bound.low = glm::min(one, other);
    bound.high = glm::max(one, other);
    // Also flat patches along the axes: coefficients that are zero, or nearly.
    for (int axis = 0; axis < 3; ++axis) {
      const auto kind = random.below(6);
      if (kind == 0) bound.low[axis] = bound.high[axis] = 0.0F;
      if (kind == 1) bound.low[axis] = 0.0F, bound.high[axis] = 1e-6F;
      if (kind == 2) bound.low[axis] = -1e-20F, bound.high[axis] = 0.5F;
    }
    bound.back = static_cast<float>(random.uniform(-1.0, 1.0));
    Aabb box;
    box.extend(vector(3.0));
    box.extend(vector(3.0));
    const glm::dvec3 extent = 2.0 * box.half_size();
    const double all = extent.x * extent.y * extent.z;
    const double volume = culling_volume(bound, box);
    EXPECT_GE(volume, 0.0);
    EXPECT_LE(volume, all * (1.0 + 1e-12));
    const double sampled = sampled_volume(bound, box, random, samples);
    EXPECT_NEAR(volume / all, sampled / all, 4.5 * 0.5 / std::sqrt(double(samples))) << i;
    partly += sampled > 0.02 * all && sampled < 0.98 * all ? 1 : 0;
  }
  EXPECT_GT(partly, 20 * effort);
}

TEST(CullingVolume, OfAFlatPatchIsClippedToTheBox) {
  // One plane, z = 0 seen from +z: its culling volume has no end.
  ClusterBound bound;
  bound.low = bound.high = {0.0F, 0.0F, 1.0F};
  bound.back = bound.front = 0.0F;
  EXPECT_DOUBLE_EQ(culling_volume(bound, {glm::vec3(-2.0F), glm::vec3(2.0F)}), 32.0);
  EXPECT_DOUBLE_EQ(culling_volume(bound, {{-1.0F, -1.0F, -1.0F}, {1.0F, 1.0F, 3.0F}}), 4.0);
  EXPECT_DOUBLE_EQ(culling_volume(bound, {{-1.0F, -1.0F, 1.0F}, {1.0F, 1.0F, 3.0F}}), 0.0);
  EXPECT_DOUBLE_EQ(culling_volume(bound, {glm::vec3(1.0F), glm::vec3(1.0F)}), 0.0);
  EXPECT_DOUBLE_EQ(culling_volume(ClusterBound(), {glm::vec3(-2.0F), glm::vec3(2.0F)}), 0.0);
}

}  // namespace
}  // namespace vislab
