#include "common/geometry/random.h"

#include <gtest/gtest.h>

namespace vislab {
namespace {

TEST(Random, GivesTheSequenceOfSplitMix64) {
  // The first five outputs for this seed in the authors' reference implementation.
  Random random(1234567);
  for (const std::uint64_t expected :
       {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
        4593380528125082431ULL, 16408922859458223821ULL}) {
    EXPECT_EQ(random.bits(), expected);
  }
}

TEST(Random, StaysWithinItsRanges) {
  Random random(7);
  double sum = 0.0;
  std::uint64_t seen = 0;
  constexpr int draws = 10'000;
  for (int i = 0; i < draws; ++i) {
    const double value = random.uniform(-2.0, 4.0);
    ASSERT_GE(value, -2.0);
    ASSERT_LT(value, 4.0);
    sum += value;
    const std::uint64_t whole = random.below(5);
    ASSERT_LT(whole, 5U);
    seen |= 1ULL << whole;
  }
  EXPECT_NEAR(sum / draws, 1.0, 0.1);
  EXPECT_EQ(seen, 0b11111U);
}

}  // namespace
}  // namespace vislab
