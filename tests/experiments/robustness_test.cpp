// What may happen to a results folder: runs that are interrupted, a full disk, two runs at once,
// cells of other versions, damaged files. Nothing is lost, and what is wrong is said.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <future>
#include <map>

#include "experiments/results/files.h"
#include "experiments/results/folder_lock.h"
#include "experiments/results/store.h"
#include "tests/experiments/program.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

class ResultsFolder : public ::testing::Test {
 protected:
  std::string results() const { return folder_.path() / "results"; }

  /// One scene and two cullers; enough rounds that a run can be stopped in their midst.
  std::vector<std::string> call(int rounds) const {
    const std::string matrix = folder_.write(
        "matrix" + std::to_string(rounds) + ".toml",
        "rounds = " + std::to_string(rounds) +
            "\n[lists]\nculler = [\"frustum.flat\", \"backface.polygon\"]\n"
            "scene = [\"box_field_tiny\"]\nresolution = [\"128x128\"]\nframes = [10]\n");
    return {"run", matrix, "--results", results(), "--quiet"};
  }

  std::vector<ResultCell> cells() const { return ResultStore::open(results()).load_all(); }

  bool any_round() const {
    std::error_code code;
    if (!fs::is_directory(fs::path(results()) / "cells", code)) return false;
    return std::ranges::any_of(cells(),
                               [](const ResultCell& cell) { return !cell.rounds.empty(); });
  }

  /// Every cell can be read, and nothing half-written is left.
  void expect_whole() const {
    EXPECT_NO_THROW(cells());
    for (const auto& entry : fs::recursive_directory_iterator(results())) {
      EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
    }
  }

  /// All files of the cells.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(fs::path(results()) / "cells")) {
      all[entry.path().filename()] = read_file(entry.path());
    }
    return all;
  }

  static void expect_one_line(const std::string& text, const std::string& word) {
    EXPECT_EQ(std::ranges::count(text, '\n'), 1) << text;
    EXPECT_NE(text.find(word), std::string::npos) << text;
  }

  TemporaryFolder folder_;
};

class StoppedBySignal : public ResultsFolder, public ::testing::WithParamInterface<int> {};

TEST_P(StoppedBySignal, KeepsWholeRoundsAndGoesOnFromThere) {
  const int rounds = 40;
  const ProgramResult stopped =
      signal_vislab(call(rounds), GetParam(), [&] { return any_round(); });
  EXPECT_EQ(stopped.exit_code, 1) << stopped.err;
  EXPECT_NE(stopped.err.find("the same call goes on from here"), std::string::npos) << stopped.err;
  expect_whole();
  std::map<std::string, std::string> first_session;
  for (const ResultCell& cell : cells()) {
    EXPECT_LT(cell.rounds.size(), static_cast<std::size_t>(rounds));
    if (!cell.rounds.empty()) first_session[cell.key.id()] = cell.rounds.front().session;
  }
  EXPECT_EQ(first_session.size(), 6U);
  const ProgramResult finished = run_vislab(call(rounds));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  for (const ResultCell& cell : cells()) {
    EXPECT_EQ(cell.status, ResultCell::Status::done);
    EXPECT_EQ(cell.rounds.size(), static_cast<std::size_t>(rounds));
    EXPECT_EQ(cell.rounds.front().session, first_session[cell.key.id()]) << "what was kept is used";
  }
}

INSTANTIATE_TEST_SUITE_P(Signals, StoppedBySignal, ::testing::Values(SIGINT, SIGTERM),
                         [](const ::testing::TestParamInfo<int>& param) {
                           return std::string(param.param == SIGINT ? "Interrupt" : "Terminate");
                         });

TEST_F(ResultsFolder, WhatAKilledRunLeftHalfWrittenIsRemovedByTheNext) {
  ASSERT_EQ(run_vislab(call(1)).exit_code, 0);
  const fs::path half = fs::path(results()) / "cells" / (std::string(32, 'a') + ".json.123.4.tmp");
  write_file(half, "{\"anch");
  EXPECT_EQ(cells().size(), 6U) << "it is no cell";
  ASSERT_EQ(run_vislab(call(1)).exit_code, 0);
  EXPECT_FALSE(fs::exists(half));
}

TEST_F(ResultsFolder, AFullDiskIsSaidAndNothingIsLost) {
  ASSERT_EQ(run_vislab(call(1)).exit_code, 0);
  const auto before = files();
  // The cells grow with their rounds: some no longer fit.
  std::size_t largest = 0;
  for (const auto& [name, text] : before) largest = std::max(largest, text.size());
  const ProgramResult full = run_vislab_on_full_disk(call(6), largest + 100);
  EXPECT_EQ(full.exit_code, 2) << full.err;
  EXPECT_NE(full.err.find("cannot write"), std::string::npos) << full.err;
  EXPECT_NE(full.err.find("make room"), std::string::npos) << full.err;
  EXPECT_EQ(std::ranges::count(full.err, '\n'), 1) << full.err;
  expect_whole();
  for (const ResultCell& cell : cells()) {
    EXPECT_NE(cell.status, ResultCell::Status::failed) << "it is not the method's fault";
    EXPECT_GE(cell.rounds.size(), 1U);
  }
  ASSERT_EQ(run_vislab(call(6)).exit_code, 0) << "the same call goes on";
  for (const ResultCell& cell : cells()) {
    EXPECT_EQ(cell.status, ResultCell::Status::done);
    EXPECT_EQ(cell.rounds.size(), 6U);
  }
}

TEST_F(ResultsFolder, ADiskThatIsFullFromTheStartIsSaid) {
  const ProgramResult full = run_vislab_on_full_disk(call(1), 600);
  EXPECT_NE(full.exit_code, 0);
  EXPECT_NE(full.exit_code, -1) << "no crash";
  EXPECT_NE(full.err.find("cannot"), std::string::npos) << full.err;
  expect_whole();
  ASSERT_EQ(run_vislab(call(1)).exit_code, 0);
  EXPECT_EQ(cells().size(), 6U);
}

TEST_F(ResultsFolder, OutputThatCannotBeWrittenIsNoSuccess) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  const std::string program = std::string(VISLAB_BINARY_DIR) + "/vislab";
  const int status =
      std::system(("'" + program + "' list cullers > /dev/full 2>/dev/null").c_str());
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

TEST_F(ResultsFolder, TwoRunsAtOnceTakeTurnsAndBothFinish) {
  const std::vector<std::string> call_a = call(4);
  const std::vector<std::string> call_b = call(5);
  auto a = std::async(std::launch::async, [&] { return run_vislab(call_a); });
  auto b = std::async(std::launch::async, [&] { return run_vislab(call_b); });
  const ProgramResult of_a = a.get();
  const ProgramResult of_b = b.get();
  EXPECT_EQ(of_a.exit_code, 0) << of_a.err;
  EXPECT_EQ(of_b.exit_code, 0) << of_b.err;
  expect_whole();
  EXPECT_EQ(cells().size(), 6U);
  for (const ResultCell& cell : cells()) {
    EXPECT_EQ(cell.status, ResultCell::Status::done);
    EXPECT_EQ(cell.rounds.size(), 5U);
  }
}

TEST_F(ResultsFolder, ARunThatWaitsForAnotherSaysSo) {
  ASSERT_EQ(run_vislab(call(1)).exit_code, 0);
  std::future<ProgramResult> second;
  {
    const FolderLock lock(results(), [] { FAIL() << "nobody else has it"; });
    bool waited = false;
    second = std::async(std::launch::async, [&] { return run_vislab(call(1)); });
    waited = second.wait_for(std::chrono::milliseconds(700)) == std::future_status::timeout;
    EXPECT_TRUE(waited);
  }
  const ProgramResult result = second.get();
  EXPECT_EQ(result.exit_code, 0);
  expect_one_line(result.err, "another run writes into " + results());
}

TEST_F(ResultsFolder, CellsOfAnOlderVersionAreNamedKeptAndMeasuredAgain) {
  ASSERT_EQ(run_vislab(call(1)).exit_code, 0);
  auto present = files();
  std::map<std::string, std::string> older;
  for (const auto& [name, text] : present) {
    if (older.size() == 2) break;
    std::string old = text;
    old.replace(old.find("\"format\":2"), 10, "\"format\":1");
    // Other things were in it then.
    old.replace(old.find("\"culler\":"), 9, "\"method\":");
    older[name] = old;
    write_file(fs::path(results()) / "cells" / name, old);
  }
  for (const auto& [name, text] : older) present[name] = text;
  const ProgramResult read = run_vislab({"export", "csv", "--results", results()});
  EXPECT_EQ(read.exit_code, 0) << read.err;
  expect_one_line(read.err, "2 cells in " + results() + "/cells are of format 1");
  EXPECT_EQ(files(), present) << "reading changes nothing";

  const ProgramResult again = run_vislab(call(1));
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(cells().size(), 6U);
  for (const auto& [name, text] : older) {
    EXPECT_EQ(read_file(fs::path(results()) / "other_formats" / "1" / name), text);
  }
}

TEST_F(ResultsFolder, DamagedTruthAndVerdictsAreMadeAgain) {
  ASSERT_EQ(run_vislab(call(1)).exit_code, 0);
  const auto damage = [&](const char* part) {
    for (const auto& entry : fs::directory_iterator(fs::path(results()) / part)) {
      write_file(entry.path(), read_file(entry.path()).substr(0, 20));
    }
  };
  damage("truth");
  damage("verdicts");
  const ProgramResult again = run_vislab(call(1));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  const ProgramResult judged = run_vislab({"export", "json", "--results", results()});
  EXPECT_EQ(judged.out.find("\"false_px\":null"), std::string::npos) << judged.out;
}

TEST_F(ResultsFolder, ADamagedVisibleSetIsNamed) {
  ASSERT_EQ(run_vislab(call(1)).exit_code, 0);
  fs::path damaged;
  for (const auto& entry : fs::directory_iterator(fs::path(results()) / "sets")) {
    damaged = entry.path();
    write_file(entry.path(), "not a set");
  }
  fs::remove_all(fs::path(results()) / "verdicts");
  const ProgramResult again = run_vislab(call(1));
  EXPECT_EQ(again.exit_code, 2) << again.err;
  expect_one_line(again.err, ".set: not a visible set; delete it and run again with --force");
}

TEST_F(ResultsFolder, OneThatCannotBeReadIsAMessage) {
  fs::create_directories(results());
  fs::create_directory_symlink("cells", fs::path(results()) / "cells");  // leads to itself
  const ProgramResult loop = run_vislab({"export", "csv", "--results", results()});
  EXPECT_EQ(loop.exit_code, 2);
  expect_one_line(loop.err, results());
  const ProgramResult run = run_vislab(call(1));
  EXPECT_EQ(run.exit_code, 2);
  expect_one_line(run.err, results());
  if (::geteuid() == 0) GTEST_SKIP() << "the rest needs a user who may not read everything";
  fs::remove(fs::path(results()) / "cells");
  fs::create_directories(fs::path(results()) / "cells");
  fs::permissions(fs::path(results()) / "cells", fs::perms::none);
  const ProgramResult closed = run_vislab({"export", "csv", "--results", results()});
  fs::permissions(fs::path(results()) / "cells", fs::perms::owner_all);
  EXPECT_EQ(closed.exit_code, 2);
  expect_one_line(closed.err, results());
}

}  // namespace
}  // namespace vislab
