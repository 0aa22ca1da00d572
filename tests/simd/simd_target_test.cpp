#include "common/simd/simd_target.h"

#include <gtest/gtest.h>

namespace vislab {
namespace {

TEST(SimdTarget, IsTheBestOfThoseThatCanBeUsed) {
  ASSERT_FALSE(simd_targets().empty());
  EXPECT_EQ(simd_target(), simd_targets().front());
}

TEST(SimdTargetScope, RestrictsToOneAndGivesAllBack) {
  const std::vector<std::string> all = simd_targets();
  for (const std::string& target : all) {
    const SimdTargetScope scope(target);
    EXPECT_EQ(simd_targets(), std::vector<std::string>{target});
  }
  EXPECT_EQ(simd_targets(), all);
}

TEST(SimdTargetScope, RefusesAnUnknownName) {
  EXPECT_THROW(SimdTargetScope("AVX99"), std::logic_error);
}

}  // namespace
}  // namespace vislab
