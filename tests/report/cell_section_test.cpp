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

TEST(CellSection, DoesNotPlanANegativeControlThatHappensToBeRight) {
  ReportInput input = houses();
  for (BlockSummary& block : input.blocks) {
    block.cells.push_back(walking("by_a_mistake", 0.1, 0.0));
    block.cells.back().guarantee = Guarantee::erroneous;
  }
  std::vector<std::string> planned;
  input.plan = [&](const BlockSummary&, const CellSummary& cell, const std::filesystem::path&) {
    planned.push_back(cell.culler);
    return "house, " + cell.culler;
  };
  Fields fields;
  add_cell_fields(input, ".", fields);
  EXPECT_EQ(planned, (std::vector<std::string>{"by_outlines"}));
}

TEST(CellSection, GivesTheFiguresOfSetsOnceAScene) {
  ReportInput input = houses();
  input.blocks[1].path = "another";
  for (BlockSummary& block : input.blocks) {
    CellSummary cell = fabricated_cell("by_sets", 0.6, 0, 3.0);
    cell.counters = {{"frames_outside", 0.0}, {"set_bytes", 140.0}, {"set_raw_bytes", 630.0}};
    RegionVerdict& regions = cell.regions.emplace();
    regions.cells = 7;
    regions.rays = 28'672;
    regions.misses = 2;
    regions.unseen = 50;
    regions.seen = 100;
    regions.kept_by_points = 900;
    regions.seen_by_points = 400;
    block.cells.push_back(std::move(cell));
  }
  Fields fields;
  add_cell_fields(input, ".", fields);
  ASSERT_EQ(fields.lists["set_rows"].size(), 1U);
  auto& row = fields.lists["set_rows"][0].values;
  EXPECT_EQ(row["cells"], "7");
  EXPECT_EQ(row["rays"], "28,672");
  EXPECT_EQ(row["misses"], "2");
  EXPECT_EQ(row["over"], format_number(0.5));
  EXPECT_EQ(row["over_points"], format_number(1.25));
  EXPECT_EQ(row["set_bytes"], format_number(140.0));
  EXPECT_EQ(row["raw_bytes"], format_number(630.0));
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
  EXPECT_TRUE(fields.lists["set_rows"].empty());
}

}  // namespace
}  // namespace vislab
