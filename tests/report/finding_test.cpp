#include "report/finding.h"

#include <gtest/gtest.h>

#include "tests/report/fabricated.h"

namespace vislab {
namespace {

TEST(Finding, TheFastestMethodWithoutErrorsIsTheBest) {
  BlockSummary block = fabricated_block("made_up");
  block.cells.push_back(fabricated_cell("slow", 0.8, 0, 3.0));
  block.cells.push_back(fabricated_cell("good", 0.3, 0, 3.0));
  block.cells.push_back(fabricated_cell("wrong", 0.1, 1, 0.0));
  const Finding finding = find(block);
  EXPECT_EQ(finding.kind, FindingKind::saves);
  ASSERT_NE(finding.best, nullptr);
  EXPECT_EQ(finding.best->culler, "good");
  ASSERT_NE(finding.erring, nullptr);
  EXPECT_EQ(finding.erring->culler, "wrong");
  EXPECT_EQ(finding.oracle->culler, "oracle[level=triangle]");
}

TEST(Finding, ASlowMethodWithErrorsIsNotMentioned) {
  BlockSummary block = fabricated_block("made_up");
  block.cells.push_back(fabricated_cell("good", 0.3, 0, 3.0));
  block.cells.push_back(fabricated_cell("wrong", 0.4, 1, 0.0));
  EXPECT_EQ(find(block).erring, nullptr);
}

TEST(Finding, ASavingWithinTheNoiseIsNone) {
  BlockSummary block = fabricated_block("made_up");
  block.cells.push_back(fabricated_cell("same", 0.96, 0, 3.0));  // 0.941 to 0.979
  EXPECT_EQ(find(block).kind, FindingKind::saves);
  block.noise = {1.0, 0.97, 1.03};
  EXPECT_EQ(find(block).kind, FindingKind::within_noise);
}

TEST(Finding, AMethodThatIsToldToSaveGoesBeforeOneThatMaySaveMore) {
  BlockSummary block = fabricated_block("made_up");
  block.noise = {1.0, 0.88, 1.12};
  CellSummary unsure = fabricated_cell("unsure", 0.52, 0, 3.0);
  unsure.against_none = {0.52, 0.31, 0.99};
  block.cells.push_back(unsure);
  EXPECT_EQ(find(block).kind, FindingKind::within_noise);
  block.cells.push_back(fabricated_cell("sure", 0.55, 0, 3.0));
  EXPECT_EQ(find(block).kind, FindingKind::saves);
  EXPECT_EQ(find(block).best->culler, "sure");
}

TEST(Finding, WithoutAControlNoSavingIsSaidToBeOne) {
  BlockSummary block = fabricated_block("plain");
  block.cells.push_back(fabricated_cell("frustum.flat", 0.5, 0, 1.0));
  EXPECT_EQ(find(block).kind, FindingKind::saves);
  block.noise = Estimate::none();
  EXPECT_EQ(find(block).kind, FindingKind::within_noise);
}

TEST(Finding, ALossIsSaidToBeOne) {
  BlockSummary block = fabricated_block("made_up");
  block.cells.push_back(fabricated_cell("slow", 1.2, 0, 3.0));
  EXPECT_EQ(find(block).kind, FindingKind::loses);
}

TEST(Finding, ImagesThatDifferAreErrors) {
  CellSummary cell = fabricated_cell("same", 0.5, 0, 3.0);
  EXPECT_TRUE(is_free_of_errors(cell));
  cell.image_px = 1;
  EXPECT_FALSE(is_free_of_errors(cell));
}

TEST(Finding, OnlyWhereNoMoreThanPixelsArePromisedMayAnythingBetweenThemBeLost) {
  CellSummary cell = fabricated_cell("same", 0.5, 0, 3.0);
  cell.false_jittered = 1;
  for (const Guarantee guarantee :
       {Guarantee::conservative, Guarantee::approximate, Guarantee::erroneous}) {
    cell.guarantee = guarantee;
    EXPECT_FALSE(is_free_of_errors(cell)) << to_string(guarantee);
  }
  cell.guarantee = Guarantee::image_exact;
  EXPECT_TRUE(is_free_of_errors(cell));
}

TEST(Finding, LostObjectsAreErrorsUnlessOnlyPixelsArePromised) {
  CellSummary cell = fabricated_cell("same", 0.5, 0, 3.0);
  cell.false_objects = 1;
  for (const Guarantee guarantee :
       {Guarantee::conservative, Guarantee::approximate, Guarantee::erroneous}) {
    cell.guarantee = guarantee;
    EXPECT_FALSE(is_free_of_errors(cell)) << to_string(guarantee);
  }
  cell.guarantee = Guarantee::image_exact;
  EXPECT_TRUE(is_free_of_errors(cell));
}

TEST(Finding, WhatIsWrongOnPurposeIsNeverTheBest) {
  BlockSummary block = fabricated_block("made_up");
  block.cells.push_back(fabricated_cell("wrong", 0.1, 0, 1.0));
  block.cells.back().guarantee = Guarantee::erroneous;
  for (const bool drawn : {true, false}) {
    block.drawn = drawn;
    const Finding finding = find(block);
    EXPECT_TRUE(finding.best == nullptr || finding.best->culler != "wrong");
    EXPECT_TRUE(finding.erring == nullptr || finding.erring->culler != "wrong");
  }
}

TEST(Finding, AnOracleThatErrsIsNotNamed) {
  BlockSummary block = fabricated_block("made_up");
  block.cells[3].image_px = 1;
  EXPECT_EQ(find(block).oracle->culler, "oracle");
  block.cells[2].false_px = 1;
  EXPECT_EQ(find(block).oracle, nullptr);
}

TEST(Finding, WhereNothingIsDrawnTheLeastLeftOverCounts) {
  BlockSummary block = fabricated_block("made_up");
  block.drawn = false;
  block.cells.push_back(fabricated_cell("loose", 0.1, 0, 3.0));
  block.cells.push_back(fabricated_cell("tight", 0.5, 0, 2.0));
  block.cells.push_back(fabricated_cell("wrong", 0.5, 1, 1.0));
  const Finding finding = find(block);
  EXPECT_EQ(finding.kind, FindingKind::not_drawn);
  EXPECT_EQ(finding.best->culler, "tight");
  EXPECT_EQ(finding.erring->culler, "wrong");
  EXPECT_EQ(finding.oracle, nullptr);
}

TEST(Finding, WhereAllMethodsErrNoneIsRecommended) {
  BlockSummary block = fabricated_block("made_up");
  block.cells.push_back(fabricated_cell("wrong", 0.4, 1, 0.0));
  const Finding finding = find(block);
  EXPECT_EQ(finding.kind, FindingKind::none_clean);
  EXPECT_EQ(finding.erring->culler, "wrong");
}

TEST(Finding, FailedUntimedAndUnjudgedCellsAreNoMethodsToRecommend) {
  BlockSummary block = fabricated_block("made_up");
  for (int i = 0; i < 3; ++i) block.cells.push_back(fabricated_cell("x", 0.3, 0, 3.0));
  block.cells[4].status = ResultCell::Status::failed;
  block.cells[5].against_none = Estimate::none();
  block.cells[6].judged = false;
  const Finding finding = find(block);
  EXPECT_EQ(finding.kind, FindingKind::no_method);
  EXPECT_EQ(finding.best, nullptr);
}

}  // namespace
}  // namespace vislab
