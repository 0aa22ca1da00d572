#include "report/family_measures.h"

#include <gtest/gtest.h>

#include "tests/report/fabricated.h"

namespace vislab {
namespace {

BlockSummary block_with_chain(double alone, double chained) {
  BlockSummary block = fabricated_block("made_up");
  block.cells.push_back(fabricated_cell("frustum.bvh", alone, 0, 4.0));
  block.cells.push_back(fabricated_cell("frustum.bvh > detail.small", chained, 0, 4.0));
  return block;
}

TEST(FamilyMeasures, AChainIsHeldToTheSameChainWithoutItsLastStage) {
  const BlockSummary block = block_with_chain(0.5, 0.4);
  const FamilyOn on = family_on(block, "detail", nullptr);
  ASSERT_NE(on.best, nullptr);
  EXPECT_EQ(on.best->against(), "frustum.bvh");
  EXPECT_DOUBLE_EQ(on.best->ratio.value, 0.8);
  EXPECT_LT(on.best->ratio.low, 0.98 * 0.8);  // wider than either
  EXPECT_GT(on.best->ratio.high, 1.02 * 0.8);
  EXPECT_TRUE(saves_time(block, *on.best));
}

TEST(FamilyMeasures, WhatAnEarlierStageSavesIsNotTheLastOnesMerit) {
  const BlockSummary block = block_with_chain(0.5, 0.51);
  const FamilyOn on = family_on(block, "detail", nullptr);
  ASSERT_NE(on.best, nullptr);
  EXPECT_FALSE(saves_time(block, *on.best));
  EXPECT_TRUE(saves_time(block, *family_on(block, "frustum", nullptr).best));
}

TEST(FamilyMeasures, OfAFamilyTheMethodThatAddsMostIsTheBest) {
  BlockSummary block = block_with_chain(0.5, 0.45);
  block.cells.push_back(fabricated_cell("detail.small", 0.7, 0, 4.0));
  const FamilyOn on = family_on(block, "detail", nullptr);
  ASSERT_NE(on.best, nullptr);
  EXPECT_EQ(on.best->cell->culler, "detail.small");  // 0.7 of none; the chain 0.9 of its rest
  EXPECT_EQ(on.best->against(), "none");
}

TEST(FamilyMeasures, AChainWhoseRestWasNotMeasuredIsNeverTheBestButItsErrorsCount) {
  BlockSummary block = fabricated_block("made_up");
  block.cells.push_back(fabricated_cell("frustum.bvh > detail.small", 0.4, 0, 4.0));
  block.cells.push_back(fabricated_cell("frustum.bvh > detail.large", 0.3, 12, 4.0));
  const FamilyOn on = family_on(block, "detail", nullptr);
  EXPECT_EQ(on.methods.size(), 2U);
  EXPECT_EQ(on.best, nullptr);
  EXPECT_EQ(on.erring, 1U);
  ASSERT_NE(on.worst, nullptr);
  EXPECT_EQ(on.worst->culler, "frustum.bvh > detail.large");
}

TEST(FamilyMeasures, WhatGoesFromCellToCellIsLeftOutWhereTheViewerIsInNone) {
  BlockSummary block = fabricated_block("made_up");
  CellSummary walker = fabricated_cell("portal.walk", 0.6, 0, 4.0);
  walker.counters["frames_outside"] = 1.0;
  block.cells.push_back(walker);
  CellSummary chain = fabricated_cell("portal.walk > depth.buffer", 0.3, 0, 4.0);
  chain.counters["frames_outside"] = 1.0;  // of its first stage
  block.cells.push_back(chain);
  EXPECT_TRUE(family_on(block, "portal", nullptr).methods.empty());
  EXPECT_EQ(family_on(block, "depth", nullptr).methods.size(), 1U);
  block.cells[block.cells.size() - 2].counters["frames_outside"] = 0.5;
  EXPECT_EQ(family_on(block, "portal", nullptr).methods.size(), 1U);
}

TEST(FamilyMeasures, WhereNothingIsDrawnTheLastStageIsHeldToWhatItLeavesOut) {
  BlockSummary block = block_with_chain(0.5, 0.4);
  block.drawn = false;
  for (CellSummary& cell : block.cells) cell.against_none = Estimate::none();
  block.cells.back().submitted_triangles *= 0.5;
  const FamilyOn on = family_on(block, "detail", nullptr);
  ASSERT_NE(on.best, nullptr);
  EXPECT_DOUBLE_EQ(on.best->kept, 0.5);
  EXPECT_FALSE(on.best->ratio.measured());
  EXPECT_FALSE(saves_time(block, *on.best));
}

}  // namespace
}  // namespace vislab
