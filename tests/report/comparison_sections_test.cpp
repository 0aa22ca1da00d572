#include "report/comparison_sections.h"

#include <gtest/gtest.h>

#include "common/scene/error.h"
#include "report/depth_section.h"
#include "report/sweep_chart.h"
#include "report/sweep_section.h"
#include "tests/report/fabricated.h"

namespace vislab {
namespace {

/// A sweep in which the second of two methods breaks at 8.
SweepResult fabricated_sweep() {
  Sweep sweep;
  sweep.name = "made_up_sweep";
  sweep.failure = "F1";
  sweep.description = "Something grows";
  sweep.dial = {"edge", "m", {1, 2, 4, 8}, {"1", "2", "4", "8"}};
  SweepExpectation never{"frustum.flat", true, 0, 0, "a paper", "planes hold it"};
  sweep.methods = {{"frustum.flat", {4, "frustum.flat"}, never},
                   {"frustum.wrong", {4, "frustum.wrong"}, {}}};
  std::vector<CellSummary> right(4, fabricated_cell("frustum.flat", 0.3, 0, 1.0));
  std::vector<CellSummary> wrong(4, fabricated_cell("frustum.wrong", 0.2, 0, 1.0));
  for (CellSummary& cell : wrong) cell.guarantee = Guarantee::erroneous;
  wrong[3].false_px = 77;
  return find_break_points(sweep, [&](std::size_t value, const std::string& chain) {
    return chain == "frustum.flat" ? &right[value] : &wrong[value];
  });
}

std::vector<Fields> sweep_fields(const std::vector<SweepResult>& sweeps) {
  Fields fields;
  add_sweep_fields(sweeps, fields);
  return fields.lists["sweeps"];
}

TEST(SweepSection, ASweepInWhichNothingBrokeHasARowOnly) {
  SweepResult result = fabricated_sweep();
  result.verdicts.pop_back();
  Fields fields;
  add_sweep_fields({result}, fields);
  EXPECT_TRUE(fields.lists["sweeps"].empty());
  ASSERT_EQ(fields.lists["quiet_sweeps"].size(), 1U);
  EXPECT_EQ(fields.lists["quiet_sweeps"][0].values["dial"], "edge from 1\u00A0m to 8\u00A0m");
  EXPECT_EQ(fields.lists["quiet_sweeps"][0].values["methods"], "`frustum.flat`");
  result.verdicts[0].agreement = SweepVerdict::Agreement::differs;
  EXPECT_TRUE(is_shown(result));
}

TEST(SweepSection, SaysWhereEachMethodBreaksAndWhatWasExpected) {
  const std::vector<Fields> fields = sweep_fields({fabricated_sweep()});
  ASSERT_EQ(fields.size(), 1U);
  const auto& rows = fields[0].lists.at("rows");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].values.at("breaks"), "none within 1\u00A0m to 8\u00A0m");
  EXPECT_NE(rows[0].values.at("expected").find("never breaks: planes hold it"), std::string::npos);
  EXPECT_EQ(rows[0].values.at("agreement"), "agrees");
  EXPECT_EQ(rows[1].values.at("breaks"), "**at 8\u00A0m**");
  EXPECT_EQ(rows[1].values.at("worst"), "77.0 at 8\u00A0m");
  EXPECT_EQ(rows[1].values.at("agreement"), "–");
}

TEST(SweepSection, NamesExpectedValuesAsTheDialHasThem) {
  SweepResult result = fabricated_sweep();
  result.sweep.dial = {"tilt", "rad", {0.1, 1e-3, 1e-6, 1e-8}, {"0.1", "0.001", "1e-06", "1e-08"}};
  SweepExpectation& expected = *result.verdicts[0].expectation;
  expected.never = false;
  expected.low = 1e-8;
  expected.high = 1e-6;
  const auto text = [&] { return sweep_fields({result})[0].lists["rows"][0].values["expected"]; };
  EXPECT_NE(text().find("breaks from 10⁻⁸ to 10⁻⁶: "), std::string::npos) << text();
  expected.high = expected.low;
  EXPECT_NE(text().find("breaks at 10⁻⁸: "), std::string::npos) << text();
}

TEST(SweepSection, SweepsThatWereNotRunAreLeftOut) {
  Sweep sweep;
  sweep.dial = {"edge", "m", {1, 2}, {"1", "2"}};
  sweep.methods = {{"m", {"m", "m"}, {}}};
  const SweepResult nothing =
      find_break_points(sweep, [](std::size_t, const std::string&) { return nullptr; });
  EXPECT_TRUE(sweep_fields({nothing}).empty());
  EXPECT_FALSE(has_sweep_chart(nothing));
}

TEST(SweepChart, RingsTheBreakPointAndNamesTheDial) {
  const std::string script = sweep_chart_script(fabricated_sweep(), "sweep-1.svg");
  EXPECT_NE(script.find("edge (m)"), std::string::npos);
  EXPECT_NE(script.find("$break1"), std::string::npos);
  EXPECT_EQ(script.find("$break0"), std::string::npos);
  EXPECT_LT(script.find("set terminal"), script.find("set output"));
  EXPECT_NE(script.find("unset key"), std::string::npos);  // gnuplot warns of one without room
}

TEST(GuideSection, GivesOneSentenceOfAdviceAndARowAScene) {
  BlockSummary block = fabricated_block("plain");
  for (const auto& [name, us] :
       {std::pair{"frustum.a", 40.0}, {"frustum.b", 20.0}, {"frustum.c", 60.0}}) {
    CellSummary cell = fabricated_cell(name, 0.3, 0, 1.0);
    cell.cull_us = fabricated_time(us);
    cell.modelled_frame_ms = us / 10.0;
    cell.culls = Culls::outside_frustum;
    cell.guarantee = Guarantee::approximate;
    block.cells.push_back(cell);
  }
  const std::vector<Fields> guides = guide_fields({block});
  ASSERT_EQ(guides.size(), 1U);
  EXPECT_EQ(guides[0].lists.at("advice")[0].values.at("sentence"),
            "Of the 3 methods to choose from on the one scene and path, take `frustum.b` (which "
            "promises no more than *approximate*): nothing costs less there.");
  EXPECT_EQ(guides[0].values.at("kind"), "view-frustum");
  EXPECT_EQ(guides[0].lists.at("rows")[0].values.at("best_ms"), "2.00");
  EXPECT_EQ(guides[0].lists.at("rows")[0].values.at("runner_up"), "`frustum.a`");
  EXPECT_EQ(guides[0].lists.at("rows")[0].values.at("moving"), "–");
}

TEST(GuideSection, ASceneWithSeveralRunsHasOneRow) {
  std::vector<BlockSummary> blocks;
  for (const char* path : {"walk", "turn"}) {
    BlockSummary block = fabricated_block("plain");
    block.path = path;
    for (const char* name : {"frustum.a", "frustum.b", "frustum.c"}) {
      CellSummary cell = fabricated_cell(name, 0.3, 0, 1.0);
      cell.culls = Culls::outside_frustum;
      block.cells.push_back(cell);
    }
    blocks.push_back(block);
  }
  blocks[1].frames += 1;
  const std::vector<Fields> guides = guide_fields(blocks);
  ASSERT_EQ(guides.size(), 1U);
  ASSERT_EQ(guides[0].lists.at("rows").size(), 1U);
  EXPECT_EQ(guides[0].lists.at("rows")[0].values.at("scene"), "plain\\, turn");
  EXPECT_EQ(guides[0].values.at("run_count"), "2");
}

TEST(CostsSection, HasARowForEachFigureOfEveryMachine) {
  BlockSummary first = fabricated_block("first");
  BlockSummary second = fabricated_block("second");
  for (const double ns : {200.0, 300.0}) {
    CostTable costs = CostTable::typical();
    costs.triangle = {ns, ns - 10.0, ns + 10.0};
    (ns < 250.0 ? first : second).costs["one"] = costs;
  }
  second.costs["two"] = CostTable::typical();
  const std::vector<Fields> rows = cost_fields({first, second});
  ASSERT_EQ(rows.size(), 2 * (cost_quantities().size() + 1));
  EXPECT_EQ(rows[0].values.at("machine"), "one, 2 threads");
  EXPECT_EQ(rows[0].values.at("quantity"), "`triangle`");
  EXPECT_EQ(rows[0].values.at("cost"), "250 (240–260)");
  EXPECT_EQ(rows.back().values.at("machine"), "two, 2 threads");
  EXPECT_EQ(rows.back().values.at("quantity"), "t_C ÷ r");
  EXPECT_EQ(rows.back().values.at("cost"), "0.0040");
}

TEST(CostsSection, CountsTheCellsThatHaveNone) {
  BlockSummary block = fabricated_block("first");
  const std::size_t cells = block.cells.size();
  EXPECT_EQ(count_uncalibrated({block}), cells);
  block.cells.front().calibrated = true;
  block.cells.back().rounds = 0;
  EXPECT_EQ(count_uncalibrated({block}), cells - 2);
}

TEST(DepthSection, HasARowForEachSceneAndPathAndThePictureOfTheDeepest) {
  ReportInput input;
  for (const char* scene : {"flat", "deep", "flat", "gone"}) {
    BlockSummary block;
    block.scene = block.scene_hash = scene;
    block.path = block.path_hash = "walk";
    block.viewport = {512, 256};
    block.frames = 9;
    input.blocks.push_back(block);
  }
  std::vector<std::string> pictured;
  input.depth_complexity = [&](const BlockSummary& block, const std::filesystem::path& file) {
    if (block.scene == "gone") throw InputError("not there");
    if (!file.empty()) pictured.push_back(block.scene + " " + file.string());
    const double mean = block.scene == "deep" ? 30.0 : 1.5;
    return DepthComplexityTable{{{mean, 40, 1200}, {50.0, 60, 70}, {0.5, 1, 2}}};
  };
  Fields fields;
  add_depth_fields(input, {}, "out", fields);
  const auto& rows = fields.lists["depths"];
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1].values.at("scene"), "deep");
  EXPECT_EQ(rows[1].values.at("frame"), "3");
  EXPECT_EQ(rows[1].values.at("rays"), "30.0 · 40 · 1,200");
  EXPECT_EQ(pictured, std::vector<std::string>{"deep out/depth-complexity.png"});
  EXPECT_EQ(fields.lists["has_depths"].size(), 1U);

  Fields none;
  add_depth_fields(ReportInput(), {}, "out", none);
  EXPECT_TRUE(none.lists["has_depths"].empty());
}

}  // namespace
}  // namespace vislab
