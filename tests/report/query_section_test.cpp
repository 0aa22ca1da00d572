#include "report/query_section.h"

#include <gtest/gtest.h>

#include "common/scene/error.h"
#include "tests/report/fabricated.h"

namespace vislab {
namespace {

/// A right method that asks `queries` a frame.
CellSummary asking(const std::string& name, double ratio, double queries) {
  CellSummary cell = fabricated_cell(name, ratio, 0, 1.0);
  cell.guarantee = Guarantee::image_exact;
  cell.asks_device = true;
  cell.counters = {{"queries", queries}, {"query_boxes", 2.0 * queries}, {"state_changes", 7.0}};
  return cell;
}

/// A modelled device on which stop_and_wait takes `waiting` times as long as none.
BlockSummary modelled_block(const std::string& scene, const std::string& latency, double waiting) {
  BlockSummary block = fabricated_block(scene);
  block.device = "modelled[preset=gpu,latency_us=" + latency + "]";
  block.cells.push_back(fabricated_cell("frustum.bvh", 0.5, 0, 4.0));
  block.cells.push_back(asking("occlusion.chcpp", 0.25, 40.0));
  block.cells.push_back(asking("occlusion.stop_and_wait", waiting, 400.0));
  return block;
}

double share_of(const BlockSummary& block) {
  if (block.scene == "gone") throw InputError("not there");
  return block.scene == "field_10" ? 0.1 : 0.75;
}

std::vector<BlockSummary> phase_blocks() {
  return {modelled_block("field_70", "1", 0.2), modelled_block("field_70", "500", 3.0),
          modelled_block("field_10", "1", 0.2505), modelled_block("field_10", "500", 0.1)};
}

TEST(PhaseDiagram, HasTheWinnerOfEachLatencyAndShare) {
  const std::vector<PhaseDiagram> diagrams = phase_diagrams(phase_blocks(), share_of);
  ASSERT_EQ(diagrams.size(), 1U);
  const PhaseDiagram& diagram = diagrams[0];
  EXPECT_EQ(diagram.latencies_us, (std::vector<double>{1.0, 500.0}));
  ASSERT_EQ(diagram.rows.size(), 2U);
  EXPECT_EQ(diagram.rows[0].scene, "field_10");  // the lower share first
  EXPECT_EQ(diagram.rows[1].hidden_share, 0.75);
  const PhaseCell& fast = *diagram.rows[1].by_latency[0];
  EXPECT_EQ(fast.winner, "occlusion.stop_and_wait");
  EXPECT_EQ(fast.next, "occlusion.chcpp");
  EXPECT_NEAR(fast.lead, 1.25, 1e-9);
  EXPECT_NEAR(*fast.over_bvh, 2.5, 1e-9);
  EXPECT_TRUE(fast.decided);
  EXPECT_EQ(diagram.rows[1].by_latency[1]->winner, "occlusion.chcpp");
  EXPECT_FALSE(diagram.rows[0].by_latency[0]->decided);
  EXPECT_EQ(diagram.winners,
            (std::vector<std::string>{"occlusion.chcpp", "occlusion.stop_and_wait"}));
}

TEST(PhaseDiagram, WrongMethodsAnchorsAndWorkOnTheProcessorTakeNoPart) {
  BlockSummary block = modelled_block("field_10", "1", 0.2);
  CellSummary wrong = asking("occlusion.wrong", 0.01, 1.0);
  wrong.image_px = 3;
  CellSummary approximate = asking("occlusion.last_frame", 0.01, 1.0);
  approximate.guarantee = Guarantee::approximate;
  block.cells.insert(block.cells.end(),
                     {wrong, approximate, fabricated_cell("depth.masked", 0.01, 0, 1.0)});
  std::vector<std::string> names;
  for (const CellSummary* cell : phase_contestants(block)) names.push_back(cell->culler);
  EXPECT_EQ(names, (std::vector<std::string>{"frustum.bvh", "occlusion.chcpp",
                                             "occlusion.stop_and_wait"}));
}

TEST(PhaseDiagram, NeedsTwoLatenciesTwoScenesAndAModelledDevice) {
  std::vector<BlockSummary> blocks = phase_blocks();
  EXPECT_TRUE(phase_diagrams({blocks[0], blocks[1]}, share_of).empty());
  EXPECT_TRUE(phase_diagrams({blocks[0], blocks[2]}, share_of).empty());
  EXPECT_TRUE(phase_diagrams(blocks, {}).empty());
  for (BlockSummary& block : blocks) block.scene = "gone";
  EXPECT_TRUE(phase_diagrams(blocks, share_of).empty());
  blocks = phase_blocks();
  for (BlockSummary& block : blocks) block.device = "osmesa";
  EXPECT_TRUE(phase_diagrams(blocks, share_of).empty());
}

TEST(PhaseDiagram, ACellThatIsMissingIsADash) {
  std::vector<BlockSummary> blocks = phase_blocks();
  blocks.pop_back();
  const std::vector<PhaseDiagram> diagrams = phase_diagrams(blocks, share_of);
  ASSERT_EQ(diagrams.size(), 1U);
  EXPECT_FALSE(diagrams[0].rows[0].by_latency[1]);
  const std::string script = phase_script(diagrams[0], "p.svg");
  EXPECT_NE(script.find("\"–\""), std::string::npos);
  EXPECT_NE(script.find("\"1.25× | 2.50×\""), std::string::npos) << script;
  EXPECT_NE(script.find("75"), std::string::npos);
}

ReportInput retest_input() {
  ReportInput input;
  BlockSummary block = modelled_block("field_10", "1", 0.2);
  for (const char* kind : {"aligned", "random"}) {
    CellSummary cell = asking(std::string("occlusion.chcpp[") + kind + "]", 0.3, 40.0);
    cell.canonical = std::string("occlusion.chcpp[interval=8,retest=") + kind + ",sigma=1.4]";
    block.cells.push_back(cell);
  }
  input.blocks.push_back(block);
  input.frame_times = [](const CellSummary& cell) {
    const bool aligned = cell.canonical.find("aligned") != std::string::npos;
    return aligned ? std::vector<double>{9.0, 1.0, 4.0, 1.0}
                   : std::vector<double>{2.0, 2.0, 2.0, 2.0};
  };
  return input;
}

TEST(QuerySection, PairsAlignedWithRandomisedReTests) {
  ReportInput input = retest_input();
  const QueryFindings findings = find_queries(input);
  ASSERT_EQ(findings.retests.size(), 1U);
  EXPECT_NEAR(findings.retests[0].aligned_deviation_ms, 1.4142136, 1e-6);
  EXPECT_EQ(findings.retests[0].random_deviation_ms, 0.0);
  EXPECT_EQ(findings.charted_retests, std::vector<std::size_t>{0});
  EXPECT_NE(query_chart_script(findings).find(retest_file_name(0)), std::string::npos);
  Fields fields;
  add_query_fields(input, findings, fields);
  EXPECT_EQ(fields.lists["retests"][0].values["worst_aligned"], "4.00");
  input.frame_times = [](const CellSummary&) -> std::vector<double> { throw InputError("gone"); };
  EXPECT_TRUE(find_queries(input).retests.empty());
}

TEST(QuerySection, ChartsQueriesASecondBySizeOfBunch) {
  ReportInput input;
  BlockSummary block = fabricated_block("field");
  for (const char* batch : {"1", "20", "80"}) {
    CellSummary cell = asking(std::string("occlusion.batched[batch=") + batch + "]", 0.5, 400.0);
    cell.canonical = cell.culler;
    block.cells.push_back(cell);
  }
  input.blocks.push_back(block);
  const QueryFindings findings = find_queries(input);
  ASSERT_EQ(findings.bunches.series.size(), 1U);
  EXPECT_EQ(findings.bunches.series[0].name, "occlusion.batched, field, orbit, osmesa");
  ASSERT_EQ(findings.bunches.series[0].points.size(), 3U);
  EXPECT_EQ(findings.bunches.series[0].points[1].first, 20.0);
  EXPECT_NEAR(findings.bunches.series[0].points[1].second, 100'000.0, 1e-6);  // 400 in 4 ms
  input.blocks[0].cells.pop_back();
  EXPECT_TRUE(find_queries(input).bunches.series.empty());
}

TEST(QuerySection, SaysWhatWasAskedWithTheTailBesideEveryMedian) {
  ReportInput input;
  input.blocks = {modelled_block("field_10", "1", 0.2)};
  CellSummary control = asking("occlusion.wrong", 0.3, 5.0);
  control.guarantee = Guarantee::erroneous;
  input.blocks[0].cells.push_back(control);
  CellSummary software = asking("depth.masked", 0.3, 5.0);
  software.asks_device = false;
  input.blocks[0].cells.push_back(software);
  Fields fields;
  add_query_fields(input, find_queries(input), fields);
  const auto& rows = fields.lists["queries"];
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].values.at("method"), "`occlusion.chcpp`");
  EXPECT_EQ(rows[0].values.at("frame_ms"), "2.00");
  EXPECT_EQ(rows[0].values.at("p99"), "2.60");
  EXPECT_EQ(rows[0].values.at("queries"), "40.0");
  EXPECT_EQ(rows[0].values.at("query_boxes"), "80.0");
  EXPECT_EQ(rows[0].values.at("flushes"), "–");

  input.blocks = phase_blocks();
  input.hidden_share = share_of;
  Fields charted;
  add_query_fields(input, find_queries(input), charted);
  EXPECT_TRUE(charted.lists["queries"].empty());
  EXPECT_EQ(charted.lists["phases"].size(), 1U);
}

TEST(QuerySection, IsLeftAwayWithoutMethodsThatAsk) {
  ReportInput input;
  input.blocks = {fabricated_block("plain")};
  Fields fields;
  add_query_fields(input, find_queries(input), fields);
  EXPECT_TRUE(fields.lists["has_queries"].empty());
  EXPECT_EQ(query_chart_script(find_queries(input)), "");
}

}  // namespace
}  // namespace vislab
