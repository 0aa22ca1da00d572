#include "experiments/analysis/errata.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "algorithms/all_cullers.h"
#include "experiments/matrix/matrix.h"
#include "tests/input_error.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

constexpr const char* one_erratum = R"([[erratum]]
id = "X1"
source = "Somebody 2016"
place = "figure 1"
printed = "this"
right = "that"
)";

class Errata : public testing::Test {
 protected:
  Errata() { register_all_cullers(registry_); }

  std::vector<Erratum> load(const std::string& text) {
    const std::filesystem::path file = folder_.path() / "errata.toml";
    std::ofstream(file) << text;
    return load_errata(file, registry_);
  }

  std::string message(const std::string& text) {
    return input_error([&] { load(text); });
  }

  CellSummary cell(const std::string& chain, std::uint64_t false_px, double over) {
    CellSummary cell;
    cell.culler = registry_.short_name(chain);
    cell.canonical = registry_.canonical(chain);
    cell.guarantee = registry_.make(chain)->info().guarantee;
    cell.judged = true;
    cell.pixels = 1000;
    cell.false_px = false_px;
    cell.over = over;
    cell.against_none = {0.5, 0.4, 0.6};
    return cell;
  }

  static const WrongVariant& variant(const std::vector<WrongVariant>& variants,
                                     const std::string& name) {
    const auto found = std::ranges::find(variants, name, &WrongVariant::name);
    EXPECT_NE(found, variants.end()) << name;
    return *found;
  }

  Registry registry_;
  TemporaryFolder folder_;
};

TEST_F(Errata, TheLabsOwnFileNamesSourceAndPlaceOfEach) {
  const auto errata = load_errata(
      std::filesystem::path(VISLAB_SOURCE_DIR) / "experiments/errata/errata.toml", registry_);
  EXPECT_GE(errata.size(), 24U);
  EXPECT_EQ(errata[0].wrong, std::vector<std::string>{"frustum.wrong[error=degrees]"});
  EXPECT_TRUE(errata[0].reprint);
}

TEST_F(Errata, EitherAVariantShowsItOrThereIsAReason) {
  EXPECT_NE(message(one_erratum).find("either wrong"), std::string::npos);
  const auto shown = load(std::string(one_erratum) + "wrong = [\"portal.adjacency\"]\n");
  EXPECT_EQ(shown[0].wrong, std::vector<std::string>{"portal.adjacency"});
  const auto not_shown = load(std::string(one_erratum) + "not_shown = \"only words\"\n");
  EXPECT_EQ(not_shown[0].not_shown, "only words");
}

TEST_F(Errata, UnknownMethodsAndDoubleNumbersAreNamedWithTheirLine) {
  EXPECT_NE(message(std::string(one_erratum) + "wrong = [\"frustum.nothing\"]\n").find(":7"),
            std::string::npos);
  const std::string one = std::string(one_erratum) + "not_shown = \"x\"\n";
  EXPECT_NE(message(one + one).find("two errata 'X1'"), std::string::npos);
}

TEST_F(Errata, EveryErroneousCullerStandsThereMeasuredOrNot) {
  const auto variants = find_wrong_variants({}, {}, registry_);
  std::set<std::string> names;
  for (const WrongVariant& one : variants) {
    names.insert(one.name);
    EXPECT_EQ(one.judged, 0U);
    EXPECT_EQ(one.pixels.wrong, nullptr);
  }
  EXPECT_TRUE(names.contains("frustum.wrong[error=degrees]"));
  EXPECT_TRUE(names.contains("frustum.wrong[error=all_corners_inside]"));
  EXPECT_TRUE(names.contains("portal.adjacency"));
  EXPECT_FALSE(names.contains("frustum.flat"));
}

TEST_F(Errata, TheMatrixHasEveryWrongVariant) {
  const Matrix matrix = load_matrix(
      "errata", std::filesystem::path(VISLAB_SOURCE_DIR) / "experiments/matrices", registry_);
  std::set<std::string> chains;
  for (const Block& block : matrix.blocks) {
    for (const BlockCuller& culler : block.cullers) chains.insert(culler.chain);
  }
  for (const WrongVariant& one : find_wrong_variants({}, {}, registry_)) {
    const std::string begin = one.name.substr(0, one.name.find('['));
    const std::string mistake =
        one.name == begin ? ""
                          : one.name.substr(begin.size() + 1, one.name.size() - begin.size() - 2);
    EXPECT_TRUE(std::ranges::any_of(chains,
                                    [&](const std::string& chain) {
                                      return chain.find(begin) != std::string::npos &&
                                             chain.find(mistake) != std::string::npos;
                                    }))
        << one.name << " is not in matrix errata";
  }
}

TEST_F(Errata, TheWorstRunStandsForAVariantBesideTheTightestRightMethodOfItsFamily) {
  BlockSummary mild;
  mild.scene = "mild";
  mild.cells = {cell("frustum.wrong[error=degrees]", 10, 3.0), cell("frustum.flat", 0, 2.0),
                cell("frustum.bvh", 0, 1.0), cell("backface.polygon", 0, 0.5)};
  BlockSummary bad = mild;
  bad.scene = "bad";
  bad.cells[0].false_px = 400;
  bad.cells[0].over = 1.5;
  const auto variants = find_wrong_variants({&mild, &bad}, {}, registry_);
  const WrongVariant& degrees = variant(variants, "frustum.wrong[error=degrees]");
  EXPECT_EQ(degrees.judged, 2U);
  EXPECT_EQ(degrees.pixels.block, &bad);
  EXPECT_EQ(degrees.pixels.right->culler, "frustum.bvh");
  EXPECT_EQ(degrees.over.block, &mild);
}

TEST_F(Errata, TheNamedRightMethodStandsInTheSamePlaceOfTheChainWithTheSameParameters) {
  const auto errata = load(std::string(one_erratum) +
                           "wrong = [\"detail.wrong[error=printed_formula]\"]\n"
                           "against = \"detail.screen_size\"\n");
  BlockSummary block;
  block.cells = {
      cell("frustum.flat > detail.wrong[error=printed_formula,threshold_px=16]", 300, 1.0),
      cell("detail.screen_size[threshold_px=16]", 1, 1.0),
      cell("frustum.flat > detail.screen_size[threshold_px=4]", 2, 1.0),
      cell("frustum.flat > detail.screen_size[threshold_px=16]", 3, 1.0)};
  const auto variants = find_wrong_variants({&block}, errata, registry_);
  const WrongVariant& printed = variant(variants, "detail.wrong[error=printed_formula]");
  ASSERT_NE(printed.pixels.right, nullptr);
  EXPECT_EQ(printed.pixels.right->false_px, 3U);
  ASSERT_EQ(printed.errata.size(), 1U);
  EXPECT_EQ(printed.errata[0]->id, "X1");
}

TEST_F(Errata, AVariantThatIsOnlyApproximateIsFoundIfAnErratumNamesIt) {
  const auto errata = load(std::string(one_erratum) +
                           "wrong = [\"surface.span_buffer[compare_at=left_end]\"]\n"
                           "against = \"surface.span_buffer\"\n");
  BlockSummary block;
  block.cells = {cell("surface.span_buffer[compare_at=left_end]", 7, 1.0),
                 cell("surface.span_buffer", 2, 1.0)};
  const auto variants = find_wrong_variants({&block}, errata, registry_);
  const WrongVariant& left = variant(variants, "surface.span_buffer[compare_at=left_end]");
  EXPECT_EQ(left.judged, 1U);
  EXPECT_EQ(left.pixels.right->false_px, 2U);
}

TEST_F(Errata, ACounterShowsWhatNeitherPixelsNorTrianglesDo) {
  const auto errata = load(std::string(one_erratum) +
                           "wrong = [\"backface.wrong[error=printed_cost_sign]\"]\n"
                           "against = \"backface.cluster\"\ncounter = \"cluster_tests\"\n");
  BlockSummary block;
  block.cells = {cell("backface.wrong[error=printed_cost_sign]", 0, 1.0),
                 cell("backface.cluster", 0, 1.0)};
  block.cells[0].counters["cluster_tests"] = 90.0;
  block.cells[1].counters["cluster_tests"] = 30.0;
  const auto variants = find_wrong_variants({&block}, errata, registry_);
  const Damage& work = variant(variants, "backface.wrong[error=printed_cost_sign]").work;
  ASSERT_NE(work.wrong, nullptr);
  EXPECT_EQ(counter_a_frame(*work.wrong, "cluster_tests"), 90.0);
}

TEST_F(Errata, WhyAVariantWasNotJudgedIsKept) {
  BlockSummary block;
  block.cells = {cell("frustum.wrong[error=degrees]", 0, 1.0)};
  block.cells[0].judged = false;
  block.cells[0].reason = "timed out after 300 s";
  const auto variants = find_wrong_variants({&block}, {}, registry_);
  EXPECT_EQ(variant(variants, "frustum.wrong[error=degrees]").reason, "timed out after 300 s");
}

TEST_F(Errata, TablesAreSetRightByTheRatioOfBothFrusta) {
  const auto errata = load(std::string(one_erratum) +
                           "wrong = [\"frustum.wrong[error=degrees]\"]\n"
                           "against = \"frustum.flat\"\nreprint = true\n");
  PublishedRow row;
  row.what = "hares";
  row.scene = "hares";
  row.without_fps = 10.0;
  row.with_fps = 50.0;
  PublishedRow words = row;
  words.without_fps = words.with_fps = 0.0;
  const std::vector<PublishedFigures> published{{"t", "Somebody 2016, tables", "", {row, words}},
                                                {"u", "Another 2016", "", {row}}};
  BlockSummary block;
  block.scene = "hares";
  block.cells = {cell("none", 0, 1.0), cell("frustum.wrong[error=degrees]", 0, 1.0),
                 cell("frustum.flat", 0, 1.0)};
  block.cells[1].against_none = {0.3, 0.28, 0.32};
  block.cells[2].against_none = {0.2, 0.18, 0.22};
  const auto reprints = reprints_of(errata[0], published, {&block}, registry_);
  ASSERT_EQ(reprints.size(), 1U);
  EXPECT_NEAR(reprints[0].gain.value, 1.5, 1e-12);
  EXPECT_NEAR(reprints[0].gain.low, 0.28 / 0.22, 1e-12);
  EXPECT_NEAR(reprints[0].gain.high, 0.32 / 0.18, 1e-12);
  EXPECT_EQ(reprints_of(errata[0], published, {}, registry_)[0].block, nullptr);
}

}  // namespace
}  // namespace vislab
