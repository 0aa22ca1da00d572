#include "report/chart.h"

#include <gtest/gtest.h>

#include "report/chart_axis.h"
#include "report/chart_labels.h"
#include "report/dial_curves.h"
#include "tests/report/fabricated.h"

namespace vislab {
namespace {

TEST(Chart, TheParetoHullHoldsWhatNothingBeats) {
  //  y            0: beaten by 1 in both, 1, 2 and 4: on the hull, 3: beaten by 2
  const std::vector<double> x{3.0, 1.0, 2.0, 4.0, 5.0};
  const std::vector<double> y{9.0, 8.0, 4.0, 4.0, 0.0};
  EXPECT_EQ(pareto_hull(x, y), (std::vector<std::size_t>{1, 2, 4}));
}

TEST(Chart, EqualPointsStandOnTheHullOnce) {
  EXPECT_EQ(pareto_hull({1.0, 1.0}, {0.0, 0.0}).size(), 1U);
  EXPECT_TRUE(pareto_hull({}, {}).empty());
}

TEST(Chart, ZeroHasItsPlaceBelowTheLowestDecade) {
  const ChartAxis axis = logarithmic_axis({0.0, 3.0, 25000.0}, 10.0, "0 of 100,000");
  EXPECT_LT(axis.position(0.0), 1.0);
  EXPECT_GT(axis.share(0.0), 0.0);
  EXPECT_LT(axis.share(0.0), axis.share(1.0));
  EXPECT_LT(axis.share(25000.0), 1.0);
  EXPECT_EQ(axis.ticks.front().second, "0 of 100,000");
  EXPECT_DOUBLE_EQ(axis.ticks.front().first, axis.position(0.0));
}

TEST(Chart, AnAxisOfZeroesAloneStillShowsTheScale) {
  const ChartAxis axis = logarithmic_axis({0.0, 0.0}, 10.0, "0 of 5");
  EXPECT_EQ(axis.ticks.back().second, "10");
}

TEST(Chart, TimesNearEachOtherStartAtZero) {
  const ChartAxis near = positive_axis({2.0, 8.0});
  EXPECT_FALSE(near.logarithmic);
  EXPECT_DOUBLE_EQ(near.low, 0.0);
  EXPECT_GT(near.high, 8.0);
  const ChartAxis far = positive_axis({0.1, 8.0});
  EXPECT_TRUE(far.logarithmic);
  EXPECT_LT(far.low, 0.1);
}

TEST(Chart, TicksOfSmallFiguresAreToldApart) {
  std::set<std::string> labels;
  const ChartAxis axis = positive_axis({2e-4, 2.5e-4});
  for (const auto& [at, label] : axis.ticks) labels.insert(label);
  EXPECT_EQ(labels.size(), axis.ticks.size());
  EXPECT_TRUE(labels.contains("10⁻⁴")) << *labels.begin();
}

TEST(Chart, LabelsOfPointsInOnePlaceDoNotOverlap) {
  const std::vector<LabelRequest> requests(6, LabelRequest{50.0, 50.0, 12.0, 10.0});
  const ChartBox mark{45.0, 45.0, 55.0, 55.0};
  const std::vector<PlacedLabel> labels = place_labels(requests, {mark}, {0.0, 0.0, 100.0, 100.0});
  std::vector<ChartBox> boxes{mark};
  for (const PlacedLabel& label : labels) {
    const ChartBox box{label.x - 6.0, label.y - 5.0, label.x + 6.0, label.y + 5.0};
    for (const ChartBox& other : boxes) EXPECT_DOUBLE_EQ(box.overlap(other), 0.0);
    boxes.push_back(box);
  }
}

TEST(Chart, LabelsStayInsideTheFrame) {
  const std::vector<PlacedLabel> labels =
      place_labels({{1.0, 99.0, 12.0, 10.0}}, {}, {0.0, 0.0, 100.0, 100.0});
  EXPECT_GE(labels.front().x, 6.0);
  EXPECT_LE(labels.front().y, 95.0);
}

TEST(Chart, LegibleLabelsNeverOverlapAlsoWhereThereIsNoRoomForAll) {
  const std::vector<LabelRequest> requests(60, LabelRequest{50.0, 50.0, 12.0, 10.0});
  std::vector<ChartBox> legible;
  for (const PlacedLabel& label : place_labels(requests, {}, {0.0, 0.0, 100.0, 100.0})) {
    if (!label.is_legible) continue;
    const ChartBox box{label.x - 6.0, label.y - 5.0, label.x + 6.0, label.y + 5.0};
    for (const ChartBox& other : legible) EXPECT_DOUBLE_EQ(box.overlap(other), 0.0);
    legible.push_back(box);
  }
  EXPECT_GT(legible.size(), 3U);
  EXPECT_LT(legible.size(), requests.size());
}

TEST(Chart, NoLineFromALabelToItsPointCrossesALabel) {
  std::vector<LabelRequest> requests;
  for (int i = 0; i < 40; ++i) {
    requests.push_back({100.0 + 6.0 * (i % 8), 100.0 + 9.0 * (i / 8), 30.0, 10.0});
  }
  const std::vector<PlacedLabel> labels = place_labels(requests, {}, {0.0, 0.0, 240.0, 240.0});
  int leaders = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!labels[i].is_legible || !labels[i].leader) continue;
    ++leaders;
    for (std::size_t j = 0; j < labels.size(); ++j) {
      if (j == i || !labels[j].is_legible) continue;
      for (double way = 0.0; way < 1.0; way += 0.01) {
        const double x = requests[i].x + way * (labels[i].x - requests[i].x);
        const double y = requests[i].y + way * (labels[i].y - requests[i].y);
        EXPECT_FALSE(std::abs(x - labels[j].x) < 14.9 && std::abs(y - labels[j].y) < 4.9)
            << "the line of label " << i << " runs through label " << j;
      }
    }
  }
  EXPECT_GT(leaders, 3);
}

TEST(Chart, PointsThatLieTogetherShareTheirNumbers) {
  const std::vector<PointGroup> groups =
      group_points({{10.0, 10.0, 7}, {80.0, 10.0, 2}, {14.0, 12.0, 3}, {12.0, 8.0, 4}}, 5.0);
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(number_list(groups[0].numbers), "3, 4, 7");
  EXPECT_DOUBLE_EQ(groups[0].x, 12.0);
  EXPECT_DOUBLE_EQ(groups[0].y, 10.0);
  EXPECT_EQ(number_list({9, 1, 2, 3, 5}), "1–3, 5, 9");
}

TEST(Chart, TimesOfSeveralMachinesHaveNoAxis) {
  BlockSummary block = fabricated_block("made_up");
  EXPECT_TRUE(has_time_axis(block));
  EXPECT_NE(chart_script(block, "x.svg").find("frame_ms"), std::string::npos);
  block.machines = {"one", "two"};
  EXPECT_FALSE(has_time_axis(block));
  EXPECT_EQ(chart_script(block, "x.svg").find("frame_ms"), std::string::npos);
  EXPECT_NE(chart_script(block, "x.svg").find("triangles submitted"), std::string::npos);
}

TEST(Chart, OnlyJudgedAndTimedCellsHaveAPoint) {
  BlockSummary block = fabricated_block("made_up");
  block.cells[2].judged = false;
  block.cells[3].frame_ms.median = Estimate::none();
  EXPECT_EQ(charted_cells(block).size(), 2U);
}

TEST(Chart, OfManyMethodsOnlyTheAnchorsAndTheHullsAreNamed) {
  BlockSummary block = fabricated_block("made_up");
  for (int i = 0; i < 40; ++i) {
    block.cells.push_back(fabricated_cell("frustum.m" + std::to_string(i), 0.5 + 0.01 * i, 0, 2.0));
  }
  const std::string script = chart_script(block, "x.svg");
  EXPECT_NE(script.find("frustum.m0"), std::string::npos);
  EXPECT_EQ(script.find("frustum.m1"), std::string::npos);
  EXPECT_NE(script.find("other methods"), std::string::npos);
  block.cells.resize(20);
  EXPECT_NE(chart_script(block, "x.svg").find("frustum.m1"), std::string::npos);
}

TEST(Chart, ScriptsSayHowManyPixelsZeroIsOf) {
  EXPECT_NE(chart_script(fabricated_block("made_up"), "x.svg").find("0 of\\n15,728,640"),
            std::string::npos);
}

CellSummary on_dial(const std::string& canonical, const std::string& name) {
  CellSummary cell = fabricated_cell(name, 0.5, 0, 2.0);
  cell.canonical = canonical;
  return cell;
}

TEST(Chart, CellsThatDifferInOneDialLieOnACurveInItsOrder) {
  const std::vector<CellSummary> cells{
      on_dial("a.x[depth=16,test=box] > b.y[n=1]", "a.x[depth=16] > b.y"),
      on_dial("a.x[depth=2,test=box] > b.y[n=1]", "a.x[depth=2] > b.y"),
      on_dial("a.x[depth=2,test=sphere] > b.y[n=1]", "a.x[depth=2,test=sphere] > b.y"),
      on_dial("a.x[depth=6,test=box] > b.y[n=1]", "a.x > b.y"),
      on_dial("a.x[depth=6,test=box] > b.y[n=3]", "a.x > b.y[n=3]")};
  std::vector<const CellSummary*> pointers;
  for (const CellSummary& cell : cells) pointers.push_back(&cell);
  const std::vector<DialCurve> curves = dial_curves(pointers);
  ASSERT_EQ(curves.size(), 2U);  // none over test, which is no number
  EXPECT_EQ(curves[0].name, "a.x > b.y");
  EXPECT_EQ(curves[0].parameter, "depth");
  EXPECT_EQ(curves[0].cells, (std::vector<std::size_t>{1, 3, 0}));
  EXPECT_EQ(curves[0].values, (std::vector<std::string>{"2", "6", "16"}));
  EXPECT_EQ(curves[1].parameter, "n");
  EXPECT_EQ(curves[1].cells, (std::vector<std::size_t>{3, 4}));
}

TEST(Chart, AnchorsLieOnNoCurve) {
  CellSummary one = on_dial("oracle[n=1]", "oracle");
  CellSummary two = on_dial("oracle[n=2]", "oracle[n=2]");
  one.anchor = two.anchor = true;
  EXPECT_TRUE(dial_curves({&one, &two}).empty());
}

TEST(Chart, CurvesAreDrawnAndLabelledAtTheirEnds) {
  BlockSummary block = fabricated_block("made_up");
  for (const char* value : {"2", "4", "8"}) {
    const std::string text = std::string("a.x[depth=") + value + "]";
    block.cells.push_back(on_dial(text, text));
  }
  const std::string script = chart_script(block, "x.svg");
  EXPECT_NE(script.find("5–7  a.x over depth"), std::string::npos);
  EXPECT_NE(script.find("set label \"=2\""), std::string::npos);
  EXPECT_EQ(script.find("set label \"=4\""), std::string::npos);
  EXPECT_NE(script.find("set label \"=8\""), std::string::npos);
}

TEST(Chart, AChoiceLeavesMethodsOutButNoAnchors) {
  BlockSummary block = fabricated_block("made_up");
  block.cells.push_back(fabricated_cell("frustum.flat", 0.5, 0, 2.0));
  block.cells.push_back(fabricated_cell("depth.hzb", 0.5, 0, 2.0));
  const std::string script = chart_script(
      block, "x.svg", [](const CellSummary& cell) { return cell.culler == "depth.hzb"; });
  EXPECT_EQ(script.find("frustum.flat"), std::string::npos);
  EXPECT_NE(script.find("6  depth.hzb"), std::string::npos);
  EXPECT_NE(script.find("1  none"), std::string::npos);
}

}  // namespace
}  // namespace vislab
