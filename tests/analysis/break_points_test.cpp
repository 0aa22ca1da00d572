#include "experiments/analysis/break_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

namespace vislab {
namespace {

using Agreement = SweepVerdict::Agreement;

/// A sweep of one method over the values 1 to 8.
Sweep one_method(const SweepLimit& limit = {}) {
  Sweep sweep;
  sweep.name = "made_up";
  sweep.dial = {"edge", "m", {1, 2, 3, 4, 5, 6, 7, 8}, {"1", "2", "3", "4", "5", "6", "7", "8"}};
  sweep.limit = limit;
  sweep.methods.push_back({"m", std::vector<std::string>(8, "m"), {}});
  return sweep;
}

CellSummary judged_cell(Guarantee guarantee = Guarantee::conservative) {
  CellSummary cell;
  cell.canonical = "m";
  cell.guarantee = guarantee;
  cell.judged = true;
  cell.pixels = 1000;
  cell.over = 1.0;
  return cell;
}

/// Cells for all eight values, changed by `change(value, cell)`.
template <typename Change>
std::map<std::size_t, CellSummary> cells_with(Guarantee guarantee, Change&& change) {
  std::map<std::size_t, CellSummary> cells;
  for (std::size_t i = 0; i < 8; ++i) {
    cells[i] = judged_cell(guarantee);
    change(i, cells[i]);
  }
  return cells;
}

SweepVerdict verdict_of(const Sweep& sweep, const std::map<std::size_t, CellSummary>& cells) {
  return find_break_points(sweep,
                           [&](std::size_t value, const std::string&) -> const CellSummary* {
                             const auto found = cells.find(value);
                             return found == cells.end() ? nullptr : &found->second;
                           })
      .verdicts.at(0);
}

SweepExpectation breaks_within(double low, double high) {
  return {"m", false, low, high, "source", "because"};
}

TEST(BreakPoint, IsTheFirstValueBeyondTheLimit) {
  const auto cells = cells_with(Guarantee::erroneous, [](std::size_t i, CellSummary& cell) {
    cell.false_px = i == 4 ? 7 : i >= 6 ? 3 : 0;
  });
  const SweepVerdict verdict = verdict_of(one_method(), cells);
  EXPECT_EQ(verdict.break_point, 4U);
  EXPECT_EQ(verdict.worst, 4U);
  EXPECT_EQ(verdict.best, 0U);
  EXPECT_TRUE(verdict.is_complete);
  EXPECT_FALSE(verdict.broken_promise) << "nothing was promised";
}

TEST(BreakPoint, IsMissingWhereNothingIsBeyondTheLimit) {
  const SweepVerdict verdict =
      verdict_of(one_method(), cells_with(Guarantee::conservative, [](auto, auto&) {}));
  EXPECT_FALSE(verdict.break_point);
  EXPECT_TRUE(verdict.is_complete);
  EXPECT_FALSE(verdict.is_alarming());
}

TEST(BreakPoint, MayBeWhereAMethodIsNoBetterThanAnother) {
  SweepLimit limit;
  limit.metric = "frame_ms";
  limit.at_most = 1.0;
  limit.against = 1;
  Sweep sweep = one_method(limit);
  sweep.methods.push_back({"other", std::vector<std::string>(8, "other"), {}});
  const CellAtValue cell = [](std::size_t value, const std::string& chain) {
    static CellSummary cells[2];
    CellSummary& found = cells[chain == "m" ? 0 : 1];
    found = judged_cell();
    // 0.5, 0.75, 1, 1.25 … times the other's, which grows as well.
    const double other = 2.0 + static_cast<double>(value);
    found.frame_ms.median.value =
        chain == "m" ? other * (0.5 + 0.25 * static_cast<double>(value)) : other;
    return &found;
  };
  const SweepResult result = find_break_points(sweep, cell);
  EXPECT_EQ(result.verdicts[0].break_point, 3U);
  EXPECT_DOUBLE_EQ(result.verdicts[0].points[1].figure, 0.75);
  EXPECT_FALSE(result.verdicts[1].break_point) << "a method costs as much as itself";
  sweep.limit.at_most = 0.6;
  const SweepResult half = find_break_points(sweep, cell);
  EXPECT_EQ(half.verdicts[0].break_point, 1U);
  EXPECT_FALSE(half.verdicts[1].break_point) << "nothing can take a share of itself";
}

TEST(BreakPoint, ApproximateMethodsMayLoseOneInAHundredPixels) {
  const auto cells = cells_with(Guarantee::approximate, [](std::size_t i, CellSummary& cell) {
    cell.false_px = i < 4 ? 10 : 11;
  });
  EXPECT_EQ(verdict_of(one_method(), cells).break_point, 4U);
}

TEST(BreakPoint, OverMayDouble) {
  const auto cells = cells_with(Guarantee::conservative, [](std::size_t i, CellSummary& cell) {
    cell.over = i < 5 ? 2.0 : 2.01;
    if (i == 0) cell.over = 1.0;
  });
  EXPECT_EQ(verdict_of(one_method({"over", false, {}, {}, {}}), cells).break_point, 5U);
  EXPECT_EQ(verdict_of(one_method({"over", false, 2.5, {}, {}}), cells).break_point, std::nullopt);
  EXPECT_EQ(verdict_of(one_method({"over", false, {}, 1.5, {}}), cells).break_point, 1U);
}

TEST(BreakPoint, IsTheFirstValueBelowTheLimitWhereMoreIsBetter) {
  const auto cells = cells_with(Guarantee::conservative, [](std::size_t i, CellSummary& cell) {
    cell.recall = 0.9 - 0.1 * static_cast<double>(i);
  });
  const SweepVerdict verdict = verdict_of(one_method({"recall", false, {}, {}, {}, 0.55}), cells);
  EXPECT_EQ(verdict.break_point, 4U);
  EXPECT_EQ(verdict.worst, 7U);
  EXPECT_EQ(verdict.best, 0U);
  EXPECT_EQ(verdict.limit, 0.55);
}

TEST(BreakPoint, CountersAreLookedUpByTheirName) {
  const auto cells = cells_with(Guarantee::conservative, [](std::size_t i, CellSummary& cell) {
    cell.counters["plane_tests"] = 10.0 * static_cast<double>(i + 1);
  });
  const Sweep sweep = one_method({"plane_tests", true, 45.0, {}, {}});
  EXPECT_EQ(verdict_of(sweep, cells).break_point, 4U);
}

TEST(BreakPoint, AFailureIsOneAndAMissingValueBeforeItLeavesItOpen) {
  auto cells = cells_with(Guarantee::conservative, [](std::size_t i, CellSummary& cell) {
    if (i != 3) return;
    cell.status = ResultCell::Status::failed;
    cell.reason = "crashed";
  });
  Sweep sweep = one_method();
  sweep.methods[0].expectation = breaks_within(4, 4);
  const SweepVerdict whole = verdict_of(sweep, cells);
  EXPECT_EQ(whole.break_point, 3U);
  EXPECT_EQ(whole.agreement, Agreement::agrees);
  EXPECT_EQ(whole.points[3].reason, "crashed");
  cells.erase(1);
  const SweepVerdict gap = verdict_of(sweep, cells);
  EXPECT_FALSE(gap.is_complete);
  EXPECT_EQ(gap.agreement, Agreement::unknown);
}

TEST(BreakPoint, NothingMeasuredIsNeitherABreakNorAgreement) {
  Sweep sweep = one_method({"over", false, {}, {}, {}});
  sweep.methods[0].expectation = SweepExpectation{"m", true, 0, 0, "s", "b"};
  const SweepVerdict verdict = verdict_of(sweep, {});
  EXPECT_FALSE(verdict.was_measured());
  EXPECT_FALSE(verdict.break_point);
  EXPECT_EQ(verdict.agreement, Agreement::unknown);
  EXPECT_FALSE(verdict.is_alarming());
}

TEST(BreakPoint, ExpectationsAgreeOrDiffer) {
  const auto breaks_at_5 = cells_with(Guarantee::erroneous, [](std::size_t i, CellSummary& cell) {
    cell.false_px = i >= 4 ? 1 : 0;
  });
  Sweep sweep = one_method();
  const auto agreement = [&](const SweepExpectation& expectation) {
    sweep.methods[0].expectation = expectation;
    return verdict_of(sweep, breaks_at_5).agreement;
  };
  EXPECT_EQ(agreement(breaks_within(4, 5)), Agreement::agrees);
  EXPECT_EQ(agreement(breaks_within(6, 8)), Agreement::differs);
  EXPECT_EQ(agreement({"m", true, 0, 0, "s", "b"}), Agreement::differs);
  sweep.methods[0].expectation = breaks_within(4, 5);
  const auto never = cells_with(Guarantee::erroneous, [](auto, auto&) {});
  EXPECT_EQ(verdict_of(sweep, never).agreement, Agreement::differs);
  EXPECT_FALSE(verdict_of(sweep, never).is_alarming()) << "it only breaks elsewhere";
  sweep.methods[0].expectation = {"m", true, 0, 0, "s", "b"};
  EXPECT_TRUE(verdict_of(sweep, breaks_at_5).is_alarming());
}

TEST(BreakPoint, APromiseIsBrokenByALostRayToo) {
  const auto cells = cells_with(Guarantee::conservative, [](std::size_t i, CellSummary& cell) {
    cell.false_jittered = i == 2 ? 1 : 0;
  });
  const SweepVerdict verdict = verdict_of(one_method({"over", false, {}, {}, {}}), cells);
  EXPECT_FALSE(verdict.break_point) << "over stays as it is";
  EXPECT_EQ(verdict.broken_promise, 2U);
  EXPECT_TRUE(verdict.is_alarming());
  auto exact = cells;
  for (auto& [value, cell] : exact) cell.guarantee = Guarantee::image_exact;
  EXPECT_FALSE(verdict_of(one_method(), exact).broken_promise) << "it promises only the pixels";
}

TEST(BreakPoint, APromiseAboutAnImageIsHeldToTheImage) {
  const auto broken = [](auto&& change) {
    return verdict_of(one_method({"over", false, {}, {}, {}}),
                      cells_with(Guarantee::image_exact, change))
        .broken_promise;
  };
  const auto lost_ray = [](std::size_t i, CellSummary& cell) { cell.false_px = i == 3 ? 1 : 0; };
  EXPECT_EQ(broken(lost_ray), 3U) << "nothing was drawn";
  EXPECT_FALSE(broken([&](std::size_t i, CellSummary& cell) {
    lost_ray(i, cell);
    cell.drawn = true;
  })) << "the device's image is the same";
  EXPECT_EQ(broken([](std::size_t i, CellSummary& cell) {
              cell.drawn = true;
              cell.image_px = i == 4 ? 1 : 0;
            }),
            4U);
  EXPECT_EQ(broken([](std::size_t i, CellSummary& cell) {
              cell.drawn = cell.paints = true;
              cell.surface_px = i == 5 ? 1 : 0;
            }),
            5U);
}

TEST(BreakPoint, APromiseIsHeldToWhatTheMethodDeclaresAtThatValue) {
  // A parameter that the dial turns makes the method erroneous from the fifth value on.
  const auto cells = cells_with(Guarantee::conservative, [](std::size_t i, CellSummary& cell) {
    if (i >= 4) cell.guarantee = Guarantee::erroneous;
    cell.false_px = i == 3 || i == 6 ? 1 : 0;
  });
  const SweepVerdict verdict = verdict_of(one_method(), cells);
  EXPECT_EQ(verdict.guarantee, Guarantee::erroneous);
  EXPECT_EQ(verdict.broken_promise, 3U);
}

TEST(BreakPoint, ACounterThatAMethodDoesNotHaveIsNamedBesideThoseThatItHas) {
  const auto cells = cells_with(Guarantee::conservative, [](std::size_t, CellSummary& cell) {
    cell.culler = "m";
    cell.counters = {{"nodes", 1.0}, {"plane_tests", 2.0}};
  });
  const Sweep sweep = one_method({"plane_test", true, 45.0, {}, {}});
  const SweepVerdict verdict = verdict_of(sweep, cells);
  EXPECT_EQ(verdict.missing_counter, "m has no counter 'plane_test'; it has nodes, plane_tests");
  EXPECT_FALSE(verdict.is_complete);
  EXPECT_EQ(missing_counter({sweep, {verdict}}), "sweep made_up: " + verdict.missing_counter);
  EXPECT_EQ(missing_counter({sweep, {verdict, SweepVerdict()}}), "") << "another may have it";
  EXPECT_EQ(missing_counter({sweep, {}}), "");
}

TEST(BreakPoint, AFigureThatDoesNotApplyLeavesTheSweepOpen) {
  const auto cells = cells_with(Guarantee::conservative, [](std::size_t i, CellSummary& cell) {
    if (i == 2) cell.over = std::numeric_limits<double>::quiet_NaN();
  });
  const SweepVerdict verdict = verdict_of(one_method({"over", false, {}, {}, {}}), cells);
  EXPECT_FALSE(verdict.is_complete);
  EXPECT_TRUE(std::isnan(verdict.points[2].figure));
}

}  // namespace
}  // namespace vislab
