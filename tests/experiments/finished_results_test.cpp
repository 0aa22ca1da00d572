// What was measured stays until there is something better, and what is damaged is in nobody's way.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "experiments/results/files.h"
#include "experiments/results/store.h"
#include "tests/experiments/program.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

class FinishedResults : public ::testing::Test {
 protected:
  fs::path results() const { return folder_.path() / "results"; }

  std::string matrix(const std::string& settings) const {
    return folder_.write(
        "matrix.toml",
        settings +
            "\n[lists]\nculler = [\"frustum.flat\", \"backface.polygon\"]\n"
            "scene = [\"box_field_tiny\"]\nresolution = [\"64x64\"]\nframes = [100]\n");
  }

  /// Runs the matrix with these settings, such as "rounds = 2".
  ProgramResult run(const std::string& settings, const std::vector<std::string>& more = {}) const {
    return run_vislab(call(settings, more));
  }
  std::vector<std::string> call(const std::string& settings,
                                const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"run", matrix(settings), "--results", results(), "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  std::vector<ResultCell> cells() const { return ResultStore::open(results()).load_all(); }

  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(results() / "cells")) {
      all[entry.path().filename()] = read_file(entry.path());
    }
    return all;
  }

  TemporaryFolder folder_;
};

TEST_F(FinishedResults, OnlyTheLabsOwnTemporaryFilesAreRemoved) {
  ASSERT_EQ(run("rounds = 1").exit_code, 0);
  const std::string hash(32, 'a');
  fs::create_directories(results() / "mine");
  const std::vector<fs::path> of_the_user{
      results() / "notes.tmp", results() / "cells" / "notes.tmp",
      results() / "mine" / (hash + ".json.12.0.tmp"), results() / "cells" / (hash + ".tmp")};
  const std::vector<fs::path> of_the_lab{results() / "cells" / (hash + ".json.12.0.tmp"),
                                         results() / "truth" / (hash + ".truth.12.345.tmp"),
                                         results() / "sets" / (hash + ".set.12.tmp")};
  for (const auto& list : {of_the_user, of_the_lab}) {
    for (const fs::path& file : list) write_file(file, "half");
  }
  ASSERT_EQ(run("rounds = 1").exit_code, 0);
  for (const fs::path& file : of_the_user) EXPECT_TRUE(fs::exists(file)) << file;
  for (const fs::path& file : of_the_lab) EXPECT_FALSE(fs::exists(file)) << file;
}

TEST_F(FinishedResults, AForcedRunThatIsStoppedLeavesThemAsTheyWere) {
  ASSERT_EQ(run("rounds = 2").exit_code, 0);
  const auto before = files();
  const auto start = std::chrono::steady_clock::now();
  const ProgramResult stopped = signal_vislab(call("rounds = 1000", {"--force"}), SIGINT, [&start] {
    return std::chrono::steady_clock::now() - start > std::chrono::seconds(4);
  });
  EXPECT_EQ(stopped.exit_code, 1) << stopped.err;
  EXPECT_EQ(files(), before);
  const ProgramResult exported = run_vislab({"export", "json", "--results", results()});
  EXPECT_EQ(exported.out.find("\"false_px\":null"), std::string::npos) << "their verdicts stay too";
}

TEST_F(FinishedResults, AForcedRunThatFailsLeavesThemAsTheyWereAndSaysSo) {
  ASSERT_EQ(run("rounds = 2").exit_code, 0);
  const auto before = files();
  const ProgramResult failed = run("rounds = 100\ntimeout_s = 0.000001", {"--force"});
  EXPECT_EQ(failed.exit_code, 1) << failed.err;
  EXPECT_NE(failed.err.find("the result from before is kept"), std::string::npos) << failed.err;
  EXPECT_EQ(files(), before);
}

TEST_F(FinishedResults, AForcedRunReplacesThemWhenItIsThrough) {
  ASSERT_EQ(run("rounds = 2").exit_code, 0);
  std::map<std::string, std::string> sessions;
  for (const ResultCell& cell : cells()) sessions[cell.key.id()] = cell.rounds[0].session;
  ASSERT_EQ(run("rounds = 1", {"--force"}).exit_code, 0);
  EXPECT_EQ(cells().size(), sessions.size());
  for (const ResultCell& cell : cells()) {
    EXPECT_EQ(cell.status, ResultCell::Status::done);
    ASSERT_EQ(cell.rounds.size(), 1U) << cell.culler;
    EXPECT_NE(cell.rounds[0].session, sessions[cell.key.id()]) << cell.culler;
  }
}

TEST_F(FinishedResults, ForceWithAFilterLeavesTheAnchorsRounds) {
  ASSERT_EQ(run("rounds = 3").exit_code, 0);
  ASSERT_EQ(run("rounds = 1", {"--force", "--filter", "frustum.flat"}).exit_code, 0);
  for (const ResultCell& cell : cells()) {
    EXPECT_EQ(cell.rounds.size(), cell.culler == "frustum.flat" ? 1U : 3U) << cell.culler;
    if (cell.culler == "frustum.flat") {
      EXPECT_FALSE(cell.anchors.empty()) << "they ran beside it";
    }
  }
}

TEST_F(FinishedResults, ADiskThatIsTooFullForTheTruthIsOneMessage) {
  const std::string two_scenes = folder_.write(
      "two.toml",
      "rounds = 1\n[lists]\nculler = [\"frustum.flat\"]\n"
      "scene = [\"box_field_tiny\"]\nresolution = [\"320x320\", \"400x400\"]\nframes = [3]\n");
  const ProgramResult full =
      run_vislab_on_full_disk({"run", two_scenes, "--results", results(), "--quiet"}, 400);
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_EQ(std::ranges::count(full.err, '\n'), 1) << full.err;
  EXPECT_NE(full.err.find(".truth"), std::string::npos) << full.err;
  EXPECT_NE(full.err.find("make room"), std::string::npos) << full.err;
  EXPECT_TRUE(fs::is_empty(results() / "truth"));
}

TEST_F(FinishedResults, ADamagedCellIsToldLeftOutAndMeasuredAgain) {
  ASSERT_EQ(run("rounds = 1").exit_code, 0);
  const fs::path damaged = fs::directory_iterator(results() / "cells")->path();
  const std::string half = read_file(damaged).substr(0, 200);
  for (const std::vector<std::string>& how : {std::vector<std::string>{}, {"--force"}}) {
    write_file(damaged, half);
    const ProgramResult exported = run_vislab({"export", "csv", "--results", results()});
    EXPECT_EQ(exported.exit_code, 0) << exported.err;
    EXPECT_EQ(std::ranges::count(exported.err, '\n'), 1) << exported.err;
    EXPECT_NE(exported.err.find(damaged.filename().string()), std::string::npos) << exported.err;
    EXPECT_EQ(read_file(damaged), half) << "reading changes nothing";
    const ProgramResult again = run("rounds = 1", how);
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(cells().size(), 6U);
  }
}

TEST_F(FinishedResults, WhatWasPutAsideBeforeIsNotOverwritten) {
  ASSERT_EQ(run("rounds = 1").exit_code, 0);
  const fs::path file = fs::directory_iterator(results() / "cells")->path();
  const fs::path aside = results() / "other_formats" / "1";
  for (const std::string culler : {"first", "second"}) {
    write_file(file, "{\"format\":1,\"method\":\"" + culler + "\"}");
    ASSERT_EQ(run("rounds = 1").exit_code, 0);
  }
  EXPECT_NE(read_file(aside / file.filename()).find("first"), std::string::npos);
  EXPECT_NE(read_file(aside / (file.stem().string() + ".2.json")).find("second"),
            std::string::npos);
}

TEST_F(FinishedResults, ASweepThatCannotBeReadIsLeftOutWithANote) {
  ASSERT_EQ(run("rounds = 1").exit_code, 0);
  write_file(
      [&] {
        const fs::path folder = results() / "stress" / "my_sweep" / "sweep";
        fs::create_directories(folder);
        return folder / "my_sweep.toml";
      }(),
      "description = \"cut off\n");
  const ProgramResult atlas = run_vislab({"atlas", "--results", results()});
  EXPECT_NE(atlas.err.find("sweep left out: "), std::string::npos) << atlas.err;
  EXPECT_NE(atlas.err.find("no stress sweep was run"), std::string::npos)
      << "it goes on to what else there is: " << atlas.err;
}

TEST_F(FinishedResults, ACheckWithoutAWrongPixelSaysThatItWroteNoPicture) {
  const fs::path picture = folder_.path() / "wrong.png";
  const ProgramResult result =
      run_vislab({"check", "--culler", "frustum.flat", "-o", picture.string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("no wrong pixel: no picture written"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(picture));
}

}  // namespace
}  // namespace vislab
