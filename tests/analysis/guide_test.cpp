#include "experiments/analysis/guide.h"

#include <gtest/gtest.h>

#include "experiments/analysis/published.h"

namespace vislab {
namespace {

CellSummary method(const std::string& name, double cull_us, double frame_ms) {
  CellSummary cell;
  cell.culler = cell.canonical = name;
  cell.judged = cell.drawn = true;
  cell.cull_us.median = {cull_us, cull_us, cull_us};
  cell.update_us.median = {1.0, 1.0, 1.0};
  cell.frame_ms.median = {frame_ms, frame_ms, frame_ms};
  cell.modelled_frame_ms = frame_ms;
  cell.culls = Culls::outside_frustum;
  cell.against_none = {frame_ms / 10.0, 0.9 * frame_ms / 10.0, 1.1 * frame_ms / 10.0};
  return cell;
}

BlockSummary block_with(const std::string& scene, std::vector<CellSummary> cells) {
  BlockSummary block;
  block.scene = scene;
  block.path = "way";
  block.objects = 100;
  block.machines = {"one"};
  block.cells = std::move(cells);
  return block;
}

/// Decision times only: all submit the same.
BlockSummary undrawn(BlockSummary block) {
  block.drawn = false;
  return block;
}

TEST(Guide, NamesTheRightMethodThatCostsLeastAndTheNextAndTheSoonest) {
  const std::vector<BlockSummary> blocks{
      block_with("s", {method("frustum.a", 9.0, 2.0), method("frustum.b", 4.0, 3.0),
                       method("frustum.c", 19.0, 4.0)})};
  const auto guides = make_guides(blocks);
  ASSERT_EQ(guides.size(), 1U);
  EXPECT_EQ(guides[0].culls, Culls::outside_frustum);
  ASSERT_EQ(guides[0].rows.size(), 1U);
  EXPECT_EQ(guides[0].rows[0].best->culler, "frustum.a");
  EXPECT_EQ(guides[0].rows[0].runner_up->culler, "frustum.b");
  EXPECT_EQ(guides[0].rows[0].soonest->culler, "frustum.b");
  ASSERT_EQ(guides[0].advice.size(), 1U);
  EXPECT_EQ(guides[0].advice[0].choice.culler, "frustum.a");
  EXPECT_EQ(guides[0].advice[0].eligible, 3U);
}

TEST(Guide, AMethodThatKeepsEverythingDoesNotDecideSoonest) {
  std::vector<CellSummary> cells{method("frustum.idle", 0.1, 9.0), method("frustum.a", 3.0, 8.0),
                                 method("frustum.b", 4.0, 7.0), method("none", 0.0, 10.0)};
  for (CellSummary& cell : cells) cell.submitted_triangles = 1000.0;
  cells[1].submitted_triangles = cells[2].submitted_triangles = 500.0;
  cells[3].anchor = true;
  const std::vector<BlockSummary> blocks{block_with("s", cells)};
  const auto guides = make_guides(blocks);
  ASSERT_EQ(guides.size(), 1U);
  EXPECT_EQ(guides[0].rows[0].soonest->culler, "frustum.a");
}

TEST(Guide, WhereNothingIsDrawnAMethodThatHardlyCullsCannotWin) {
  std::vector<CellSummary> cells{method("frustum.lazy", 1.0, 1.0), method("frustum.a", 9.0, 1.0),
                                 method("frustum.b", 8.0, 1.0), method("frustum.c", 7.0, 1.0)};
  for (CellSummary& cell : cells) cell.submitted_triangles = 1000.0;
  cells[0].submitted_triangles = 1011.0;
  cells[2].submitted_triangles = 1009.0;
  const std::vector<BlockSummary> blocks{undrawn(block_with("s", cells))};
  const auto guides = make_guides(blocks);
  ASSERT_EQ(guides.size(), 1U);
  EXPECT_EQ(guides[0].rows[0].best->culler, "frustum.c");
  EXPECT_EQ(guides[0].advice.at(0).eligible, 3U);
}

TEST(Guide, MethodsOfAllFamiliesThatCullTheSameCompete) {
  CellSummary other = method("backface.x", 1.0, 1.0);
  other.culls = Culls::back_faces;
  const std::vector<BlockSummary> blocks{
      block_with("s", {method("frustum.a", 9.0, 4.0), method("frustum.b", 9.0, 3.0),
                       method("peer.c", 9.0, 2.0), other})};
  const auto guides = make_guides(blocks);
  ASSERT_EQ(guides.size(), 1U);
  EXPECT_EQ(guides[0].rows[0].best->culler, "peer.c");
}

TEST(Guide, MethodsWithErrorsChainsAnchorsAndNegativeControlsDoNotCount) {
  CellSummary wrong = method("frustum.wrong", 1.0, 1.0);
  wrong.guarantee = Guarantee::erroneous;
  CellSummary erring = method("frustum.erring", 1.0, 1.0);
  erring.false_px = 1;
  CellSummary failed = method("frustum.failed", 1.0, 1.0);
  failed.status = ResultCell::Status::failed;
  CellSummary anchor = method("oracle", 1.0, 1.0);
  anchor.anchor = true;
  std::vector<CellSummary> cells{wrong,
                                 erring,
                                 failed,
                                 anchor,
                                 method("frustum.a > backface.b", 1.0, 1.0),
                                 method("frustum.a", 5.0, 1.0),
                                 method("frustum.b", 6.0, 1.0)};
  const std::vector<BlockSummary> too_few{block_with("s", cells)};
  EXPECT_TRUE(make_guides(too_few).empty()) << "only two are left";
  cells.push_back(method("frustum.c", 7.0, 1.0));
  const std::vector<BlockSummary> enough{block_with("s", cells)};
  ASSERT_EQ(make_guides(enough).size(), 1U);
  EXPECT_EQ(make_guides(enough)[0].rows[0].best->culler, "frustum.a");
}

TEST(Guide, MethodsThatPaintAnImageOfTheirOwnAreNotToChooseFrom) {
  std::vector<CellSummary> cells{method("surface.zbuffer", 1.0, 1.0), method("depth.a", 2.0, 2.0),
                                 method("depth.b", 3.0, 3.0), method("depth.c", 4.0, 4.0)};
  cells[0].paints = true;
  const std::vector<BlockSummary> blocks{block_with("s", cells)};
  const auto guides = make_guides(blocks);
  ASSERT_EQ(guides.size(), 1U);
  EXPECT_EQ(guides[0].rows[0].best->culler, "depth.a");
  EXPECT_EQ(guides[0].advice[0].eligible, 3U);
}

TEST(Guide, AdviceIsTheLeastMeanRatioAndTellsMovingScenesApart) {
  // a is best where things stand still, b where they move; c is never far off.
  const auto still =
      block_with("still", {method("frustum.a", 9.0, 1.0), method("frustum.b", 999.0, 1.0),
                           method("frustum.c", 19.0, 1.0)});
  auto moving =
      block_with("moving", {method("frustum.a", 999.0, 1.0), method("frustum.b", 9.0, 1.0),
                            method("frustum.c", 19.0, 1.0)});
  moving.moving_objects = 50.0;
  const std::vector<BlockSummary> blocks{undrawn(still), undrawn(moving)};
  const auto guides = make_guides(blocks);
  ASSERT_EQ(guides.at(0).advice.size(), 3U);
  EXPECT_EQ(guides[0].advice[0].choice.culler, "frustum.c");
  EXPECT_EQ(guides[0].advice[0].choice.wins, 0);
  EXPECT_NEAR(guides[0].advice[0].choice.mean_ratio, 2.0, 1e-12);
  EXPECT_EQ(guides[0].advice[1].choice.culler, "frustum.a");
  EXPECT_EQ(guides[0].advice[2].choice.culler, "frustum.b");
}

TEST(Guide, NothingMeasuredGivesNoGuide) {
  const std::vector<BlockSummary> none;
  EXPECT_TRUE(make_guides(none).empty());
}

TEST(Guide, SaysNothingOfScenesInWhichNothingIsLeftOut) {
  std::vector<CellSummary> cells{method("a.a", 9.0, 5.0), method("a.b", 9.0, 4.0),
                                 method("a.c", 9.0, 3.0), method("none", 0.0, 10.0)};
  cells.back().anchor = true;
  for (CellSummary& cell : cells) cell.submitted_triangles = 100.0;
  std::vector<BlockSummary> blocks{block_with("s", cells)};
  EXPECT_TRUE(make_guides(blocks).empty());
  blocks[0].cells[0].submitted_triangles = 99.0;
  EXPECT_EQ(make_guides(blocks).size(), 1U);
}

TEST(PublishedRow, OwnRatiosAreThoseOfTheRowsSceneAndMethods) {
  const std::vector<BlockSummary> blocks{
      block_with("s", {method("frustum.a", 9.0, 5.0), method("frustum.b", 9.0, 2.0)})};
  std::vector<BlockSummary> with_none = blocks;
  CellSummary none = method("none", 1.0, 10.0);
  none.against_none = {1.0, 1.0, 1.0};
  with_none[0].cells.push_back(none);
  PublishedRow row{"w", "t", 10.0, 20.0, "s", "way", "frustum.a", "none"};
  EXPECT_DOUBLE_EQ(row.ratio(), 2.0);
  EXPECT_DOUBLE_EQ(own_figure(row, with_none).ratio.value, 2.0);
  EXPECT_LT(own_figure(row, with_none).ratio.low, 2.0);
  row.against = "frustum.b";
  const OwnFigure against = own_figure(row, with_none);
  EXPECT_DOUBLE_EQ(against.ratio.value, 0.4);
  EXPECT_LT(against.ratio.low, 0.4);
  EXPECT_GT(against.ratio.high, 0.4);
  row.path = "";
  EXPECT_NE(own_figure(row, with_none).cell, nullptr) << "any path";
  row.metric = PublishedRow::Metric::cull_us;
  row.culler = "frustum.b";
  row.against = "none";
  EXPECT_NEAR(own_figure(row, with_none).ratio.value, 1.0 / 9.0, 1e-12);
  row.path = "another way";
  EXPECT_EQ(own_figure(row, with_none).cell, nullptr);
}

TEST(PublishedRow, SharesAreOfAllTrianglesAndOfTheFrame) {
  CellSummary a = method("backface.a", 399.0, 5.0);
  a.submitted_triangles = 60.0;
  CellSummary none = method("none", 0.0, 10.0);
  none.submitted_triangles = 100.0;
  none.against_none = {1.0, 1.0, 1.0};
  const std::vector<BlockSummary> blocks{block_with("s", {none, a})};
  PublishedRow row{"w", "t", 0.0, 0.0, "s", "way", "backface.a", "none"};
  row.compares = false;
  row.metric = PublishedRow::Metric::culled;
  EXPECT_DOUBLE_EQ(own_figure(row, blocks).ratio.value, 0.4);
  row.metric = PublishedRow::Metric::decision_share;
  EXPECT_DOUBLE_EQ(own_figure(row, blocks).ratio.value, 0.08);
  row.cannot_be_told = "the model is not to be had";
  row.scene.clear();
  EXPECT_EQ(own_figure(row, blocks).cell, nullptr);
}

TEST(PublishedRow, TheBlockWithTheMostFramesStandsForARowInAnyOrder) {
  BlockSummary brief = block_with("s", {method("frustum.a", 9.0, 5.0), method("none", 1.0, 10.0)});
  brief.frames = 12;
  BlockSummary full = brief;
  full.frames = 24;
  full.cells[0].against_none = {0.25, 0.2, 0.3};
  const PublishedRow row{"w", "t", 10.0, 20.0, "s", "way", "frustum.a", "none"};
  EXPECT_EQ(own_figure(row, {brief, full}).block->frames, 24);
  EXPECT_DOUBLE_EQ(own_figure(row, {full, brief}).ratio.value, 4.0);
}

}  // namespace
}  // namespace vislab
