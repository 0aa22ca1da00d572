#include "experiments/analysis/summary.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "experiments/analysis/errors.h"

namespace vislab {
namespace {

constexpr const char* frustum = "frustum.flat[test=box]";

/// A cell of two frames; `times` are the frame times of its rounds, numbered from 0.
JudgedCell make_cell(const std::string& chain, const SampleGrid& times, int replicate = 0) {
  JudgedCell judged;
  ResultCell& cell = judged.cell;
  cell.key.chain = chain;
  cell.key.scene_hash = "scene";
  cell.key.path_hash = "path";
  cell.key.replicate = replicate;
  cell.culler = chain;
  cell.scene = "made_up";
  cell.path = "orbit";
  cell.scene_objects = 10;
  cell.scene_triangles = 1000;
  cell.status = ResultCell::Status::done;
  cell.context["machine"] = "one";
  cell.frames = {{"a", "t", 100, {{"plane_tests", 6}}}, {"b", "t", 300, {{"plane_tests", 10}}}};
  for (std::size_t r = 0; r < times.size(); ++r) {
    Round round;
    round.session = "s";
    round.number = static_cast<int>(r);
    round.frame_ms = times[r];
    round.update_us.assign(times[r].size(), 1000.0);
    round.cull_us.assign(times[r].size(), 2000.0);
    round.draw_ms.assign(times[r].size(), 4.0);
    cell.rounds.push_back(round);
  }
  return judged;
}

void add_anchor(JudgedCell& judged, const std::string& chain, const SampleGrid& times,
                const std::string& session = "s") {
  for (std::size_t r = 0; r < times.size(); ++r) {
    judged.cell.anchors[chain].push_back({session, static_cast<int>(r), times[r]});
  }
}

Verdict make_verdict() {
  Verdict v;
  v.pixels = 1000;
  v.visible_triangles = 100;
  v.visible_objects = 4;
  v.scene_triangles = 1000;
  v.scene_objects = 10;
  v.submitted_triangles = 340;
  v.kept_objects = 5;
  v.over_triangles_count = 250;
  v.over_objects_count = 2;
  v.under_triangles_count = 10;
  return v;
}

CellSummary only_cell(const JudgedCell& judged) {
  const std::vector<BlockSummary> blocks = summarise({judged});
  EXPECT_EQ(blocks.size(), 1U);
  EXPECT_EQ(blocks.front().cells.size(), 1U);
  return blocks.front().cells.front();
}

TEST(Summary, RatiosPairRoundsOfTheSameSessionAndNumber) {
  JudgedCell judged = make_cell(frustum, {{2.0, 4.0}, {6.0, 12.0}});
  add_anchor(judged, "none", {{4.0, 8.0}, {12.0, 24.0}});
  const CellSummary cell = only_cell(judged);
  EXPECT_DOUBLE_EQ(cell.against_none.value, 0.5);
  EXPECT_DOUBLE_EQ(cell.against_none.low, 0.5);
  EXPECT_DOUBLE_EQ(cell.against_none.high, 0.5);
  EXPECT_DOUBLE_EQ(cell.frame_ms.median.value, 6.0);  // medians of the frames: 4 and 8
  EXPECT_DOUBLE_EQ(cell.frame_ms.worst, 12.0);
  EXPECT_DOUBLE_EQ(cell.frame_ms.deviation.value, 4.0);  // of 4 and 12
  EXPECT_DOUBLE_EQ(cell.metric("frame_ms_deviation"), 4.0);
}

TEST(Summary, RoundsOfAnotherSessionAreNotPaired) {
  JudgedCell judged = make_cell(frustum, {{2.0, 4.0}});
  add_anchor(judged, "none", {{4.0, 8.0}}, "another");
  EXPECT_FALSE(only_cell(judged).against_none.measured());
}

TEST(Summary, CellsKnowWhichDialsOfTheDeviceTheyWereMeasuredOn) {
  std::vector<JudgedCell> cells = {make_cell("a", {{2.0}}), make_cell("b", {{2.0}}),
                                   make_cell("c", {{2.0}})};
  EXPECT_TRUE(summarise(cells)[0].device_models.empty());
  for (JudgedCell& cell : cells) cell.cell.device_model = gpu_preset("gpu").model;
  EXPECT_EQ(summarise(cells)[0].device_models.size(), 1U);
  cells[1].cell.device_model->latency_us += 1.0;
  const BlockSummary block = summarise(cells)[0];
  ASSERT_EQ(block.device_models.size(), 2U);
  for (const CellSummary& cell : block.cells) {
    EXPECT_EQ(block.device_models[cell.device_model].latency_us,
              gpu_preset("gpu").model.latency_us + (cell.culler == "b" ? 1.0 : 0.0));
  }
}

TEST(Summary, WithoutAnchorsThereAreTimesButNoRatios) {
  const CellSummary cell = only_cell(make_cell(frustum, {{2.0, 4.0}}));
  EXPECT_TRUE(cell.frame_ms.measured());
  EXPECT_FALSE(cell.against_none.measured());
  EXPECT_FALSE(cell.efficiency.measured());
  EXPECT_TRUE(std::isnan(cell.modelled_frame_ms));
}

TEST(Summary, EfficiencyComparesWithTheOracleOfTheSameLevel) {
  JudgedCell judged = make_cell(frustum, {{4.0, 4.0}});
  add_anchor(judged, "oracle[level=object]", {{1.0, 1.0}});
  add_anchor(judged, "oracle[level=triangle]", {{0.5, 0.5}});
  judged.cell.granularity = Granularity::object;
  EXPECT_DOUBLE_EQ(only_cell(judged).efficiency.value, 0.25);
  judged.cell.granularity = Granularity::triangle;
  EXPECT_DOUBLE_EQ(only_cell(judged).efficiency.value, 0.125);
}

TEST(Summary, AnAnchorPairsWithItself) {
  const CellSummary none = only_cell(make_cell("none", {{3.0, 5.0}}));
  EXPECT_TRUE(none.anchor);
  EXPECT_DOUBLE_EQ(none.against_none.value, 1.0);
}

TEST(Summary, ZeroRoundsGiveNoTimes) {
  const CellSummary cell = only_cell(make_cell(frustum, {}));
  EXPECT_EQ(cell.rounds, 0);
  EXPECT_FALSE(cell.frame_ms.measured());
  EXPECT_TRUE(std::isnan(cell.frame_ms.p95));
  EXPECT_TRUE(std::isnan(cell.frame_ms.worst));
  EXPECT_DOUBLE_EQ(cell.submitted_triangles, 200.0);
}

TEST(Summary, FailedCellsStayWithTheirReason) {
  JudgedCell judged = make_cell(frustum, {});
  judged.cell.frames.clear();
  judged.cell.status = ResultCell::Status::failed;
  judged.cell.reason = "out of memory";
  const CellSummary cell = only_cell(judged);
  EXPECT_EQ(cell.status, ResultCell::Status::failed);
  EXPECT_EQ(cell.reason, "out of memory");
  EXPECT_TRUE(std::isnan(cell.submitted_triangles));
}

TEST(Summary, AccuracyAddsUpOverTheFrames) {
  JudgedCell judged = make_cell(frustum, {});
  Verdict second = make_verdict();
  second.false_px = 7;
  second.max_false_px = 5;
  second.false_objects = 1;
  second.jittered = 16000;
  second.disputed_lost_px = 4;
  CellVerdicts verdicts;
  verdicts.frames = {make_verdict(), second};
  verdicts.images = {{0, 1}, {9, 2}};
  verdicts.surfaces = {{3, 1}, {2, 0}};
  verdicts.floor_disputed_px = 21;
  verdicts.outside = {400, 100};
  verdicts.back_facing = {500, 50};
  verdicts.stability = {6, 70, 3};
  judged.verdicts = verdicts;
  judged.cell.culls = Culls::outside_frustum;
  const CellSummary cell = only_cell(judged);
  EXPECT_DOUBLE_EQ(cell.metric("excused_px"), 4.0);
  EXPECT_DOUBLE_EQ(cell.metric("disputed_image_px"), 3.0);
  EXPECT_DOUBLE_EQ(cell.metric("surface_px"), 5.0);
  EXPECT_DOUBLE_EQ(cell.metric("disputed_surface_px"), 1.0);
  EXPECT_DOUBLE_EQ(cell.metric("disputed_px"), 21.0) << "the floor, not what was lost";
  EXPECT_TRUE(cell.judged);
  EXPECT_TRUE(cell.drawn);
  EXPECT_EQ(cell.pixels, 2000U);
  EXPECT_EQ(cell.false_px, 7U);
  EXPECT_EQ(cell.max_false_px, 5U);
  EXPECT_EQ(cell.image_px, 9U);
  EXPECT_EQ(cell.disputed_image_px, 3U);
  EXPECT_DOUBLE_EQ(cell.over, 2.5);
  EXPECT_DOUBLE_EQ(cell.over_objects, 0.5);
  EXPECT_DOUBLE_EQ(cell.under, 0.1);
  EXPECT_DOUBLE_EQ(cell.recall, 0.25) << "of what lies outside the frustum";
  EXPECT_DOUBLE_EQ(cell.kept_objects, 5.0);
  EXPECT_DOUBLE_EQ(cell.counters.at("plane_tests"), 8.0);
  EXPECT_DOUBLE_EQ(cell.metric("false_px"), 7.0);
  EXPECT_DOUBLE_EQ(cell.metric("flicker"), 6.0) << "one change from frame to frame";
  EXPECT_DOUBLE_EQ(cell.metric("pop"), 70.0);
  EXPECT_DOUBLE_EQ(cell.metric("latency"), 3.0);
}

TEST(Summary, RecallIsOfWhatAPerfectMethodOfTheKindWouldCull) {
  CellVerdicts verdicts;
  verdicts.frames = {make_verdict(), make_verdict()};
  verdicts.outside = {400, 100};
  verdicts.back_facing = {500, 50};
  const auto recall = [&](Culls culls) {
    JudgedCell judged = make_cell("any.name", {});
    judged.verdicts = verdicts;
    judged.cell.culls = culls;
    return only_cell(judged).recall;
  };
  EXPECT_DOUBLE_EQ(recall(Culls::outside_frustum), 0.25);
  EXPECT_DOUBLE_EQ(recall(Culls::back_faces), 0.1);
  EXPECT_DOUBLE_EQ(recall(Culls::hidden), 650.0 / 900.0);
}

TEST(Summary, OneFrameCannotFlicker) {
  JudgedCell judged = make_cell(frustum, {});
  CellVerdicts verdicts;
  verdicts.frames = {make_verdict()};
  judged.verdicts = verdicts;
  EXPECT_DOUBLE_EQ(only_cell(judged).flicker, 0.0);
}

TEST(Summary, WhereNothingIsDrawnNothingIsComparedWithDrawing) {
  JudgedCell none = make_cell("none", {{5.0, 5.0}});
  JudgedCell judged = make_cell(frustum, {{2.0, 4.0}});
  add_anchor(judged, "none", {{4.0, 8.0}});
  add_anchor(judged, "oracle[level=object]", {{1.0, 1.0}});
  none.cell.key.device = judged.cell.key.device = "none";
  const std::vector<BlockSummary> blocks = summarise({none, judged});
  EXPECT_FALSE(blocks.front().drawn);
  for (const CellSummary& cell : blocks.front().cells) {
    EXPECT_FALSE(cell.against_none.measured());
    EXPECT_FALSE(cell.efficiency.measured());
    EXPECT_TRUE(cell.cull_us.measured());
  }
}

TEST(Summary, FactsThatDifferBetweenCellsAreKept) {
  JudgedCell first = make_cell(frustum, {});
  JudgedCell second = make_cell("none", {});
  first.cell.context["revision"] = "b";
  second.cell.context["revision"] = "a";
  const std::vector<BlockSummary> blocks = summarise({first, second});
  EXPECT_EQ(blocks.front().mixed_context,
            (std::map<std::string, std::vector<std::string>>{{"revision", {"a", "b"}}}));
}

TEST(Summary, WithoutVerdictsNothingIsJudged) {
  const CellSummary cell = only_cell(make_cell(frustum, {{1.0, 1.0}}));
  EXPECT_FALSE(cell.judged);
  EXPECT_TRUE(std::isnan(cell.over));
  EXPECT_TRUE(std::isnan(cell.metric("false_px")));
}

CostTable made_up_costs(double triangle_ns) {
  CostTable costs;
  costs.triangle = Cost::exactly(triangle_ns);
  costs.draw = Cost::exactly(1000.0);
  costs.piece = Cost::exactly(100.0);
  return costs;
}

/// make_cell with costs, and in both frames `draws` in `pieces`.
JudgedCell calibrated_cell(const std::string& chain, const SampleGrid& times, double triangle_ns,
                           std::uint64_t draws = 0, std::uint64_t pieces = 0) {
  JudgedCell judged = make_cell(chain, times);
  judged.cell.costs = made_up_costs(triangle_ns);
  for (CellFrame& frame : judged.cell.frames) {
    frame.draws = draws;
    frame.pieces = pieces;
  }
  return judged;
}

TEST(Summary, TheModelledFrameAddsTestsAndWhatIsSubmittedAtCalibratedCosts) {
  // 3 ms of tests; 200 triangles at 2 us, 50 draws at 1 us, 70 pieces at 0.1 us beyond the first of
  // each.
  const CellSummary cell = only_cell(calibrated_cell(frustum, {{9.0, 9.0}}, 2000.0, 50, 120));
  EXPECT_DOUBLE_EQ(cell.modelled_frame_ms, 3.0 + 0.4 + 0.05 + 0.007);
}

TEST(Summary, TheModelledFrameDoesNotNeedADrawnBlock) {
  JudgedCell judged = calibrated_cell(frustum, {{9.0, 9.0}}, 2000.0);
  judged.cell.key.device = "none";
  EXPECT_DOUBLE_EQ(only_cell(judged).modelled_frame_ms, 3.4);
}

TEST(Summary, AllCellsOfAMachineAreModelledWithOneTable) {
  const std::vector<BlockSummary> blocks =
      summarise({calibrated_cell("none", {{9.0, 9.0}}, 1000.0),
                 calibrated_cell("backface.polygon", {{9.0, 9.0}}, 2000.0),
                 calibrated_cell(frustum, {{9.0, 9.0}}, 6000.0)});
  EXPECT_DOUBLE_EQ(blocks.front().costs.at("one").triangle.ns, 2000.0) << "the median";
  for (const CellSummary& cell : blocks.front().cells) {
    EXPECT_DOUBLE_EQ(cell.modelled_frame_ms, 3.4) << cell.culler;
  }
}

TEST(Summary, AMethodThatUsesTheDeviceIsModelledByWhatItSavesThere) {
  JudgedCell asks = calibrated_cell("backface.gl[open=two_sided]", {{4.0, 4.0}}, 2000.0);
  asks.cell.asks_device = true;
  add_anchor(asks, "none", {{8.0, 8.0}});
  const JudgedCell none = calibrated_cell("none", {{8.0, 8.0}}, 2000.0);
  const std::vector<BlockSummary> blocks = summarise({none, asks});
  EXPECT_DOUBLE_EQ(blocks.front().cells.front().modelled_frame_ms, 3.4);
  EXPECT_DOUBLE_EQ(blocks.front().cells.back().modelled_frame_ms, 1.7);
  EXPECT_TRUE(std::isnan(only_cell(asks).modelled_frame_ms)) << "there is no none to model";
}

TEST(Summary, ResultsFromBeforeCostsWereMeasuredHaveNoModelledFrame) {
  const std::vector<BlockSummary> blocks =
      summarise({make_cell("none", {{9.0, 9.0}}), calibrated_cell(frustum, {{9.0, 9.0}}, 2000.0)});
  EXPECT_FALSE(blocks.front().cells.front().calibrated);
  EXPECT_TRUE(std::isnan(blocks.front().cells.front().modelled_frame_ms));
  EXPECT_DOUBLE_EQ(blocks.front().cells.back().modelled_frame_ms, 3.4);
}

TEST(Summary, TheControlGivesTheNoise) {
  JudgedCell control = make_cell("none", {{5.5, 5.5}}, 1);
  add_anchor(control, "none", {{5.0, 5.0}});
  const std::vector<BlockSummary> blocks = summarise({control, make_cell("none", {{5.0, 5.0}})});
  ASSERT_EQ(blocks.front().cells.size(), 2U);
  EXPECT_DOUBLE_EQ(blocks.front().noise.value, 1.1);
  EXPECT_EQ(blocks.front().cells[0].culler, "none");
  EXPECT_EQ(blocks.front().cells[1].culler, "none (again)");
  EXPECT_TRUE(blocks.front().cells[1].anchor);
}

TEST(Summary, AnchorsComeFirstAndTheRestByName) {
  const std::vector<BlockSummary> blocks =
      summarise({make_cell(frustum, {}), make_cell("backface.polygon", {}),
                 make_cell("oracle[level=triangle]", {}), make_cell("oracle[level=object]", {}),
                 make_cell("none", {}, 1), make_cell("none", {})});
  std::vector<std::string> names;
  for (const CellSummary& cell : blocks.front().cells) names.push_back(cell.culler);
  EXPECT_EQ(names,
            (std::vector<std::string>{"none", "none (again)", "oracle[level=object]",
                                      "oracle[level=triangle]", "backface.polygon", frustum}));
}

TEST(Summary, CellsOfOtherResolutionsAreOtherBlocks) {
  JudgedCell large = make_cell(frustum, {});
  large.cell.key.viewport = {1024, 1024};
  EXPECT_EQ(summarise({make_cell(frustum, {}), large}).size(), 2U);
}

TEST(Summary, BlocksStandInTheOrderOfTheirNumbers) {
  std::vector<JudgedCell> cells;
  for (const char* scene : {"hares_252", "hares_56", "city", "hares_56_wide", "oa_dm2"}) {
    cells.push_back(make_cell(frustum, {}));
    cells.back().cell.scene = scene;
  }
  std::vector<std::string> scenes;
  for (const BlockSummary& block : summarise(cells)) scenes.push_back(block.scene);
  EXPECT_EQ(scenes,
            (std::vector<std::string>{"city", "hares_56", "hares_56_wide", "hares_252", "oa_dm2"}));
}

TEST(Summary, EveryMachineOfABlockIsNamed) {
  JudgedCell other = make_cell("backface.polygon", {});
  other.cell.context["machine"] = "another";
  const std::vector<BlockSummary> blocks = summarise({make_cell(frustum, {}), other});
  EXPECT_EQ(blocks.front().machines, (std::vector<std::string>{"another", "one"}));
}

TEST(Summary, TheErrorFloorIsThatOfTheFramesNotOfEachCell) {
  CellVerdicts verdicts;
  verdicts.frames = {make_verdict(), make_verdict()};
  verdicts.images = {{}, {}};
  verdicts.floor_disputed_px = 12;
  JudgedCell first = make_cell("none", {});
  JudgedCell second = make_cell(frustum, {});
  first.verdicts = second.verdicts = verdicts;
  const std::vector<BlockSummary> blocks = summarise({first, second});
  EXPECT_EQ(blocks.front().floor_pixels, 2000U);
  EXPECT_EQ(blocks.front().floor_disputed_px, 12U);
}

TEST(Summary, NoCellsGiveNoBlocks) { EXPECT_TRUE(summarise({}).empty()); }

TEST(Errors, EachKindIsFoundInTheCellsThatItAppliesTo) {
  CellSummary cell;
  cell.judged = cell.drawn = cell.paints = true;
  cell.regions.emplace();
  EXPECT_TRUE(is_free_of_errors(cell));
  const std::array<std::uint64_t*, error_kinds.size()> counts{
      &cell.false_px,      &cell.image_px,       &cell.surface_px,
      &cell.false_objects, &cell.false_jittered, &cell.regions->misses};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    *counts[i] = 3;
    ErrorCounts expected{};
    expected[i] = 3;
    EXPECT_EQ(error_counts(cell), expected) << error_kinds[i].metric;
    for (const Guarantee guarantee :
         {Guarantee::conservative, Guarantee::image_exact, Guarantee::approximate}) {
      cell.guarantee = guarantee;
      const bool counted = guarantee != Guarantee::image_exact || !error_kinds[i].between_pixels;
      EXPECT_EQ(is_free_of_errors(cell), !counted)
          << error_kinds[i].metric << ", " << to_string(guarantee);
    }
    *counts[i] = 0;
  }
  cell.image_px = cell.surface_px = 3;
  cell.drawn = cell.paints = false;
  EXPECT_EQ(error_counts(cell), ErrorCounts{});
}

TEST(Errors, BetweenPixelsThePromiseOfTheStricterSideCounts) {
  const auto counts = [](Guarantee a, Guarantee b) {
    return counts_between_pixels(std::array{a, b});
  };
  EXPECT_TRUE(counts(Guarantee::conservative, Guarantee::image_exact));
  EXPECT_TRUE(counts(Guarantee::approximate, Guarantee::erroneous));
  EXPECT_FALSE(counts(Guarantee::image_exact, Guarantee::image_exact));
  EXPECT_FALSE(counts(Guarantee::erroneous, Guarantee::image_exact));
}

}  // namespace
}  // namespace vislab
