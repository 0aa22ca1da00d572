// The verbs that tell: help, list, describe, plan, export, compare, check, show.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "experiments/results/store.h"
#include "tests/experiments/program.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

/// One JSON object a line.
std::vector<nlohmann::json> objects(const std::string& text) {
  std::vector<nlohmann::json> all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) all.push_back(nlohmann::json::parse(line));
  return all;
}

std::vector<std::string> names(const std::string& text) {
  std::vector<std::string> all;
  for (const auto& object : objects(text)) all.push_back(object.at("name"));
  return all;
}

bool holds(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

TEST(Verbs, ListNamesEveryKindOfThing) {
  EXPECT_TRUE(holds(names(run_vislab({"list", "cullers", "--json"}).out), "frustum.flat"));
  EXPECT_TRUE(holds(names(run_vislab({"list", "scenes", "--json"}).out), "oa_dm2"));
  EXPECT_TRUE(holds(names(run_vislab({"list", "matrices", "--json"}).out), "default"));
  EXPECT_TRUE(holds(names(run_vislab({"list", "metrics", "--json"}).out), "false_px"));
}

TEST(Verbs, HelpNamesTheVerbsAndTellsAboutEachWhatItsOwnHelpDoes) {
  const ProgramResult all = run_vislab({"help"});
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_EQ(all.out, run_vislab({"--help"}).out);
  for (const char* verb : {"list", "run", "compare", "new-culler"}) {
    EXPECT_NE(all.out.find(std::string("\n  ") + verb + " "), std::string::npos) << verb;
    const ProgramResult one = run_vislab({"help", verb});
    EXPECT_EQ(one.exit_code, 0) << one.err;
    EXPECT_EQ(one.out, run_vislab({verb, "--help"}).out);
  }
}

TEST(Verbs, DescribeTellsAboutEveryListedThing) {
#ifdef __SANITIZE_ADDRESS__
  constexpr std::size_t step = 5;  // starting the program takes five times as long
#else
  constexpr std::size_t step = 1;
#endif
  for (const char* kind : {"cullers", "matrices", "metrics"}) {
    const std::vector<std::string> all = names(run_vislab({"list", kind, "--json"}).out);
    for (std::size_t i = 0; i < all.size(); i += step) {
      const std::string& name = all[i];
      const ProgramResult result = run_vislab({"describe", name, "--json"});
      EXPECT_EQ(result.exit_code, 0) << result.err;
      EXPECT_EQ(objects(result.out).at(0).at("name"), name);
    }
  }
  EXPECT_EQ(objects(run_vislab({"describe", "box_field_tiny", "--json"}).out).at(0).at("objects"),
            60);
  EXPECT_NE(run_vislab({"describe", "frustum.flat > backface.polygon"}).out.find("Then:"),
            std::string::npos);
}

TEST(Verbs, PlanNamesEveryCellOfAMatrixAndWhichAreDone) {
  const TemporaryFolder folder;
  const std::string results = folder.path() / "results";
  // How many cells there are of each status, in the first of the matrix's blocks (five; four where
  // no package is) and elsewhere.
  const auto statuses = [&] {
    std::map<std::pair<bool, std::string>, int> count;
    for (const auto& cell :
         objects(run_vislab({"plan", "smoke", "--json", "--results", results}).out)) {
      ++count[{cell.at("block") == 1, cell.at("status")}];
    }
    return count;
  };
  const auto before = statuses();
  ASSERT_EQ(before.size(), 2U) << "nothing is done";
  const int first = before.at({true, "open"});
  const int others = before.at({false, "open"});
  EXPECT_GT(first, 26) << "anchors and cullers";
  EXPECT_GT(others, 60);
  ASSERT_EQ(run_vislab({"run", "smoke", "--shard", "1/5", "--results", results}).exit_code, 0);
  EXPECT_EQ(statuses(), (std::map<std::pair<bool, std::string>, int>{{{true, "done"}, first},
                                                                     {{false, "open"}, others}}));
  EXPECT_EQ(ResultStore::open(results).noted_matrices(), std::set<std::string>{"smoke"});
}

TEST(Verbs, CheckHoldsACullerToItsContract) {
  const ProgramResult result = run_vislab({"check", "--culler", "frustum.flat", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  EXPECT_GT(objects(result.out).size(), 3U);
}

TEST(Verbs, ExportCompareAndShowReadTheResultsOfARun) {
  const TemporaryFolder folder;
  const std::string results = folder.path() / "results";
  const std::vector<std::string> call{
      "run",      "--culler", "frustum.flat", "--scene", "box_field_tiny", "--frames", "4",
      "--rounds", "2",        "--resolution", "64x64",   "--results",      results,    "--json"};
  const ProgramResult run = run_vislab(call);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(objects(run.out).size(), 5U);

  const ProgramResult exported = run_vislab({"export", "json", "--results", results});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  for (const auto& cell : objects(exported.out)) {
    EXPECT_EQ(cell.at("false_px"), 0) << cell;
    EXPECT_GT(cell.at("frame_ms"), 0.0) << cell;
    EXPECT_GE(cell.at("cost.triangle_ns_high"), cell.at("cost.triangle_ns_low")) << cell;
    EXPECT_GT(cell.at("modelled_frame_ms"), 0.0) << cell;
  }
  const std::string csv = run_vislab({"export", "csv", "--results", results}).out;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 6);

  const ProgramResult compared =
      run_vislab({"compare", "frustum.flat", "none", "--results", results, "--json"});
  ASSERT_EQ(compared.exit_code, 0) << compared.err;
  const nlohmann::json row = objects(compared.out).at(0);
  EXPECT_LE(row.at("ratio_low"), row.at("ratio"));
  EXPECT_GE(row.at("ratio_high"), row.at("ratio"));

  const std::string picture = folder.path() / "picture.png";
  const ProgramResult shown =
      run_vislab({"show", "--culler", "frustum.flat", "--scene", "box_field_tiny", "--resolution",
                  "64x64", "--frame", "2", "-o", picture});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_GT(std::filesystem::file_size(picture), 1000U);
}

TEST(Verbs, WhatCullersAskIsPicturedInThreeWays) {
  const TemporaryFolder folder;
  for (const std::string kind : {"strip", "boxes", "timeline"}) {
    const std::string picture = folder.path() / (kind + ".png");
    const ProgramResult shown =
        run_vislab({"show", "--queries", kind, "--culler", "occlusion.stop_and_wait", "--culler",
                    "occlusion.chcpp", "--scene", "plant_tiny", "--frame", "2", "--draw",
                    "modelled[preset=gpu]", "--resolution", "64x48", "-o", picture});
    ASSERT_EQ(shown.exit_code, 0) << shown.err;
    EXPECT_GT(std::filesystem::file_size(picture), 1000U);
  }
}

TEST(Verbs, DepthComplexityIsPicturedAndCountedByAllDefinitions) {
  const TemporaryFolder folder;
  const std::string picture = folder.path() / "depth.png";
  const ProgramResult shown =
      run_vislab({"show", "--depth-complexity", "polygons", "--scene", "plant_tiny", "--frame", "3",
                  "--resolution", "64x48", "-o", picture, "--json"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_GT(std::filesystem::file_size(picture), 1000U);
  const std::vector<nlohmann::json> rows = objects(shown.out);
  ASSERT_EQ(rows.size(), 3U);
  for (const nlohmann::json& row : rows) {
    EXPECT_EQ(row.at("path"), "plant_tiny_walk");
    EXPECT_GT(row.at("mean"), 0.0);
    EXPECT_GE(row.at("max"), row.at("p95"));
  }
  EXPECT_EQ(rows[0].at("definition"), "rays");
  EXPECT_LT(rows[0].at("mean"), rows[1].at("mean"));
  EXPECT_LT(rows[2].at("mean"), rows[0].at("mean"));
}

TEST(Verbs, AFieldOfAMillionObjectsIsCulledWithoutDrawing) {
  const TemporaryFolder folder;
#ifdef __SANITIZE_ADDRESS__
  // The sanitizers take ten times as long: the least field that is not drawn.
  const std::string field = folder.path() / "field.toml";
  std::ofstream(field) << "default_path = \"turn\"\n[generator]\nkind = \"box_field\"\n"
                          "count = 160000\nextent_m = 270.0\nseed = 1\n";
#else
  const std::string field = "box_field_1m";
#endif
  const std::string results = folder.path() / "results";
  const ProgramResult run =
      run_vislab({"run", "--culler", "none > frustum.flat > frustum.flat[test=sphere]", "--scene",
                  field, "--frames", "2", "--rounds", "1", "--resolution", "128x128", "--results",
                  results, "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const auto& cell : objects(run.out)) {
    EXPECT_EQ(cell.at("false_px"), 0) << cell;
    EXPECT_TRUE(cell.at("image_px").is_null()) << "not drawn, so no image is judged";
  }
}

}  // namespace
}  // namespace vislab
