#include "common/spatial/morton.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/geometry/random.h"

namespace vislab {
namespace {

TEST(Morton, InterleavesTheCellsBits) {
  const MortonGrid grid({glm::vec3(0.0F), glm::vec3(1024.0F)});
  EXPECT_EQ(grid.code(glm::vec3(0.5F)), 0U);
  EXPECT_EQ(grid.code({1.5F, 0.5F, 0.5F}), 1U);
  EXPECT_EQ(grid.code({0.5F, 1.5F, 0.5F}), 2U);
  EXPECT_EQ(grid.code({0.5F, 0.5F, 1.5F}), 4U);
  EXPECT_EQ(grid.code({2.5F, 3.5F, 0.5F}), 0b011'010U);
  EXPECT_EQ(grid.code(glm::vec3(1023.5F)), (1U << 30U) - 1);
}

TEST(Morton, TakesPointsOutsideAndDomainsWithoutExtent) {
  const MortonGrid grid({glm::vec3(-1.0F), glm::vec3(1.0F)});
  EXPECT_EQ(grid.code(glm::vec3(-1e30F)), 0U);
  EXPECT_EQ(grid.code(glm::vec3(1e30F)), (1U << 30U) - 1);
  const MortonGrid flat({glm::vec3(3.0F), glm::vec3(3.0F)});
  EXPECT_EQ(flat.code(glm::vec3(3.0F)), 0U);
  EXPECT_EQ(MortonGrid({}).code(glm::vec3(3.0F)), 0U);
}

TEST(Morton, SortsStably) {
  Random random(1);
  std::vector<MortonKey> keys;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    keys.push_back(
        {static_cast<std::uint32_t>(random.below(1U << 30U)) >> (i % 2 == 0 ? 0U : 24U), i});
  }
  std::vector<MortonKey> expected = keys;
  std::ranges::stable_sort(expected, {}, &MortonKey::code);
  std::vector<MortonKey> scratch;
  sort_by_code(keys, scratch);
  ASSERT_EQ(keys.size(), expected.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    EXPECT_EQ(keys[i].code, expected[i].code);
    EXPECT_EQ(keys[i].index, expected[i].index);
  }
}

}  // namespace
}  // namespace vislab
