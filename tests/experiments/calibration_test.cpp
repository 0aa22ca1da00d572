#include "experiments/calibration/calibration.h"

#include <gtest/gtest.h>

#include <string>

#include <cmath>
#include <stdexcept>

namespace vislab {
namespace {

TEST(Calibration, ACostIsTheMedianWithItsQuartilesAndNeverBelowZero) {
  EXPECT_EQ(cost_of({5.0, 1.0, 3.0, 2.0, 4.0}), (Cost{3.0, 2.0, 4.0}));
  EXPECT_EQ(cost_of({-7.0}), Cost::exactly(0.0));
  EXPECT_THROW(cost_of({}), std::logic_error);
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
