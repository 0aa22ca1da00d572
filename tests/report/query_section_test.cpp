#include "report/query_section.h"

#include <gtest/gtest.h>

#include <algorithm>

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
  block.cells.back().culls = Culls::outside_frustum;
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
  EXPECT_NEAR(*fast.over_frustum, 2.5, 1e-9);
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

TEST(PhaseDiagram, OnlyWholeWordsThatAreNumbersMakeASeries) {
  std::vector<BlockSummary> blocks = phase_blocks();
  for (BlockSummary& block : blocks) {
    block.scene = block.scene == "field_10" ? "box_field_10k" : "box_field_1m";
  }
  EXPECT_TRUE(phase_diagrams(blocks, share_of).empty());
  EXPECT_EQ(phase_diagrams(phase_blocks(), share_of)[0].title,
            "field_* on modelled[preset=gpu], 512 × 512");
}

TEST(PhaseDiagram, BlocksThatDifferInMoreThanSceneAndLatencyStandApart) {
  for (const auto change :
       {+[](BlockSummary& block) { block.threads = 1; },
        +[](BlockSummary& block) { block.frames = 7; },
        +[](BlockSummary& block) { block.seed = 9; },
        +[](BlockSummary& block) {
          block.viewport = {64, 64};
        },
        +[](BlockSummary& block) { block.device_models = {gpu_preset("gpu").model}; }}) {
    std::vector<BlockSummary> blocks = phase_blocks();
    for (BlockSummary block : phase_blocks()) {
      change(block);
      blocks.push_back(block);
    }
    const std::vector<PhaseDiagram> diagrams = phase_diagrams(blocks, share_of);
    ASSERT_EQ(diagrams.size(), 2U);
    EXPECT_EQ(diagrams[0].blocks.size(), 4U);
    EXPECT_EQ(diagrams[1].blocks.size(), 4U);
    EXPECT_NE(diagrams[0].title, diagrams[1].title);
  }
}

TEST(PhaseDiagram, BlocksOfSeveralFitsTakeNoPart) {
  std::vector<BlockSummary> blocks = phase_blocks();
  for (BlockSummary& block : blocks) {
    block.device_models = {gpu_preset("gpu").model, gpu_preset("modern").model};
  }
  EXPECT_TRUE(phase_diagrams(blocks, share_of).empty());
}

TEST(PhaseDiagram, SaysWhoWasLeftOutAndWhy) {
  std::vector<BlockSummary> blocks = phase_blocks();
  CellSummary failed = asking("occlusion.chc", 0.3, 5.0);
  failed.status = ResultCell::Status::failed;
  failed.reason = "timed out";
  failed.frame_ms.median = Estimate::none();
  blocks[0].cells.push_back(failed);
  for (BlockSummary& block : blocks) block.cells.back().image_px = 1;
  const std::vector<PhaseAbsence> absences = phase_diagrams(blocks, share_of)[0].absences;
  ASSERT_EQ(absences.size(), 2U);
  EXPECT_EQ(absences[0].reason, "failed: timed out");
  EXPECT_EQ(absences[0].cells, 1U);
  EXPECT_EQ(absences[1].culler, "occlusion.stop_and_wait");
  EXPECT_EQ(absences[1].reason, "is wrong");
  EXPECT_EQ(absences[1].cells, 3U);
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
  add_query_fields(input, findings, {}, fields);
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
  ASSERT_EQ(findings.bunches.size(), 1U);
  EXPECT_EQ(findings.bunches[0].device, "osmesa");
  const std::vector<LineSeries>& lines = findings.bunches[0].chart.series;
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].name, "occlusion.batched, field, orbit");
  ASSERT_EQ(lines[0].points.size(), 3U);
  EXPECT_EQ(lines[0].points[1].first, 20.0);
  EXPECT_NEAR(lines[0].points[1].second, 100'000.0, 1e-6);  // 400 in 4 ms
  input.blocks[0].cells.pop_back();
  EXPECT_TRUE(find_queries(input).bunches.empty());
}

TEST(QuerySection, NamesChainsInChartsOfBunchesWhole) {
  ReportInput input;
  BlockSummary block = fabricated_block("field");
  for (const char* batch : {"1", "20", "80"}) {
    for (const char* sizes : {"batch=B", "batch=B,order=near", "order=near,batch=B"}) {
      std::string last = std::string("occlusion.batched[") + sizes + "]";
      last.replace(last.find('B'), 1, batch);
      CellSummary cell = asking("frustum.bvh > occlusion.chcpp[batch=7] > " + last, 0.5, 400.0);
      cell.canonical = cell.culler;
      block.cells.push_back(cell);
    }
  }
  CellSummary usual = asking("frustum.bvh > occlusion.batched", 0.5, 400.0);
  usual.canonical = "frustum.bvh > occlusion.batched[batch=20,order=far]";
  block.cells.push_back(usual);
  for (const char* batch : {"1", "80"}) {
    CellSummary cell = usual;
    cell.canonical = std::string("frustum.bvh > occlusion.batched[batch=") + batch + ",order=far]";
    cell.culler = std::string("frustum.bvh > occlusion.batched[batch=") + batch + "]";
    block.cells.push_back(cell);
  }
  input.blocks.push_back(block);
  block.device = "modelled[preset=gpu]";
  input.blocks.push_back(block);
  const QueryFindings findings = find_queries(input);
  ASSERT_EQ(findings.bunches.size(), 2U);  // a chart for each device
  std::vector<std::string> names;
  for (const LineSeries& line : findings.bunches[1].chart.series) names.push_back(line.name);
  const std::string start = "frustum.bvh > occlusion.chcpp[batch=7] > occlusion.batched";
  std::ranges::sort(names);
  EXPECT_EQ(names,
            (std::vector<std::string>{
                "frustum.bvh > occlusion.batched, field, orbit", start + ", field, orbit",
                start + "[order=near], field, orbit", start + "[order=near], field, orbit"}));
}

TEST(QuerySection, TimesOfFitsThatDifferAreMarked) {
  ReportInput input;
  BlockSummary block = fabricated_block("field");
  block.device = "modelled[preset=osmesa]";
  block.device_models = {gpu_preset("gpu").model, gpu_preset("modern").model};
  for (const std::size_t fit : {0, 1}) {
    block.cells.push_back(asking("occlusion.chcpp", 0.5, 40.0));
    block.cells.back().device_model = fit;
  }
  input.blocks = {block};
  Fields fields;
  add_query_fields(input, find_queries(input), {}, fields);
  const auto& rows = fields.lists["queries"];
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].values.at("device"), "`modelled[preset=osmesa]`, fit 1");
  EXPECT_EQ(rows[1].values.at("device"), "`modelled[preset=osmesa]`, fit 2");
  input.blocks[0].device_models.pop_back();
  input.blocks[0].cells.back().device_model = 0;
  Fields same;
  add_query_fields(input, find_queries(input), {}, same);
  EXPECT_EQ(same.lists["queries"][1].values["device"], "`modelled[preset=osmesa]`");
}

/// A block in which one method asks about so many objects, each alone.
BlockSummary asking_block(const std::string& scene, double most) {
  BlockSummary block = fabricated_block(scene);
  block.cells.push_back(asking("occlusion.chcpp", 0.2, 40.0));
  block.cells.back().counters["state_changes"] = 9.0;
  block.cells.push_back(asking("occlusion.stop_and_wait", 0.9, 400.0));
  block.cells.back().counters = {
      {"queries", most}, {"query_boxes", most}, {"state_changes", 300.0}};
  block.cells.push_back(asking("occlusion.chcpp[sleep=false]", 0.1, 40.0));
  block.cells.push_back(asking("occlusion.wrong", 0.1, 400.0));
  block.cells.back().image_px = 5;
  return block;
}

TEST(QuerySection, PicturesAreOfTheScenesWithMostHiddenAndOfMethodsThatAreRight) {
  ReportInput input;
  input.blocks = {asking_block("small", 20.0),  asking_block("city", 700.0),
                  asking_block("city", 800.0),  asking_block("plant", 300.0),
                  asking_block("field", 900.0), fabricated_block("plain")};
  for (CellSummary& cell : input.blocks[4].cells) cell.kept_objects = 890.0;  // little is hidden
  std::vector<std::string> asked;
  input.query_picture = [&](const BlockSummary& block, const std::vector<const CellSummary*>& cells,
                            QueryPicture picture, const std::filesystem::path&) {
    std::string call = block.scene + " " + std::string(to_string(picture));
    for (const CellSummary* cell : cells) call += " " + cell->culler;
    asked.push_back(call);
    if (block.scene == "plant") throw InputError("gone");
    return block.scene + ", frame 3";
  };
  const QueryFindings findings = find_queries(input);
  ASSERT_EQ(findings.pictures.size(), 2U);
  EXPECT_EQ(findings.pictures[0].block, &input.blocks[2]);
  Fields fields;
  add_query_fields(input, findings, {}, fields);
  EXPECT_EQ(asked,
            (std::vector<std::string>{"city strip occlusion.stop_and_wait occlusion.chcpp",
                                      "plant strip occlusion.stop_and_wait occlusion.chcpp",
                                      "city boxes occlusion.chcpp", "plant boxes occlusion.chcpp",
                                      "city timeline occlusion.stop_and_wait occlusion.chcpp",
                                      "plant timeline occlusion.stop_and_wait occlusion.chcpp"}));
  ASSERT_EQ(fields.lists["query_boxes"].size(), 1U);
  EXPECT_EQ(fields.lists["query_boxes"][0].values["place"], R"(city\, frame 3)");
  EXPECT_EQ(fields.lists["query_pictures_missing"].size(), 3U);
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
  add_query_fields(input, find_queries(input), {}, fields);
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
  add_query_fields(input, find_queries(input), {}, charted);
  EXPECT_TRUE(charted.lists["queries"].empty());
  EXPECT_EQ(charted.lists["phases"].size(), 1U);
}

TEST(QuerySection, IsLeftAwayWithoutMethodsThatAsk) {
  ReportInput input;
  input.blocks = {fabricated_block("plain")};
  Fields fields;
  add_query_fields(input, find_queries(input), {}, fields);
  EXPECT_TRUE(fields.lists["has_queries"].empty());
  EXPECT_EQ(query_chart_script(find_queries(input)), "");
}

}  // namespace
}  // namespace vislab
