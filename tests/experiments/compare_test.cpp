// Comparing two chains: what is said of speed and of errors, block by block and overall.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "experiments/results/files.h"
#include "experiments/results/store.h"
#include "tests/experiments/program.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

/// A run of three chains on one scene, whose stored times the tests replace.
class Compare : public ::testing::Test {
 protected:
  void SetUp() override {
    const fs::path matrix =
        folder_.write("matrix.toml",
                      "rounds = 3\n[lists]\nculler = [\"frustum.flat\", \"frustum.bvh\", "
                      "\"frustum.wrong\"]\nscene = [\"box_field_tiny\"]\n"
                      "resolution = [\"64x64\"]\nframes = [6]\n");
    const ProgramResult run =
        run_vislab({"run", matrix, "--quiet", "--threads", "1", "--results", results()});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }

  std::string results() const { return folder_.path() / "results"; }

  /// Frame times of each chain as if it took `ms`, the last round `spread` times that; of a cell as
  /// of what was measured beside it. Chains that are not named take 1 ms.
  void set_times(const std::map<std::string, double>& ms, double spread = 1.0) const {
    const ResultStore store = ResultStore::open(results());
    const auto time_of = [&](const std::string& chain, std::size_t round) {
      double time = 1.0;
      for (const auto& [name, value] : ms) {
        if (chain.starts_with(name)) time = value;
      }
      return chain.starts_with("frustum") && round == 2 ? time * spread : time;
    };
    for (ResultCell cell : store.load_all()) {
      for (std::size_t i = 0; i < cell.rounds.size(); ++i) {
        for (double& sample : cell.rounds[i].frame_ms) sample = time_of(cell.key.chain, i);
      }
      for (auto& [chain, rounds] : cell.anchors) {
        for (std::size_t i = 0; i < rounds.size(); ++i) {
          for (double& sample : rounds[i].frame_ms) sample = time_of(chain, i);
        }
      }
      store.save_cell(cell);
    }
  }

  /// The row of the block and that over all blocks.
  std::vector<nlohmann::json> compare(const std::string& a, const std::string& b) const {
    const ProgramResult result = run_vislab({"compare", a, b, "--results", results(), "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::vector<nlohmann::json> rows;
    std::istringstream in(result.out);
    for (std::string line; std::getline(in, line);) rows.push_back(nlohmann::json::parse(line));
    EXPECT_EQ(rows.size(), 2U);
    rows.resize(2);
    return rows;
  }

  TemporaryFolder folder_;
};

TEST_F(Compare, SaysFasterOrSlowerWithTheInterval) {
  set_times({{"frustum.flat", 0.5}});
  for (const nlohmann::json& row : compare("frustum.flat", "none")) {
    EXPECT_EQ(row.at("speed"), "faster");
    EXPECT_DOUBLE_EQ(row.at("ratio"), 0.5);
    EXPECT_DOUBLE_EQ(row.at("ratio_low"), 0.5);
    EXPECT_DOUBLE_EQ(row.at("ratio_high"), 0.5);
  }
  for (const nlohmann::json& row : compare("none", "frustum.flat")) {
    EXPECT_EQ(row.at("speed"), "slower");
    EXPECT_DOUBLE_EQ(row.at("ratio"), 2.0);
  }
  const ProgramResult text =
      run_vislab({"compare", "frustum.flat", "frustum.bvh", "--results", results()});
  EXPECT_NE(text.out.find("frustum.flat is faster than frustum.bvh"), std::string::npos)
      << text.out;
}

TEST_F(Compare, IsUndecidedWhereTheIntervalReachesOne) {
  set_times({{"frustum.flat", 0.8}}, 1.5);
  const nlohmann::json row = compare("frustum.flat", "none").at(0);
  EXPECT_LT(row.at("ratio_low"), 1.0);
  EXPECT_GT(row.at("ratio_high"), 1.0);
  EXPECT_EQ(row.at("speed"), "undecided");
}

TEST_F(Compare, IsUndecidedWhereNoneAgainstItselfDiffersAsMuch) {
  set_times({{"frustum.flat", 0.95}});
  EXPECT_EQ(compare("frustum.flat", "none").at(0).at("speed"), "faster");
  const ResultStore store = ResultStore::open(results());
  for (ResultCell cell : store.load_all()) {
    if (cell.key.replicate == 0) continue;
    for (Round& round : cell.rounds) {
      for (double& sample : round.frame_ms) sample = 0.9;
    }
    store.save_cell(cell);
  }
  EXPECT_EQ(compare("frustum.flat", "none").at(0).at("speed"), "undecided");
}

TEST_F(Compare, SaysWhichHasMoreErrors) {
  for (const nlohmann::json& row : compare("frustum.wrong", "none")) {
    EXPECT_EQ(row.at("errors"), "more");
    EXPECT_GT(row.at("false_px_a"), 0);
    EXPECT_EQ(row.at("false_px_b"), 0);
  }
  EXPECT_EQ(compare("none", "frustum.wrong").at(1).at("errors"), "fewer");
  EXPECT_EQ(compare("frustum.flat", "frustum.bvh").at(1).at("errors"), "same");
}

TEST_F(Compare, WhatIsLostBetweenPixelsCountsForWhoPromisesAll) {
  // As if frustum.flat had lost a sample between the centres of pixels.
  const ResultStore store = ResultStore::open(results());
  for (const ResultCell& cell : store.load_all()) {
    if (!cell.key.chain.starts_with("frustum.flat")) continue;
    const fs::path file = fs::path(results()) / "verdicts" / (cell.key.id() + ".json");
    nlohmann::json verdicts = nlohmann::json::parse(read_file(file));
    verdicts.at("frames").at(0).at("false_jittered") = 1;
    write_file(file, verdicts.dump());
  }
  for (const nlohmann::json& row : compare("frustum.flat", "frustum.bvh")) {
    EXPECT_EQ(row.at("errors"), "more");
    EXPECT_EQ(row.at("false_jittered_a"), 1);
    EXPECT_EQ(row.at("false_jittered_b"), 0);
    EXPECT_EQ(row.at("false_px_a"), 0);
  }
}

TEST(CompareImages, PixelsThatAMethodPaintsWronglyAreErrors) {
  const TemporaryFolder folder;
  const std::string results = folder.path() / "results";
  const std::string matrix =
      folder.write("matrix.toml",
                   "rounds = 1\n[lists]\nculler = [\"surface.span_buffer\", \"surface.bsp\"]\n"
                   "scene = [\"crossing_quads\"]\nresolution = [\"128x128\"]\nframes = [1]\n");
  const ProgramResult run =
      run_vislab({"run", matrix, "--quiet", "--threads", "1", "--results", results});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // Each has kept what is seen; one has given pixels of it to the wrong quad.
  const ProgramResult result =
      run_vislab({"compare", "surface.span_buffer", "surface.bsp", "--results", results, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::istringstream rows(result.out);
  for (std::string line; std::getline(rows, line);) {
    const nlohmann::json row = nlohmann::json::parse(line);
    EXPECT_EQ(row.at("errors"), "more");
    EXPECT_GT(row.at("surface_px_a"), 0);
    EXPECT_EQ(row.at("surface_px_b"), 0);
    EXPECT_EQ(row.at("false_px_a"), 0);
  }
}

TEST_F(Compare, AMethodThatFailedHasNeitherTimesNorErrors) {
  set_times({{"frustum.wrong", 0.5}});
  const ResultStore store = ResultStore::open(results());
  for (ResultCell cell : store.load_all()) {
    if (!cell.key.chain.starts_with("frustum.wrong")) continue;
    cell.status = ResultCell::Status::failed;
    cell.reason = "crashed";
    store.save_cell(cell);
  }
  const std::vector<nlohmann::json> rows = compare("frustum.wrong", "none");
  EXPECT_NE(rows[0].at("note").get<std::string>().find("failed: crashed"), std::string::npos);
  for (const nlohmann::json& row : rows) {
    EXPECT_EQ(row.at("speed"), "undecided");
    EXPECT_TRUE(row.at("errors").is_null()) << row;
    EXPECT_EQ(row.at("judged"), 0);
  }
  EXPECT_EQ(rows[1].at("blocks"), 0);
  const std::string text =
      run_vislab({"compare", "frustum.wrong", "none", "--results", results()}).out;
  EXPECT_NE(text.find("in 0 of 1 block,"), std::string::npos) << text;
  EXPECT_NE(text.find("failed in 1"), std::string::npos) << text;
  EXPECT_NE(text.find("errors are not judged"), std::string::npos) << text;
}

TEST_F(Compare, BlocksOfSeveralMachinesAreLeftOutOfTheOverallFigure) {
  set_times({{"frustum.flat", 0.5}});
  const ResultStore store = ResultStore::open(results());
  for (ResultCell cell : store.load_all()) {
    if (!cell.key.chain.starts_with("frustum.bvh")) continue;
    cell.context["machine"] = "another";
    store.save_cell(cell);
  }
  const std::vector<nlohmann::json> rows = compare("frustum.flat", "none");
  for (const nlohmann::json& row : rows) {
    EXPECT_EQ(row.at("speed"), "undecided");
    EXPECT_TRUE(row.at("ratio").is_null()) << row;
  }
  EXPECT_NE(rows[0].at("note").get<std::string>().find("2 machines"), std::string::npos);
  EXPECT_NE(rows[1].at("note").get<std::string>().find("1 block of several machines left out"),
            std::string::npos);
  EXPECT_EQ(rows[1].at("judged"), 1) << "errors do not depend on the machine";
}

TEST_F(Compare, IsUndecidedWithoutAControl) {
  set_times({{"frustum.flat", 0.5}});
  const ResultStore store = ResultStore::open(results());
  for (const ResultCell& cell : store.load_all()) {
    if (cell.key.replicate == 0) continue;
    fs::remove(fs::path(results()) / "cells" / (cell.key.id() + ".json"));
  }
  const std::vector<nlohmann::json> rows = compare("frustum.flat", "none");
  EXPECT_EQ(rows[0].at("speed"), "undecided");
  EXPECT_EQ(rows[1].at("speed"), "undecided");
  EXPECT_NE(rows[1].at("note").get<std::string>().find("without a control"), std::string::npos);
}

TEST_F(Compare, ChainsOfDifferentRunsAreComparedThroughNone) {
  // As if the two had been measured in two runs, each with none beside it.
  const ResultStore store = ResultStore::open(results());
  for (ResultCell cell : store.load_all()) {
    if (!cell.key.chain.starts_with("frustum.bvh")) continue;
    for (Round& round : cell.rounds) round.session = "another run";
    for (auto& [chain, rounds] : cell.anchors) {
      for (AnchorRound& round : rounds) round.session = "another run";
    }
    store.save_cell(cell);
  }
  set_times({{"frustum.flat", 0.5}, {"frustum.bvh", 0.25}});
  const nlohmann::json row = compare("frustum.flat", "frustum.bvh").at(0);
  EXPECT_NEAR(row.at("ratio"), 2.0, 1e-9);
  EXPECT_EQ(row.at("speed"), "slower");
  EXPECT_NE(row.at("note").get<std::string>().find("through none"), std::string::npos);
}

TEST_F(Compare, WrongNamesAndWhatWasNotMeasuredAreMessages) {
  const auto refused = [&](const std::string& a, const std::string& b, const std::string& word) {
    const ProgramResult result = run_vislab({"compare", a, b, "--results", results()});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
  };
  refused("frustum.flatt", "none", "frustum.flat,");
  refused("none", "none", "same chain");
  refused("frustum.flat", "frustum.octree",
          "vislab run --culler frustum.octree --scene box_field_tiny --resolution 64x64");
  refused("none", "surface.bsp", "vislab run");
}

TEST_F(Compare, WhatItAdvisesMakesTheCellsThatWereMissing) {
  const std::string advice =
      run_vislab({"compare", "frustum.octree", "frustum.flat", "--results", results()}).err;
  const auto at = advice.find("vislab run ");
  ASSERT_NE(at, std::string::npos) << advice;
  std::istringstream words(advice.substr(at + 7));
  std::vector<std::string> call;
  for (std::string word; words >> word;) call.push_back(word);
  call.push_back("--quiet");
  const ProgramResult run = run_vislab(call);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json row = compare("frustum.octree", "frustum.flat").at(0);
  EXPECT_TRUE(row.at("ratio").is_number()) << row;
}

}  // namespace
}  // namespace vislab
