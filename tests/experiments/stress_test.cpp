// Stress sweeps from end to end: run, atlas, report.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/experiments/program.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

std::vector<nlohmann::json> objects(const std::string& text) {
  std::vector<nlohmann::json> all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) all.push_back(nlohmann::json::parse(line));
  return all;
}

/// Boxes that grow beyond the frustum: the test of single corners loses them. `expected` is what is
/// said of it.
std::string growing_boxes(const std::string& expected) {
  return "description = \"Boxes grow\"\nfailure = \"F2\"\n"
         "cullers = [\"frustum.flat\", \"frustum.wrong[error=any_corner_inside]\"]\n"
         "resolution = \"32x32\"\nframes = 4\nrounds = 1\ndraw = \"none\"\n"
         "[dial]\nname = \"edge\"\nunit = \"m\"\nvalues = [0.5, 1, 2, 4, 8, 16, 32, 64]\n"
         "[scene.generator]\nkind = \"box_field\"\ncount = 60\nextent_m = 80.0\n"
         "edge_m = \"${dial}\"\nclear_radius_m = 10.0\n"
         "[path]\nkind = \"turn\"\neye = [0.0, 0.0, 0.0]\nfov_deg = 45.0\n"
         "[[expect]]\nculler = \"frustum.flat\"\nbreaks = \"never\"\nsource = \"s\"\n"
         "because = \"it is right\"\n"
         "[[expect]]\nculler = \"frustum.wrong*\"\nbreaks = " +
         expected + "\nsource = \"s\"\nbecause = \"it is wrong\"\n";
}

TEST(Stress, ASweepFileRunsOnceAndItsPlanIsDone) {
  const TemporaryFolder folder;
  const std::string results = folder.path() / "results";
  const std::string file = folder.write("growing.toml", growing_boxes("[1, 64]"));
  const ProgramResult first = run_vislab({"run", file, "--results", results, "--json"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(objects(first.out).size(), 8U * 6U);
  const ProgramResult again = run_vislab({"run", file, "--results", results, "--json"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.err.find(" 6 cells measured"), std::string::npos) << "all were there";
  for (const auto& cell : objects(run_vislab({"plan", file, "--results", results, "--json"}).out)) {
    EXPECT_EQ(cell.at("status"), "done");
  }
}

TEST(Stress, TheAtlasTellsWhereMethodsBreakAndWhetherThatWasExpected) {
  const TemporaryFolder folder;
  const std::string results = folder.path() / "results";
  ASSERT_EQ(run_vislab({"run", "box_in_frustum", "--results", results, "--quiet"}).exit_code, 0);
  const ProgramResult atlas = run_vislab({"atlas", "--results", results, "--json"});
  EXPECT_EQ(atlas.exit_code, 0) << "nothing broke that never should: " << atlas.out;
  EXPECT_NE(atlas.err.find("not run: "), std::string::npos);
  std::map<std::string, nlohmann::json> rows;
  for (const auto& row : objects(atlas.out)) rows[row.at("culler")] = row;
  EXPECT_TRUE(rows.at("frustum.flat").at("breaks_at").is_null());
  EXPECT_EQ(rows.at("frustum.flat").at("verdict"), "agrees");
  const nlohmann::json& wrong = rows.at("frustum.wrong[error=any_corner_inside]");
  EXPECT_GT(wrong.at("breaks_at"), 0.5);
  EXPECT_GT(wrong.at("worst"), 0.0);
  EXPECT_EQ(wrong.at("guarantee"), "erroneous");

  const std::string text = run_vislab({"atlas", "--results", results}).out;
  EXPECT_NE(text.find("false_px > 0"), std::string::npos) << text;
  EXPECT_NE(text.find("edge = "), std::string::npos) << "where it breaks: " << text;
  EXPECT_NE(text.find("promises broken: 0"), std::string::npos) << text;
}

TEST(Stress, TheAtlasSaysWhichOfItsRowsHaveNoSweepAndWhy) {
  const TemporaryFolder folder;
  const std::string results = folder.path() / "results";
  ASSERT_EQ(run_vislab({"run", "box_in_frustum", "--results", results, "--quiet"}).exit_code, 0);
  const std::string text = run_vislab({"atlas", "--results", results}).out;
  EXPECT_NE(text.find("77 of 79 entries of the failure atlas have a sweep; without: F13 (scenes"),
            std::string::npos)
      << text;
}

TEST(Stress, TheAtlasKnowsSweepsOfOnesOwnAndOnlyAsTheyAreNow) {
  const TemporaryFolder folder;
  const std::string results = folder.path() / "results";
  const auto run = [&](const std::string& text) {
    return run_vislab({"run", folder.write("growing.toml", text), "--results", results, "--quiet"});
  };
  const auto rows = [&] {
    std::map<std::string, nlohmann::json> found;
    for (const auto& row : objects(run_vislab({"atlas", "--results", results, "--json"}).out)) {
      if (row.at("sweep") == "growing") found[row.at("culler")] = row;
    }
    return found;
  };
  const std::string wrong = "frustum.wrong[error=all_corners_inside]";
  std::string text = growing_boxes("[1, 64]");
  text.replace(text.find("any_corner_inside"), 17, "all_corners_inside");
  ASSERT_EQ(run(text).exit_code, 0);
  const double first = rows().at(wrong).at("worst");
  EXPECT_GT(first, 0.0);
  // Fewer boxes, same dial and chains: the figures must be those of the new boxes.
  text.replace(text.find("count = 60"), 10, "count = 20");
  ASSERT_EQ(run(text).exit_code, 0);
  const double second = rows().at(wrong).at("worst");
  EXPECT_NE(second, first);
  EXPECT_EQ(rows().at(wrong).at("note"), "");
  // Only some of the cells: the others' notes stay.
  ASSERT_EQ(run_vislab({"run", folder.path() / "growing.toml", "--results", results, "--quiet",
                        "--filter", "flat"})
                .exit_code,
            0);
  EXPECT_EQ(rows().at(wrong).at("worst"), second);
  // Described anew, not run again: nothing that was measured counts.
  text.replace(text.find("count = 20"), 10, "count = 30");
  const std::string kept = folder.path() / "results/stress/growing/sweep/growing.toml";
  std::ofstream(kept) << text;
  const ProgramResult stale = run_vislab({"atlas", "--results", results});
  EXPECT_EQ(stale.exit_code, 2);
  EXPECT_NE(stale.err.find("no stress sweep was run"), std::string::npos) << stale.err;
}

TEST(Stress, AFileNamedLikeASweepOfTheLabIsRefused) {
  const TemporaryFolder folder;
  const ProgramResult result =
      run_vislab({"run", folder.write("box_edge.toml", growing_boxes("[1, 64]")), "--results",
                  folder.path() / "results"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("another name"), std::string::npos) << result.err;
}

TEST(Stress, ACounterThatNoMethodHasIsRefusedByTheAtlas) {
  const TemporaryFolder folder;
  const std::string results = folder.path() / "results";
  const std::string text =
      growing_boxes("[1, 64]") + "[limit]\ncounter = \"plane_test\"\nat_most = 1\n";
  const ProgramResult run =
      run_vislab({"run", folder.write("growing.toml", text), "--results", results, "--quiet"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const ProgramResult atlas = run_vislab({"atlas", "--results", results});
  EXPECT_EQ(atlas.exit_code, 2);
  EXPECT_NE(atlas.err.find("has no counter 'plane_test'"), std::string::npos) << atlas.err;
  EXPECT_NE(atlas.err.find("plane_tests"), std::string::npos) << "the right ones are named";
}

TEST(Stress, ASceneThatIsWrongAtEveryValueIsToldOnce) {
  const TemporaryFolder folder;
  std::string text = growing_boxes("[1, 64]");
  text.replace(text.find("count = 60"), 10, "count = -1");
  const ProgramResult result = run_vislab({"run", folder.write("growing.toml", text), "--results",
                                           folder.path() / "results", "--quiet"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  EXPECT_NE(result.err.find("sweep growing"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("count"), std::string::npos) << result.err;
}

TEST(Stress, SweepsAreListedDescribedAndRefusedLikeMatrices) {
  const std::string listed = run_vislab({"list", "matrices", "--json"}).out;
  EXPECT_NE(listed.find("box_in_frustum"), std::string::npos);
  const ProgramResult described = run_vislab({"describe", "box_in_frustum", "--json"});
  EXPECT_EQ(objects(described.out).at(0).at("failure"), "F2");

  const TemporaryFolder folder;
  const std::string results = folder.path() / "results";
  const auto refused = [&](const std::vector<std::string>& call, const std::string& word) {
    const ProgramResult result = run_vislab(call);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
  };
  refused({"run", folder.write("bad.toml", growing_boxes("\"soon\"")), "--results", results},
          "breaks must be");
  refused({"plan", "no_such_sweep", "--results", results}, "stress");
  refused({"atlas", "--results", results}, "no results");
}

}  // namespace
}  // namespace vislab
