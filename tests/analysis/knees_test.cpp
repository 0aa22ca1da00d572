#include "experiments/analysis/knees.h"

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/analysis/knees_file.h"
#include "tests/input_error.h"

namespace vislab {
namespace {

const std::vector<std::string> values{"1", "2", "4", "8"};

SizeSweep sweep_on(const std::vector<std::string>& scenes, SizeCost cost) {
  SizeSweep sweep;
  sweep.name = "test_depth";
  sweep.dial = "depth of a test";
  sweep.cost = cost;
  sweep.values = values;
  SizeMethod method;
  method.culler = "test.tree";
  method.parameter = "depth";
  for (const std::string& value : values) method.chains.push_back("test.tree[depth=" + value + "]");
  method.default_value = 2;
  sweep.methods.push_back(method);
  for (const std::string& scene : scenes) {
    Block block;
    block.scene = scene;
    sweep.blocks.push_back(block);
  }
  return sweep;
}

/// What one value costs: the efficiency that is measured, and the bytes.
struct Measured {
  double efficiency = 1.0;
  std::uint64_t bytes = 0, false_px = 0;
  double uncertain = 0.001;  // the interval reaches so far to both sides, as a share
};

/// A block whose cells are those of the sweep's only method.
BlockSummary block_of(const SizeSweep& sweep, const std::vector<Measured>& measured) {
  BlockSummary block;
  block.context = {{"cpu", "a processor"},
                   {"date", "2026-01-02"},
                   {"compiler", "g++ 1"},
                   {"revision", "abc"},
                   {"dirty", "no"}};
  block.threads = 2;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    CellSummary cell;
    cell.canonical = sweep.methods.front().chains[i];
    cell.judged = true;
    cell.bytes = measured[i].bytes;
    cell.false_px = measured[i].false_px;
    cell.build_ms = 2.0;
    cell.rounds = 7;
    const double e = measured[i].efficiency;
    const double wide = measured[i].uncertain;
    cell.efficiency = {e, e / (1.0 + wide), e * (1.0 + wide)};
    cell.update_us.median = {0.0, 0.0, 0.0};
    cell.cull_us.median = {100.0 / e, 100.0 / e / (1.0 + wide), 100.0 / e * (1.0 + wide)};
    block.cells.push_back(cell);
  }
  return block;
}

SizeResult knees_of(const SizeSweep& sweep, const std::vector<BlockSummary>& blocks) {
  return find_knees(sweep, [&](std::size_t block, const std::string& chain) -> SizeCell {
    if (block >= blocks.size()) return {};
    for (const CellSummary& cell : blocks[block].cells) {
      if (cell.canonical == chain) return {&blocks[block], &cell};
    }
    return {};
  });
}

SizeCurve curve_of(const std::vector<Measured>& measured, SizeCost cost = SizeCost::frame_ms) {
  const SizeSweep sweep = sweep_on({"one", "two"}, cost);
  const BlockSummary block = block_of(sweep, measured);
  return knees_of(sweep, {block, block}).verdicts.front().scenes.front();
}

TEST(Knees, TheKneeIsTheSmallestModelWithinFivePercentOfTheBest) {
  const SizeCurve curve = curve_of({{0.60, 10, 0}, {0.77, 20, 0}, {0.80, 40, 0}, {0.79, 80, 0}});
  ASSERT_TRUE(curve.best && curve.knee);
  EXPECT_EQ(*curve.best, 2U);
  EXPECT_EQ(*curve.knee, 1U) << ".77 / .80 is .9625";
  EXPECT_NEAR(curve.points[0].relative, 0.75, 1e-12);
}

TEST(Knees, ValuesOfDifferentRunsAreToldWhereTheirTimesArePairedWithNothing) {
  for (const auto& [cost, told] :
       {std::pair{SizeCost::decision_us, true}, {SizeCost::frame_ms, false}}) {
    const SizeSweep sweep = sweep_on({"one"}, cost);
    BlockSummary block = block_of(sweep, {{0.6, 10, 0}, {0.7, 20, 0}, {0.8, 40, 0}, {0.8, 80, 0}});
    for (CellSummary& cell : block.cells) cell.sessions = {"a run"};
    EXPECT_TRUE(knees_of(sweep, {block}).verdicts.front().common.same_rounds);
    block.cells[2].sessions = {"another run"};
    EXPECT_EQ(knees_of(sweep, {block}).verdicts.front().common.same_rounds, !told);
  }
}

TEST(Knees, OneModelAloneIsNoKnee) {
  SizeCurve curve = curve_of({{0.60, 10, 0}, {0.77, 20, 0}});
  EXPECT_TRUE(curve.knee);
  curve = curve_of({{0.60, 10, 0}});
  EXPECT_FALSE(curve.knee);
  EXPECT_TRUE(curve.may_be_knee.empty());
}

TEST(Knees, AModelThatIsWrongInMorePixelsThanTheBestIsNoKnee) {
  const SizeCurve curve = curve_of({{0.79, 10, 3}, {0.78, 20, 1}, {0.80, 40, 1}, {0.80, 80, 0}});
  EXPECT_EQ(*curve.knee, 1U);
}

TEST(Knees, AModelWhoseIntervalReachesFivePercentMayBeTheKnee) {
  const SizeCurve curve = curve_of(
      {{0.60, 10, 0, 0.02}, {0.75, 20, 0, 0.02}, {0.76, 40, 0, 0.02}, {0.80, 80, 0, 0.01}});
  ASSERT_TRUE(curve.knee);
  EXPECT_EQ(*curve.knee, 1U) << ".75 / .80 is .9375, and .765 / .80 is .956";
  EXPECT_EQ(curve.may_be_knee, (std::vector<std::size_t>{1, 2, 3}));
}

TEST(Knees, NothingLargerThanAModelThatIsCertainlyWithinFivePercentMayBeTheKnee) {
  const SizeCurve curve = curve_of(
      {{0.60, 10, 0, 0.02}, {0.75, 20, 0, 0.02}, {0.79, 40, 0, 0.01}, {0.80, 80, 0, 0.01}});
  EXPECT_EQ(curve.may_be_knee, (std::vector<std::size_t>{1, 2}));
}

TEST(Knees, ARerunWithinTheIntervalsRefutesNoDefault) {
  const SizeSweep sweep = sweep_on({"one", "two"}, SizeCost::decision_us);
  for (const double other : {0.945, 0.955}) {  // the default is the third value
    const BlockSummary block = block_of(
        sweep, {{0.6, 10, 0, 0.02}, {other, 20, 0, 0.02}, {0.99, 40, 0, 0.02}, {1.0, 80, 0, 0.02}});
    const SizeVerdict verdict = knees_of(sweep, {block, block}).verdicts.front();
    EXPECT_EQ(*verdict.common.knee, 1U) << other;
    EXPECT_TRUE(verdict.default_is_knee()) << other;
  }
}

TEST(Knees, FewerThanThreeRoundsHaveNoInterval) {
  const SizeSweep sweep = sweep_on({"one", "two"}, SizeCost::frame_ms);
  BlockSummary block = block_of(
      sweep, {{0.60, 10, 0, 0.5}, {0.75, 20, 0, 0.5}, {0.79, 40, 0, 0.5}, {0.80, 80, 0, 0.5}});
  for (CellSummary& cell : block.cells) cell.rounds = 1;
  const SizeVerdict verdict = knees_of(sweep, {block, block}).verdicts.front();
  EXPECT_EQ(verdict.common.may_be_knee, (std::vector<std::size_t>{2}));
}

TEST(Knees, SmallerIsWhatHoldsFewerBytesWhateverTheOrderOfTheValues) {
  const SizeCurve curve = curve_of({{0.80, 80, 0}, {0.80, 40, 0}, {0.79, 20, 0}, {0.30, 10, 0}});
  EXPECT_EQ(*curve.knee, 2U);
}

TEST(Knees, WhereBytesAreTheSameTheFirstValueIsTheSmallest) {
  const SizeCurve curve = curve_of({{0.5, 8, 0}, {0.77, 8, 0}, {0.80, 8, 0}, {0.80, 8, 0}});
  EXPECT_EQ(*curve.knee, 1U);
}

TEST(Knees, DecisionsAreComparedWithTheSoonest) {
  const SizeCurve curve =
      curve_of({{0.2, 1, 0}, {0.4, 2, 0}, {0.39, 3, 0}, {0.1, 4, 0}}, SizeCost::decision_us);
  EXPECT_EQ(*curve.knee, 1U);
  EXPECT_NEAR(curve.points[1].efficiency.value, 1.0, 1e-12);
  EXPECT_NEAR(curve.points[0].efficiency.value, 0.5, 1e-12);
  EXPECT_NEAR(curve.points[0].cost, 500.0, 1e-9) << "microseconds";
}

TEST(Knees, TheCommonKneeIsThatOfTheGeometricMean) {
  const SizeSweep sweep = sweep_on({"one", "two"}, SizeCost::frame_ms);
  // The first scene alone is content with the first value, the second asks for the third.
  std::vector<BlockSummary> blocks{
      block_of(sweep, {{0.96, 1, 0}, {0.97, 2, 0}, {0.99, 3, 0}, {1.00, 4, 0}}),
      block_of(sweep, {{0.20, 1, 0}, {0.25, 2, 0}, {0.40, 3, 0}, {0.41, 4, 0}})};
  blocks[1].context["dirty"] = "yes";
  blocks[1].mixed_context["date"] = {"2026-01-02", "2026-01-04"};
  const SizeResult result = knees_of(sweep, blocks);
  const SizeVerdict& verdict = result.verdicts.front();
  EXPECT_EQ(*verdict.scenes[0].knee, 0U);
  EXPECT_EQ(*verdict.scenes[1].knee, 2U);
  ASSERT_TRUE(verdict.common.knee);
  EXPECT_EQ(*verdict.common.knee, 2U);
  EXPECT_NEAR(verdict.common.points[3].efficiency.value, std::sqrt(1.00 * 0.41), 1e-12);
  EXPECT_EQ(verdict.common.points[3].bytes, 8U) << "of both scenes";
  EXPECT_TRUE(verdict.default_is_knee());
  EXPECT_EQ(result.provenance.at("cpu"), "a processor");
  EXPECT_EQ(result.provenance.at("date"), "2026-01-02, 2026-01-04") << "of all that was measured";
  EXPECT_EQ(result.provenance.at("rounds"), "7");
  EXPECT_EQ(result.provenance.at("threads"), "2");
  EXPECT_EQ(result.provenance.at("revision"), "abc, abc+") << "one block with changes since";
  EXPECT_TRUE(result.is_complete());
}

TEST(Knees, WhatIsMissingIsAGapWithItsReasonAndLeavesTheOthers) {
  const SizeSweep sweep = sweep_on({"one", "two"}, SizeCost::frame_ms);
  std::vector<BlockSummary> blocks{
      block_of(sweep, {{0.5, 1, 0}, {0.79, 2, 0}, {0.80, 3, 0}, {0.80, 4, 0}}),
      block_of(sweep, {{0.5, 1, 0}, {0.79, 2, 0}, {0.80, 3, 0}, {0.80, 4, 0}})};
  blocks[0].cells.erase(blocks[0].cells.begin() + 1);
  blocks[1].cells[3].status = ResultCell::Status::failed;
  blocks[1].cells[3].reason = "out of memory";
  const SizeVerdict verdict = knees_of(sweep, blocks).verdicts.front();
  EXPECT_EQ(verdict.scenes[0].points[1].gap, "not run");
  EXPECT_EQ(verdict.common.points[1].gap, "one: not run");
  EXPECT_EQ(verdict.common.points[3].gap, "two: failed: out of memory");
  EXPECT_EQ(*verdict.scenes[0].knee, 2U);
  EXPECT_EQ(*verdict.common.knee, 2U);
  EXPECT_FALSE(knees_of(sweep, blocks).is_complete());
}

TEST(Knees, NothingMeasuredIsNoKnee) {
  const SizeResult result = knees_of(sweep_on({"one", "two"}, SizeCost::frame_ms), {});
  EXPECT_FALSE(result.was_measured());
  EXPECT_FALSE(result.verdicts.front().common.knee);
  EXPECT_FALSE(result.verdicts.front().default_is_knee());
}

TEST(KneesFile, IsWrittenOnlyWhenNothingIsMissing) {
  SizeSweep sweep = sweep_on({"one", "two"}, SizeCost::frame_ms);
  sweep.methods.front().off_knee = "it is little";
  const BlockSummary whole =
      block_of(sweep, {{0.5, 1, 0}, {0.79, 2, 0}, {0.80, 3, 0}, {0.80, 4, 0}});
  const std::string text = knees_text({knees_of(sweep, {whole, whole})});
  for (const char* const part :
       {"culler = \"test.tree\"\nparameter = \"depth\"\nchain = \"test.tree[depth=4]\"\ndefault = "
        "\"4\"\nknee = \"2\"\nmay_be_knee = [\"2\"]\noff_knee = \"it is little\"\nsweep = "
        "\"test_depth\"\ncost = "
        "\"frame_ms\"\ncpu = \"a processor\"\ncompiler = \"g++ 1\"\nrevision = \"abc\"\ndate = "
        "\"2026-01-02\"\nrounds = \"7\"\nthreads = \"2\"\n",
        "scene = \"two\"\nknee = \"2\"\nbest = \"4\"\ndefault_of_best = 1.0\n",
        "default_bytes = 3\n"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  BlockSummary part = whole;
  part.cells.pop_back();
  EXPECT_TRUE(says(input_error([&] {
                     knees_text({knees_of(sweep, {whole, part})});
                   }),
                   "test_depth (test.tree at 8, two: not run)"));
}

}  // namespace
}  // namespace vislab
