#include "report/cell_section.h"

#include <gtest/gtest.h>

#include "common/scene/error.h"
#include "report/format.h"
#include "tests/report/fabricated.h"

namespace vislab {
namespace {

CellSummary walking(const std::string& name, double over, double outside) {
  CellSummary cell = fabricated_cell(name, 0.5, 0, over);
  cell.counters = {{"cells_visited", 12.0}, {"portals_clipped", 40.0}, {"frames_outside", outside}};
  return cell;
}

ReportInput houses() {
  ReportInput input;
  BlockSummary block = fabricated_block("house");
  block.cells.push_back(fabricated_cell("frustum.flat", 0.7, 0, 4.0));
  block.cells.push_back(walking("by_rectangles", 2.0, 0.0));
  block.cells.push_back(walking("by_outlines", 1.0, 0.25));
  block.cells.push_back(walking("by_guesses", 0.5, 0.0));
  block.cells.back().false_px = 3;
  input.blocks = {block, block};
  return input;
}

TEST(CellSection, ListsMethodsThatKnowOfCellsAndPlansTheBestThatIsRight) {
  ReportInput input = houses();
  std::vector<std::string> planned;
  input.plan = [&](const BlockSummary&, const CellSummary& cell, const std::filesystem::path&) {
    planned.push_back(cell.culler);
    return "house, " + cell.culler;
  };
  Fields fields;
  add_cell_fields(input, ".", fields);
  EXPECT_EQ(planned, (std::vector<std::string>{"by_outlines"})) << "once a scene";
  ASSERT_EQ(fields.lists["cell_rows"].size(), 6U);
  EXPECT_EQ(fields.lists["cell_rows"][1].values["outside"], format_percent(0.25));
  EXPECT_EQ(fields.lists["plans"].size(), 1U);
}

TEST(CellSection, SaysWhyThereIsNoPlan) {
  ReportInput input = houses();
  input.plan = [](const BlockSummary&, const CellSummary&,
                  const std::filesystem::path&) -> std::string { throw InputError("gone"); };
  Fields fields;
  add_cell_fields(input, ".", fields);
  EXPECT_TRUE(fields.lists["plans"].empty());
  ASSERT_EQ(fields.lists["plans_missing"].size(), 1U);
  EXPECT_EQ(fields.lists["plans_missing"][0].values["reason"], "gone");
}

TEST(CellSection, TriesTheOtherBlocksOfASceneThatCouldNotBeDrawn) {
  ReportInput input = houses();
  input.blocks[1].path = "another path";
  input.plan = [](const BlockSummary& block, const CellSummary&, const std::filesystem::path&) {
    if (block.path != "another path") throw InputError("gone");
    return std::string("drawn");
  };
  Fields fields;
  add_cell_fields(input, ".", fields);
  ASSERT_EQ(fields.lists["plans"].size(), 1U);
  EXPECT_EQ(fields.lists["plans"][0].values["place"], "drawn");
  EXPECT_TRUE(fields.lists["plans_missing"].empty());
}

TEST(CellSection, IsEmptyWhereNobodyWasEverInACell) {
  ReportInput input;
  BlockSummary block = fabricated_block("plant");
  block.cells.push_back(walking("by_outlines", 1.0, 1.0));
  block.cells.push_back(fabricated_cell("frustum.flat", 0.7, 0, 4.0));
  input.blocks = {block};
  Fields fields;
  add_cell_fields(input, ".", fields);
  EXPECT_TRUE(fields.lists["cell_rows"].empty());
}

}  // namespace
}  // namespace vislab
