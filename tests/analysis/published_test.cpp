// Figures of the sources beside ours, and what the two say of a claim.
#include "experiments/analysis/published.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <set>

#include "algorithms/all_cullers.h"
#include "experiments/analysis/knees_file.h"
#include "experiments/matrix/matrix.h"
#include "tests/input_error.h"
#include "tests/report/fabricated.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

class Published : public ::testing::Test {
 protected:
  Published() { register_all_cullers(registry_); }

  std::vector<PublishedRow> rows(const std::string& text) {
    folder_.write("figures.toml", "title = \"t\"\nsource = \"s\"\n" + text);
    return load_published(folder_.path(), registry_).at(0).rows;
  }
  std::string refusal(const std::string& text) {
    return input_error([&] { rows(text); });
  }
  /// A block on scene "city" with none and one cell of frustum.flat, as long as half of none.
  BlockSummary block() const {
    BlockSummary block = fabricated_block("city");
    CellSummary cell = fabricated_cell("frustum.flat", 0.5, 0, 1.0);
    cell.canonical = registry_.canonical("frustum.flat");
    cell.counters["queries"] = 30.0;
    block.cells.push_back(cell);
    cell.canonical = registry_.canonical("frustum.bvh");
    cell.counters["queries"] = 40.0;
    cell.against_none = {0.25, 0.2, 0.4};
    block.cells.push_back(cell);
    return block;
  }

  Registry registry_;
  TemporaryFolder folder_;
};

const std::string place_keys = "scene = \"city\"\nculler = \"frustum.flat\"\n";
const std::string claim = "[[row]]\nwhat = \"w\"\ntable = \"1\"\npublished = \"p\"\n";

TEST_F(Published, AClaimIsConfirmedWhereTheWholeIntervalIsAcceptable) {
  const auto verdict = [&](const std::string& accept, Estimate figure) {
    const PublishedRow row = rows(claim + "accept = " + accept + "\n" + place_keys).at(0);
    BlockSummary block = this->block();
    block.noise = {1.0, 1.0, 1.0};
    OwnFigure own{&block, &block.cells.back()};
    own.ratio = figure;
    return verdict_of(row, own);
  };
  EXPECT_EQ(verdict("[1.0, 3.0]", {2.0, 1.0, 3.0}), ClaimVerdict::confirmed);
  EXPECT_EQ(verdict("[1.0, inf]", {50.0, 40.0, 60.0}), ClaimVerdict::confirmed);
  EXPECT_EQ(verdict("[1.0, 3.0]", {0.9, 0.8, 0.99}), ClaimVerdict::not_confirmed);
  EXPECT_EQ(verdict("[1.0, 3.0]", {4.0, 3.1, 5.0}), ClaimVerdict::not_confirmed);
  EXPECT_EQ(verdict("[1.0, 3.0]", {1.2, 0.9, 1.4}), ClaimVerdict::cannot_be_told);
  EXPECT_EQ(verdict("[1.0, 3.0]", {2.0, 0.5, 4.0}), ClaimVerdict::cannot_be_told);
  EXPECT_EQ(verdict("[0, 0]", {0.0, 0.0, 0.0}), ClaimVerdict::confirmed);
  EXPECT_EQ(verdict("[1.0, 3.0]", Estimate::none()), ClaimVerdict::cannot_be_told);
}

TEST_F(Published, NoClaimOfTimesIsConfirmedByLessThanNoneAgainstItself) {
  BlockSummary block = this->block();
  const auto verdict = [&](const std::string& keys, Estimate figure) {
    const PublishedRow row = rows(claim + keys + place_keys).at(0);
    OwnFigure own{&block, &block.cells.back()};
    own.ratio = figure;
    const bool is_hidden = noise_decides(row, own);
    return std::pair(verdict_of(row, own), is_hidden);
  };
  const std::string faster = "accept = [1.0, inf]\n";
  const auto confirmed = std::pair(ClaimVerdict::confirmed, false);
  const auto hidden = std::pair(ClaimVerdict::cannot_be_told, true);
  block.noise = {1.0, 0.95, 1.05};
  EXPECT_EQ(verdict(faster, {1.02, 1.001, 1.04}), hidden);
  EXPECT_EQ(verdict(faster, {1.1, 1.06, 1.14}), confirmed);
  EXPECT_EQ(verdict(faster, {0.98, 0.96, 0.999}), hidden);
  EXPECT_EQ(verdict(faster + "metric = \"cull_us\"\n", {1.02, 1.001, 1.04}), hidden);
  EXPECT_EQ(verdict(faster + "metric = \"build_ms\"\n", {1.02, 1.02, 1.02}), hidden);
  EXPECT_EQ(verdict(faster + "metric = \"queries\"\n", {1.02, 1.02, 1.02}), confirmed);
  block.noise = {1.04, 1.02, 1.05};  // the second none was slower for sure: 1 is noise, too
  EXPECT_EQ(verdict(faster, {1.02, 1.001, 1.04}), confirmed);
  block.noise = Estimate::none();
  EXPECT_EQ(verdict(faster, {3.0, 2.9, 3.1}), hidden) << "without a control";
  EXPECT_EQ(verdict(faster + "metric = \"queries\"\n", {3.0, 3.0, 3.0}), confirmed);
  block.device_models.resize(1);  // its clock repeats
  EXPECT_EQ(verdict(faster, {3.0, 3.0, 3.0}), confirmed);
}

TEST_F(Published, FramesASecondMayStandBesideOursWithoutAVerdict) {
  const std::string fps = "[[row]]\nwhat = \"w\"\ntable = \"1\"\nwithout_fps = 64\nwith_fps = 64\n";
  const PublishedRow row =
      rows("tolerance = 1.5\n" + fps + "cannot_be_told = \"held\"\n" + place_keys).at(0);
  const std::vector<BlockSummary> blocks{block()};
  const OwnFigure own = own_figure(row, blocks);
  EXPECT_DOUBLE_EQ(own.ratio.value, 2.0);
  EXPECT_EQ(verdict_of(row, own), ClaimVerdict::cannot_be_told);
  EXPECT_FALSE(noise_decides(row, own));
  EXPECT_NE(refusal(claim + "cannot_be_told = \"held\"\n" + place_keys).find("has no scene"),
            std::string::npos);
}

TEST_F(Published, WhatNotEvenTheOracleReachesCannotBeTold) {
  BlockSummary block = this->block();  // ours is twice as fast as none, the oracle 11 times
  const auto verdict = [&](const std::string& accept) {
    const PublishedRow row = rows(claim + "accept = " + accept + "\n" + place_keys).at(0);
    return verdict_of(row, own_figure(row, {block}));
  };
  EXPECT_EQ(verdict("[20, 30]"), ClaimVerdict::cannot_be_told);
  EXPECT_EQ(verdict("[5, 30]"), ClaimVerdict::not_confirmed);
  EXPECT_EQ(verdict("[0, 1]"), ClaimVerdict::not_confirmed);
  EXPECT_EQ(verdict("[1, 3]"), ClaimVerdict::confirmed);
  std::erase_if(block.cells,
                [](const CellSummary& cell) { return cell.canonical.starts_with("oracle"); });
  EXPECT_EQ(verdict("[20, 30]"), ClaimVerdict::not_confirmed) << "how far is unknown";
}

TEST_F(Published, WhatWasNotRunOrCannotBeToldSaysSo) {
  const PublishedRow row = rows(claim + "accept = [1, 2]\n" + place_keys).at(0);
  EXPECT_EQ(verdict_of(row, own_figure(row, {})), ClaimVerdict::not_run);
  const PublishedRow untold = rows(claim + "cannot_be_told = \"lost\"\n").at(0);
  EXPECT_EQ(verdict_of(untold, own_figure(untold, {block()})), ClaimVerdict::cannot_be_told);
  EXPECT_EQ(to_string(ClaimVerdict::not_confirmed), "not confirmed");
}

TEST_F(Published, RowsInFramesASecondTakeTheFilesTolerance) {
  const std::string fps = "[[row]]\nwhat = \"w\"\ntable = \"1\"\nwithout_fps = 10\nwith_fps = 30\n";
  const PublishedRow row = rows("tolerance = 1.5\n" + fps + place_keys).at(0);
  EXPECT_DOUBLE_EQ(row.accept.low, 2.0);
  EXPECT_DOUBLE_EQ(row.accept.high, 4.5);
  EXPECT_EQ(rows("tolerance = 1.5\n" + fps + "accept = [1, inf]\n" + place_keys).at(0).accept.high,
            infinity);
  EXPECT_NE(refusal(fps + place_keys).find("accept"), std::string::npos);
  EXPECT_NE(refusal("tolerance = 0.5\n" + fps + place_keys).find("tolerance"), std::string::npos);
}

TEST_F(Published, TimesCompareWithNoneAndOtherMetricsWithNobody) {
  const auto figure = [&](const std::string& keys) {
    const PublishedRow row = rows(claim + "accept = [1, 2]\n" + place_keys + keys).at(0);
    return own_figure(row, {block()}).ratio;
  };
  EXPECT_DOUBLE_EQ(figure("").value, 2.0);
  // Half as fast as the other; the errors of both add up.
  const Estimate half = figure("against = \"frustum.bvh\"\n");
  EXPECT_DOUBLE_EQ(half.value, 0.5);
  EXPECT_NEAR(half.low, 0.5 * std::exp(-std::hypot(std::log(0.25 / 0.2), std::log(1.02))), 1e-12);
  EXPECT_NEAR(half.high, 0.5 * std::exp(std::hypot(std::log(0.4 / 0.25), std::log(1.0 / 0.98))),
              1e-12);
  EXPECT_DOUBLE_EQ(figure("metric = \"queries\"\n").value, 30.0);
  EXPECT_DOUBLE_EQ(figure("metric = \"queries\"\nagainst = \"frustum.bvh\"\n").value, 0.75);
  EXPECT_DOUBLE_EQ(figure("metric = \"false_px\"\n").high, 0.0);
  EXPECT_TRUE(std::isnan(figure("metric = \"no_such_counter\"\n").value));
}

TEST_F(Published, SharesAreThoseOfAllTrianglesAndMayBeCompared) {
  BlockSummary block = this->block();
  for (CellSummary& cell : block.cells) {
    cell.submitted_triangles = cell.canonical == "none" ? 100.0 : 40.0;
  }
  block.cells.back().submitted_triangles = 20.0;  // frustum.bvh
  const auto figure = [&](const std::string& keys) {
    const PublishedRow row =
        rows(claim + "accept = [0, 1]\nmetric = \"culled\"\n" + place_keys + keys).at(0);
    return std::pair(row.is_share(), own_figure(row, {block}).ratio.value);
  };
  EXPECT_EQ(figure(""), std::pair(true, 0.6));
  EXPECT_EQ(figure("against = \"frustum.bvh\"\n"), std::pair(false, 0.6 / 0.8));
}

TEST_F(Published, ModelledDevicesCountOnlyForRowsThatNameThem) {
  BlockSummary modelled = block();
  modelled.device = "modelled[preset=gpu]";
  modelled.device_models.resize(1);
  const PublishedRow anywhere = rows(claim + "accept = [1, 2]\n" + place_keys).at(0);
  const PublishedRow there =
      rows(claim + "accept = [1, 2]\ndevice = \"modelled[preset=gpu]\"\n" + place_keys).at(0);
  EXPECT_EQ(own_figure(anywhere, {modelled}).cell, nullptr);
  EXPECT_NE(own_figure(there, {modelled}).cell, nullptr);
  EXPECT_EQ(own_figure(there, {block()}).cell, nullptr);
}

TEST_F(Published, PlacesAreComparedByWhatIsDrawnThere) {
  BlockSummary far = block();
  far.scene = "village";
  BlockSummary near = block();
  for (CellSummary& cell : near.cells) cell.submitted_triangles = 30.0;
  for (CellSummary& cell : far.cells) cell.submitted_triangles = 60.0;
  const std::string other = "against = \"frustum.flat\"\nagainst_scene = \"village\"\n";
  const PublishedRow row =
      rows(claim + "accept = [0, 1]\nmetric = \"submitted_triangles\"\n" + place_keys + other)
          .at(0);
  EXPECT_TRUE(row.compares_places());
  const std::vector<BlockSummary> both{near, far};
  const OwnFigure own = own_figure(row, both);
  EXPECT_EQ(own.other, &both[1]);
  EXPECT_DOUBLE_EQ(own.ratio.value, 0.5);
  EXPECT_EQ(own_figure(row, {near}).cell, nullptr) << "the other place was not run";
  far.viewport.width *= 2;
  EXPECT_EQ(own_figure(row, {near, far}).cell, nullptr) << "images of another size";
  EXPECT_NE(refusal(claim + "accept = [0, 1]\n" + place_keys + other).find("same rounds"),
            std::string::npos);
}

TEST_F(Published, SpreadsAndSharesOfTheTimeHaveIntervals) {
  BlockSummary block = this->block();
  for (CellSummary& cell : block.cells) {
    cell.frame_ms.deviation = {2.0, 1.0, 4.0};
    cell.frame_ms.median = {10.0, 8.0, 16.0};
    cell.update_us.median = {1000.0, 800.0, 1200.0};
    cell.cull_us.median = {1000.0, 800.0, 1200.0};
  }
  const auto figure = [&](const std::string& keys) {
    return own_figure(rows(claim + "accept = [0, 1]\n" + place_keys + keys).at(0), {block}).ratio;
  };
  const Estimate spread = figure("metric = \"frame_ms_deviation\"\nagainst = \"frustum.bvh\"\n");
  EXPECT_DOUBLE_EQ(spread.value, 1.0);
  EXPECT_NEAR(spread.high, std::exp(std::hypot(std::log(2.0), std::log(2.0))), 1e-12);
  const Estimate share = figure("metric = \"decision_share\"\n");
  EXPECT_DOUBLE_EQ(share.value, 0.2);
  EXPECT_DOUBLE_EQ(share.low, 0.1);
  EXPECT_DOUBLE_EQ(share.high, 0.3);
}

TEST_F(Published, RowsSayWhatTheirScenesStandFor) {
  const auto all = rows("[stand_ins]\ncity = \"a city of 2012\"\n" + claim + "accept = [1, 2]\n" +
                        place_keys + claim + "cannot_be_told = \"lost\"\n");
  EXPECT_EQ(all[0].stand_in, "a city of 2012");
  EXPECT_EQ(all[1].stand_in, "");
}

TEST_F(Published, WrongFilesAreRefusedWithFileAndLine) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {claim + place_keys, "accept must be"},
      {claim + "accept = [2, 1]\n" + place_keys, "accept must be"},
      {claim + "accept = [1]\n" + place_keys, "accept must be"},
      {claim + "accept = \"fast\"\n" + place_keys, "accept must be"},
      {claim + "accept = [1, 2]\nculler = \"frustum.flat\"\n", "scene is missing"},
      {claim + "accept = [1, 2]\nscene = \"city\"\nculler = \"frustum.flar\"\n", "frustum.flat"},
      {claim + "accept = [1, 2]\ndevice = \"vulkan\"\n" + place_keys, "osmesa"},
      {claim + "cannot_be_told = \"lost\"\naccept = [1, 2]\n", "has no accept"},
      {claim + "verdict = \"true\"\n", "accept"}};
  for (const auto& [text, words] : cases) {
    const std::string message = refusal(text);
    EXPECT_NE(message.find(words), std::string::npos) << message << "\nof\n" << text;
    EXPECT_NE(message.find("figures.toml:"), std::string::npos) << message;
  }
}

/// The repository's own figures.
std::vector<PublishedFigures> own_files(const Registry& registry) {
  return load_published(std::filesystem::path(VISLAB_SOURCE_DIR) / "experiments" / "published",
                        registry);
}

TEST_F(Published, TheMatrixSeedsHasTheCellsOfEveryClaim) {
  const Matrix seeds = load_matrix(
      "seeds", std::filesystem::path(VISLAB_SOURCE_DIR) / "experiments" / "matrices", registry_);
  const auto has = [&](const PublishedRow& row, const std::string& chain, bool other = false) {
    const std::string& scene = other && !row.against_scene.empty() ? row.against_scene : row.scene;
    const std::string& path = other && !row.against_path.empty() ? row.against_path : row.path;
    return std::ranges::any_of(seeds.blocks, [&](const Block& block) {
      const bool there =
          block.scene == scene && (path.empty() || block.path == path) &&
          (row.device.empty() ? !block.device.starts_with("modelled") : block.device == row.device);
      return there && std::ranges::any_of(block.cullers, [&](const BlockCuller& culler) {
               return culler.chain == chain;
             });
    });
  };
  const auto all = own_files(registry_);
  EXPECT_GE(all.size(), 7U);
  for (const PublishedFigures& figures : all) {
    for (const PublishedRow& row : figures.rows) {
      if (!row.cannot_be_told.empty()) continue;
      EXPECT_TRUE(has(row, row.culler))
          << figures.title << ": " << row.what << ": " << row.short_culler << " on " << row.scene;
      EXPECT_TRUE(has(row, row.against, true))
          << figures.title << ": " << row.what << ": " << row.short_against << " on " << row.scene;
    }
  }
}

/// "16" of "N = 16,"; numbers of what a scene has are left out: "15,000 polygons".
std::vector<std::string> numbers_of_dials(const std::string& text) {
  const std::regex number(R"(([0-9][0-9,]*(\.[0-9]+)?)( million)?( [a-z]+)?)");
  const std::set<std::string> of_scenes{" polygons", " triangles", " hares", " houses", " rooms"};
  std::vector<std::string> numbers;
  for (std::sregex_iterator at(text.begin(), text.end(), number), end; at != end; ++at) {
    std::string digits = (*at)[1];
    if (digits.ends_with(',')) digits.pop_back();
    if (!of_scenes.contains((*at)[4])) numbers.push_back(digits);
  }
  return numbers;
}

/// The row's text of the key; "" without it.
std::string text_in(const std::string& row, const std::string& key) {
  std::smatch found;
  const std::regex line("\n" + key + " = \"(.*)\"");
  return std::regex_search(row, found, line) ? found[1].str() : "";
}

/// Numbers that `what` names and that neither a chain as written nor a scene's name has, where a
/// chain has a dial of data/knees.toml: the default may stand for the number today, and for another
/// tomorrow.
std::vector<std::string> numbers_left_to_defaults(const std::string& row,
                                                  const std::set<std::string>& with_dials) {
  const std::string chains = text_in(row, "culler") + " > " + text_in(row, "against");
  const bool has_dial = std::ranges::any_of(with_dials, [&](const std::string& culler) {
    return std::regex_search(chains, std::regex("(^|> )" + culler + R"((\[| |$))"));
  });
  std::vector<std::string> left;
  if (!has_dial) return left;
  const std::string scenes = text_in(row, "scene") + " " + text_in(row, "against_scene");
  for (const std::string& number : numbers_of_dials(text_in(row, "what"))) {
    const std::regex alone("(^|[^0-9.])" + number + "($|[^0-9.])");
    if (!std::regex_search(chains, alone) && !std::regex_search(scenes, alone)) {
      left.push_back(number);
    }
  }
  return left;
}

TEST_F(Published, ANumberThatAClaimNamesIsWrittenInItsChain) {
  const std::set<std::string> dials{"occlusion.batched"};
  const auto left = [&](const std::string& what, const std::string& culler) {
    return numbers_left_to_defaults("\nwhat = \"" + what + "\"\nculler = \"" + culler + "\"\n",
                                    dials);
  };
  EXPECT_EQ(left("batches of 80", "occlusion.batched"), std::vector<std::string>{"80"});
  EXPECT_EQ(left("batches of 80", "occlusion.batched[batch=8]"), std::vector<std::string>{"80"});
  EXPECT_TRUE(left("batches of 80, in 15,000 polygons", "occlusion.batched[batch=80]").empty());
  EXPECT_TRUE(left("of 80", "occlusion.other").empty());

  std::set<std::string> with_dials;
  const std::filesystem::path repository = VISLAB_SOURCE_DIR;
  for (const CommittedKnee& knee : read_knees(repository / "data" / "knees.toml")) {
    if (std::isdigit(static_cast<unsigned char>(knee.default_value.front())) != 0) {
      with_dials.insert(knee.culler);
    }
  }
  EXPECT_GE(with_dials.size(), 10U);
  for (const auto& entry :
       std::filesystem::directory_iterator(repository / "experiments" / "published")) {
    std::ifstream in(entry.path());
    const std::string all((std::istreambuf_iterator<char>(in)), {});
    std::size_t at = all.find("[[row]]");
    while (at != std::string::npos) {
      const std::size_t next = all.find("[[row]]", at + 1);
      const std::string row = all.substr(at, next - at);
      for (const std::string& number : numbers_left_to_defaults(row, with_dials)) {
        ADD_FAILURE() << entry.path() << ": '" << text_in(row, "what") << "' names " << number
                      << ", and its chain does not";
      }
      at = next;
    }
  }
}

TEST_F(Published, EveryClaimSaysWhatItsSceneStandsForOrWhyItCannotBeTold) {
  for (const PublishedFigures& figures : own_files(registry_)) {
    for (const PublishedRow& row : figures.rows) {
      EXPECT_TRUE(row.scene.empty() ? !row.cannot_be_told.empty() : !row.stand_in.empty())
          << figures.title << ": " << row.what << ": " << row.scene;
    }
  }
}

}  // namespace
}  // namespace vislab
