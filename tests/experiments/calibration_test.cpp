#include "experiments/calibration/calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace vislab {
namespace {

TEST(Calibration, ACostIsTheDifferenceOfTheLeastTimesWhateverElseRanBeside) {
  const std::vector<double> larger{110.0, 500.0, 104.0, 108.0, 120.0};
  const std::vector<double> smaller{54.0, 58.0, 60.0, 300.0, 56.0};
  const Cost cost = cost_of(larger, smaller, 10.0);
  EXPECT_DOUBLE_EQ(cost.ns, 5.0);
  EXPECT_DOUBLE_EQ(cost.low_ns, 4.4);  // of 0, 4.4, 5.6, 6.4, 44.2
  EXPECT_DOUBLE_EQ(cost.high_ns, 6.4);
}

TEST(Calibration, ACostIsNeverBelowZero) {
  const double more = 9.0, less = 2.0;
  EXPECT_EQ(cost_of(std::span(&less, 1), std::span(&more, 1), 1.0), Cost::exactly(0.0));
  EXPECT_THROW(cost_of({}, {}, 1.0), std::logic_error);
}

TEST(Calibration, BothWorksRunInTurnsAndOnceBeforeTheyCount) {
  std::string order;
  cost_of_more([&] { order += 'L'; }, [&] { order += 's'; }, 1.0, 3);
  EXPECT_EQ(order, "LsLsLsLs");
}

TEST(Calibration, GivesEveryFigureOfTheTable) {
  const CostTable table = calibrate();
  for (const CostQuantity& quantity : cost_quantities()) {
    const Cost& cost = table.*quantity.cost;
    EXPECT_TRUE(std::isfinite(cost.ns)) << quantity.name;
    EXPECT_LE(cost.low_ns, cost.ns) << quantity.name;
    EXPECT_GE(cost.high_ns, cost.ns) << quantity.name;
  }
  EXPECT_GT(table.triangle.ns, 0.0);
  EXPECT_GT(table.cluster_test.ns, 0.0);
}

TEST(CostTable, SaysHowManyTrianglesATestIsWorth) {
  CostTable table;
  table.triangle = Cost::exactly(200.0);
  table.cluster_test = Cost::exactly(5.0);
  EXPECT_DOUBLE_EQ(table.cluster_test_over_triangle(), 0.025);
  EXPECT_GT(CostTable::typical().cluster_test_over_triangle(), 0.0);
}

}  // namespace
}  // namespace vislab
