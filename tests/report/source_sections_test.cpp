#include <gtest/gtest.h>

#include "algorithms/all_cullers.h"
#include "common/scene/error.h"
#include "report/chains_section.h"
#include "report/claims_section.h"
#include "report/errata_section.h"
#include "report/main_chart.h"
#include "report/summary_section.h"
#include "report/template.h"
#include "tests/report/fabricated.h"

namespace vislab {
namespace {

constexpr const char* degrees = "frustum.wrong[error=degrees]";

CellSummary registered_cell(const Registry& registry, const std::string& chain, double ratio,
                            std::uint64_t false_px, double over) {
  CellSummary cell = fabricated_cell(registry.short_name(chain), ratio, false_px, over);
  cell.canonical = registry.canonical(chain);
  cell.guarantee = registry.make(chain)->info().guarantee;
  return cell;
}

class SourceSections : public testing::Test {
 protected:
  SourceSections() {
    register_all_cullers(registry_);
    input_.cullers = &registry_;
    Erratum shown;
    shown.id = "X1";
    shown.source = "Somebody 2016";
    shown.wrong = {degrees};
    shown.against = "frustum.flat";
    shown.sweep = "made_up_sweep";
    shown.reprint = true;
    Erratum words;
    words.id = "X2";
    words.source = "Somebody 2016";
    words.not_shown = "only words";
    input_.errata = {shown, words};
    BlockSummary block = fabricated_block("plain");
    block.cells.push_back(registered_cell(registry_, "frustum.flat", 0.25, 0, 1.0));
    block.cells.push_back(registered_cell(registry_, degrees, 0.5, 1000, 6.5));
    block.cells.back().worst_frame = 7;
    block.cells.back().worst_frame_px = 600;
    input_.blocks.push_back(std::move(block));
    PublishedRow row;
    row.what = "a scene";
    row.table = "5.2";
    row.without_fps = 50.0;
    row.with_fps = 60.0;
    row.scene = "plain";
    row.culler = registry_.canonical("frustum.flat");
    row.against = "none";
    row.short_culler = "frustum.flat";
    row.short_against = "none";
    row.accept = {3.0, 5.0};
    PublishedRow untold;
    untold.what = "another";
    untold.published = "7 %";
    untold.cannot_be_told = "the model is not to be had";
    input_.published = {{"Tables", "Somebody 2016, tables", "odd", {row, untold}}};
  }

  Registry registry_;
  ReportInput input_;
};

TEST_F(SourceSections, AWrongVariantStandsBesideARightOneWithItsWorstFrame) {
  Fields fields;
  add_errata_fields(input_, "", fields);
  EXPECT_EQ(fields.lists["has_errata"].size(), 1U);
  EXPECT_EQ(fields.values["wrong_measured"], "1");
  for (const Fields& family : fields.lists["wrong_families"]) {
    for (const Fields& row : family.lists.at("rows")) {
      if (row.values.at("method") != "`" + std::string(degrees) + "`") continue;
      EXPECT_EQ(row.values.at("ids"), "X1");
      EXPECT_NE(row.values.at("false_px").find("1,000 of 15,728,640"), std::string::npos);
      EXPECT_EQ(row.values.at("frame"), "7: 600 pixels");
      EXPECT_EQ(row.values.at("right"), "`frustum.flat`: 0");
      EXPECT_NE(row.values.at("over").find("6.50 against 1.00, on plain"), std::string::npos);
      return;
    }
  }
  FAIL() << "the variant is not there";
}

TEST_F(SourceSections, WhatWasNotRunIsAGapWithItsReason) {
  Fields fields;
  add_errata_fields(input_, "", fields);
  ASSERT_EQ(fields.lists["errata"].size(), 1U);
  EXPECT_NE(fields.lists["errata"][0].values.at("measured").find("made_up_sweep`: not run"),
            std::string::npos);
  std::size_t gaps = 0;
  for (const Fields& family : fields.lists["wrong_families"]) {
    for (const Fields& row : family.lists.at("rows")) {
      gaps += row.values.at("false_px") == "not run" ? 1 : 0;
    }
  }
  EXPECT_GT(gaps, 20U);
  ASSERT_EQ(fields.lists["figure_errata"].size(), 1U);
  EXPECT_EQ(fields.lists["figure_errata"][0].values.at("not_shown"), "only words");
}

TEST_F(SourceSections, TablesAreReprintedWithTheRightMethod) {
  Fields fields;
  add_errata_fields(input_, "", fields);
  ASSERT_EQ(fields.lists["reprints"].size(), 1U);
  const auto& rows = fields.lists["reprints"][0].lists.at("rows");
  ASSERT_EQ(rows.size(), 1U);
  // Twice as fast with the right frustum: 0.5 against 0.25 of none's time.
  EXPECT_TRUE(rows[0].values.at("would_be").starts_with("120")) << rows[0].values.at("would_be");
  input_.blocks[0].cells.pop_back();
  BlockSummary other = fabricated_block("other");
  other.cells.push_back(registered_cell(registry_, degrees, 0.5, 1000, 6.5));
  input_.blocks.push_back(other);
  Fields gap;
  add_errata_fields(input_, "", gap);
  EXPECT_EQ(gap.lists["reprints"][0].lists.at("rows")[0].values.at("would_be"), "not run");
}

TEST_F(SourceSections, APictureThatCannotBeMadeIsAGapWithItsReason) {
  input_.picture = [](const BlockSummary&, const CellSummary&,
                      const std::filesystem::path&) -> std::string {
    throw InputError("the scene is gone");
  };
  Fields fields;
  add_errata_fields(input_, "", fields);
  ASSERT_EQ(fields.lists["errata_pictures_missing"].size(), 1U);
  EXPECT_EQ(fields.lists["errata_pictures_missing"][0].values.at("reason"), "the scene is gone");
}

TEST_F(SourceSections, WithoutAMeasuredVariantTheErrataStandThereAsNotRun) {
  input_.blocks[0].cells.pop_back();
  Fields fields;
  add_errata_fields(input_, "", fields);
  EXPECT_EQ(fields.lists["has_errata"].size(), 1U);
  EXPECT_EQ(fields.values["wrong_measured"], "0");
  EXPECT_EQ(fields.lists["figure_errata"].size(), 1U);
  ASSERT_EQ(fields.lists["errata"].size(), 1U);
  EXPECT_NE(fields.lists["errata"][0].values.at("measured").find("not run"), std::string::npos);
  ASSERT_FALSE(fields.lists["wrong_families"].empty());
  for (const Fields& family : fields.lists["wrong_families"]) {
    for (const Fields& row : family.lists.at("rows")) {
      EXPECT_EQ(row.values.at("false_px"), "not run");
    }
  }
  const std::string text = fill_template(read_template(std::filesystem::path(VISLAB_SOURCE_DIR) /
                                                       "report" / "templates" / "errata.md"),
                                         fields, "errata.md");
  EXPECT_NE(text.find("vislab run errata"), std::string::npos);
  EXPECT_NE(text.find("only in words"), std::string::npos);
}

TEST_F(SourceSections, RowsThatMakeTheSameClaimOfSeveralScenesSayOnceWhatTheyShare) {
  auto& claims = input_.published[0].rows;
  claims.insert(claims.begin() + 1, claims[0]);
  claims[1].what = "the same: another scene";
  claims.insert(claims.begin() + 2, claims[0]);
  claims[2].accept = {2.0, 5.0};
  Fields fields;
  add_claim_fields(input_, fields);
  const auto& rows = fields.lists["claim_sources"][0].lists.at("rows");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].values.at("method").find("`frustum.flat`"), 0U);
  EXPECT_EQ(rows[1].values.at("method"), "″");
  EXPECT_EQ(rows[1].values.at("published"), "″");
  EXPECT_EQ(rows[1].values.at("verdict"), "**confirmed**");
  EXPECT_EQ(rows[2].values.at("method").find("`frustum.flat`"), 0U);
}

TEST_F(SourceSections, FiguresWithoutAVerdictStandBesideOursIfThereAreAny) {
  input_.published[0].rows[0].cannot_be_told = "held near 64";
  Fields fields;
  add_claim_fields(input_, fields);
  const Fields& row = fields.lists["claim_sources"][0].lists.at("rows").at(0);
  EXPECT_EQ(row.values.at("verdict"), "cannot be told");
  EXPECT_EQ(row.values.at("accept"), "–");
  EXPECT_TRUE(row.values.at("own").starts_with("4.0")) << row.values.at("own");
  EXPECT_NE(row.values.at("scene").find("held near 64"), std::string::npos);
  input_.blocks.clear();
  Fields gone;
  add_claim_fields(input_, gone);
  EXPECT_EQ(gone.lists["untold_claims"].size(), 2U);
  EXPECT_TRUE(gone.lists["measured_sources"].empty());
}

TEST_F(SourceSections, AClaimThatNoiseDecidesSaysSo) {
  input_.published[0].rows[0].accept = {3.95, 5.0};
  input_.blocks[0].noise = {1.0, 0.9, 1.1};
  for (CellSummary& cell : input_.blocks[0].cells) cell.against_none = {0.25, 0.25, 0.25};
  const auto scene = [&]() {
    Fields fields;
    add_claim_fields(input_, fields);
    const Fields& row = fields.lists["claim_sources"][0].lists.at("rows").at(0);
    EXPECT_EQ(row.values.at("verdict"), "cannot be told");
    return row.values.at("scene");
  };
  EXPECT_NE(scene().find("None against itself gives 1"), std::string::npos) << scene();
  input_.blocks[0].noise = Estimate::none();
  EXPECT_NE(scene().find("no control"), std::string::npos) << scene();
}

TEST_F(SourceSections, EachClaimHasItsVerdictWithTheFigures) {
  Fields fields;
  add_claim_fields(input_, fields);
  ASSERT_EQ(fields.lists["claim_sources"].size(), 1U);
  const auto& rows = fields.lists["claim_sources"][0].lists.at("rows");
  EXPECT_EQ(rows[0].values.at("verdict"), "**confirmed**");
  EXPECT_EQ(rows[0].values.at("accept"), "3.00 to 5.00");
  EXPECT_TRUE(rows[0].values.at("own").starts_with("4.0")) << rows[0].values.at("own");
  const auto& untold = fields.lists["untold_claims"];
  ASSERT_EQ(untold.size(), 1U);
  EXPECT_EQ(untold[0].values.at("reason"), "the model is not to be had");
  EXPECT_EQ(fields.values["claims_confirmed"], "1");
  EXPECT_EQ(fields.values["claims_cannot_be_told"], "1");
}

TEST_F(SourceSections, AClaimWithoutCellsIsAGapWhereMostWereRunAndElseOneOfANumber) {
  input_.published.push_back(input_.published[0]);
  input_.published[1].rows[0].scene = "elsewhere";
  input_.published[0].rows.push_back(input_.published[1].rows[0]);
  Fields fields;
  add_claim_fields(input_, fields);
  auto& sources = fields.lists["claim_sources"];
  ASSERT_EQ(sources.size(), 2U);
  ASSERT_EQ(sources[0].lists.at("rows").size(), 2U);
  EXPECT_EQ(sources[0].lists.at("rows")[1].values.at("verdict"), "not run");
  EXPECT_TRUE(sources[0].lists.at("is_folded").empty());
  EXPECT_TRUE(sources[1].lists.at("rows").empty());
  EXPECT_EQ(sources[1].lists.at("is_folded").size(), 1U);
  EXPECT_EQ(sources[1].values.at("not_run"), "1");
  EXPECT_EQ(fields.lists["measured_sources"].size(), 1U);
  EXPECT_EQ(fields.lists["untold_claims"].size(), 2U);  // stand there whatever was run
}

TEST_F(SourceSections, RunsOfOneSceneShareARowThatCountsWhereTheAnswerIsTheSame) {
  input_.blocks.push_back(input_.blocks[0]);
  input_.blocks.back().path = "with another best";
  for (CellSummary& cell : input_.blocks.back().cells) {
    if (!cell.anchor) cell.canonical = registry_.canonical("frustum.octree");
  }
  input_.blocks.push_back(input_.blocks[0]);
  input_.blocks.back().path = "the longest";
  input_.blocks.back().frames += 1;
  Fields fields;
  add_chain_fields(input_, fields);
  ASSERT_EQ(fields.lists["choices"].size(), 1U);
  EXPECT_EQ(fields.lists["choices"][0].values.at("scene"),
            "plain\\, the longest (1 of 2 other runs alike)");
  EXPECT_EQ(fields.lists["has_other_choices"].size(), 1U);
  ASSERT_EQ(fields.lists["family_choices"].size(), 1U);
  EXPECT_EQ(fields.lists["family_choices"][0].values.at("scene"), "plain\\, the longest");
}

TEST_F(SourceSections, TheChainToUseIsNamedWithWhatItSaves) {
  Fields fields;
  add_chain_fields(input_, fields);
  ASSERT_EQ(fields.lists["choices"].size(), 1U);
  const Fields& row = fields.lists["choices"][0];
  EXPECT_EQ(row.values.at("best"), "`frustum.flat`");
  EXPECT_EQ(row.values.at("undecided"), "decided");
  EXPECT_EQ(row.values.at("worth").find("saves 74"), 0U) << row.values.at("worth");
  ASSERT_EQ(fields.lists["chosen_families"].size(), 1U);
  EXPECT_EQ(fields.lists["chosen_families"][0].values.at("wins"), "1");
}

TEST_F(SourceSections, WhereOneFamilyWasRunThereIsNothingToChoose) {
  BlockSummary both = fabricated_block("both");
  both.cells.push_back(registered_cell(registry_, "frustum.flat", 0.25, 0, 1.0));
  both.cells.push_back(registered_cell(registry_, "depth.hzb", 0.2, 0, 0.5));
  input_.blocks.push_back(both);
  Fields fields;
  add_chain_fields(input_, fields);
  ASSERT_EQ(fields.lists["choices"].size(), 1U);
  EXPECT_EQ(fields.lists["choices"][0].values.at("best"), "`depth.hzb`");
  EXPECT_EQ(fields.values["one_family"], "1");
  EXPECT_EQ(fields.lists["has_one_family"].size(), 1U);
}

TEST_F(SourceSections, TheSheetInFrontNamesBestChainPromisesErrataAndFloor) {
  Fields fields;
  add_claim_fields(input_, fields);
  add_summary_fields(input_, fields);
  ASSERT_EQ(fields.lists["best_chains"].size(), 1U);
  EXPECT_EQ(fields.lists["best_chains"][0].values.at("best"), "`frustum.flat`");
  EXPECT_TRUE(fields.lists["has_broken_promises"].empty());
  EXPECT_EQ(fields.values["worst_wrong"], "`" + std::string(degrees) + "`");
  EXPECT_EQ(fields.values["error_floor"], "1,234 of 15,728,640");
  EXPECT_EQ(fields.lists["has_main_chart"].size(), 1U);
  EXPECT_NE(main_chart_script(input_.blocks, "a.svg").find("wrong on purpose"), std::string::npos);
}

TEST_F(SourceSections, ABrokenPromiseStandsOnTheSheet) {
  input_.blocks[0].cells.push_back(registered_cell(registry_, "frustum.bvh", 0.3, 5, 1.0));
  Fields fields;
  add_summary_fields(input_, fields);
  EXPECT_EQ(fields.values["broken_promises"], "`frustum.bvh`");
  ASSERT_EQ(fields.lists["failures"].size(), 1U);
  EXPECT_EQ(fields.lists["failures"][0].values.at("method"), "`frustum.bvh`");
}

TEST_F(SourceSections, APromiseOfTheImageIsHeldToTheImage) {
  CellSummary cell = registered_cell(registry_, "depth.hzb", 0.3, 5, 1.0);
  ASSERT_EQ(cell.guarantee, Guarantee::image_exact);
  cell.drawn = true;
  cell.image_px = 0;
  EXPECT_FALSE(breaks_its_promise(cell)) << "rays differ, the device's image does not";
  cell.image_px = 1;
  EXPECT_TRUE(breaks_its_promise(cell));
  cell.drawn = false;
  EXPECT_TRUE(breaks_its_promise(cell)) << "without an image rays decide";
}

TEST_F(SourceSections, ManyScenesAreCutToThoseWithMostTrianglesAndSaidSo) {
  for (int i = 0; i < 12; ++i) {
    BlockSummary block = input_.blocks[0];
    block.scene = "scene " + std::to_string(i);
    block.triangles = 1000 * static_cast<std::uint64_t>(i);
    input_.blocks.push_back(std::move(block));
  }
  Fields fields;
  add_summary_fields(input_, fields);
  EXPECT_EQ(fields.lists["best_chains"].size() + std::stoul(fields.values["more_scenes"]), 13U);
  EXPECT_EQ(fields.lists["best_chains"][0].values.at("scene"), "plain");
  EXPECT_EQ(fields.lists["has_more_scenes"].size(), 1U);
}

TEST_F(SourceSections, WithoutAnythingTheSheetIsStillFilled) {
  const ReportInput nothing;
  Fields fields;
  add_claim_fields(nothing, fields);
  add_summary_fields(nothing, fields);
  add_chain_fields(nothing, fields);
  add_errata_fields(nothing, "", fields);
  EXPECT_TRUE(fields.lists["has_best_chains"].empty());
  EXPECT_TRUE(fields.lists["has_main_chart"].empty());
}

}  // namespace
}  // namespace vislab
