#include "report/family_stability.h"

#include <gtest/gtest.h>

#include "tests/report/fabricated.h"

namespace vislab {
namespace {

ReportInput input_with(std::uint64_t pop) {
  ReportInput input;
  BlockSummary block = fabricated_block("made_up");
  block.cells.push_back(fabricated_cell("depth.buffer", 0.5, 0, 1.0));
  CellSummary late = fabricated_cell("depth.late", 0.4, 0, 1.0);
  late.pop_px_frames = pop;
  late.latency_frames = pop > 0 ? 2 : 0;
  block.cells.push_back(late);
  input.blocks.push_back(block);
  return input;
}

Fields fields_of(const ReportInput& input) {
  Fields fields;
  add_stability_fields(input, {}, "depth", fields);
  return fields;
}

TEST(FamilyStability, APathOnWhichSomethingPoppedHasARowThatNamesTheMethod) {
  Fields fields = fields_of(input_with(700));
  ASSERT_EQ(fields.lists["over_time"].size(), 1U);
  const Fields& row = fields.lists["over_time"][0];
  EXPECT_EQ(row.values.at("place"), "made\\_up\\, orbit");
  EXPECT_EQ(row.values.at("moved"), "1 of 2");
  EXPECT_EQ(row.values.at("flicker"), "0");
  EXPECT_EQ(row.values.at("pop"), "700, `depth.late`");
  EXPECT_EQ(row.values.at("latency"), "2.00, `depth.late`");
  EXPECT_EQ(fields.values["over_time_quiet"], "1");
}

TEST(FamilyStability, WhereAllIsQuietThereIsNoRow) {
  Fields fields = fields_of(input_with(0));
  EXPECT_TRUE(fields.lists["over_time"].empty());
  EXPECT_EQ(fields.lists["has_runs_over_time"].size(), 1U);
  EXPECT_EQ(fields.values["over_time_runs"], "2");
}

TEST(FamilyStability, WhatIsWrongOnPurposeIsNotLookedAt) {
  ReportInput input = input_with(700);
  input.blocks[0].cells.back().guarantee = Guarantee::erroneous;
  EXPECT_TRUE(fields_of(input).lists["over_time"].empty());
}

TEST(FamilyStability, AllValuesOfASweepShareARowBeforeThePaths) {
  ReportInput input = input_with(700);
  for (const char* name : {"shake", "shake_more"}) {
    SweepResult result;
    result.sweep.name = name;
    result.sweep.dial.name = std::string(name) + " by";
    result.sweep.limit.metric = "pop";
    input.sweeps.push_back(result);
  }
  for (const char* scene : {"shake_more-1", "shake_more-2"}) {
    input.sweep_blocks.push_back(input.blocks[0]);
    input.sweep_blocks.back().scene = scene;
  }
  Fields fields = fields_of(input);
  ASSERT_EQ(fields.lists["over_time"].size(), 2U);
  EXPECT_EQ(fields.lists["over_time"][0].values.at("place"),
            "sweep of shake\\_more by (`shake_more`)");
  EXPECT_EQ(fields.lists["over_time"][0].values.at("moved"), "2 of 4");
}

}  // namespace
}  // namespace vislab
