// Runs of small matrices: resumed, repeated, forced, with one and two threads.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "experiments/results/files.h"
#include "experiments/results/store.h"
#include "tests/experiments/program.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

/// What must not differ between runs: sets, counters and truth of every frame, by chain, scene and
/// device.
std::map<std::string, std::string> answers(const fs::path& results) {
  std::map<std::string, std::string> all;
  for (const ResultCell& cell : ResultStore::open(results).load_all()) {
    std::string& text = all[cell.key.chain + " / " + cell.scene + " / " + cell.key.device + " / " +
                            std::to_string(cell.key.replicate)];
    for (const CellFrame& frame : cell.frames) {
      text += frame.set + " " + std::to_string(frame.submitted_triangles);
      for (const auto& [name, count] : frame.counters) {
        text += " " + name + "=" + std::to_string(count);
      }
      text += "\n";
    }
  }
  return all;
}

class Run : public ::testing::Test {
 protected:
  std::vector<std::string> call(const std::string& matrix, const fs::path& results,
                                const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"run", matrix, "--results", results, "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  fs::path results() const { return folder_.path() / "results"; }
  /// A matrix of one scene, so that a test takes a second.
  fs::path matrix(const std::string& more = "") const {
    return folder_.write("matrix.toml",
                         "rounds = 2\n" + more +
                             "[lists]\nculler = [\"frustum.flat\", \"backface.polygon\", "
                             "\"occlusion.stop_and_wait\"]\nscene = [\"box_field_tiny\"]\n"
                             "resolution = [\"64x64\"]\nframes = [5]\n");
  }
  std::vector<ResultCell> cells() const { return ResultStore::open(results()).load_all(); }

  TemporaryFolder folder_;
};

TEST_F(Run, MeasuresEveryCellWithItsAnchors) {
  ASSERT_EQ(run_vislab(call(matrix(), results())).exit_code, 0);
  std::set<std::string> cullers;
  for (const ResultCell& cell : cells()) {
    cullers.insert(cell.culler);
    EXPECT_EQ(cell.status, ResultCell::Status::done) << cell.culler;
    EXPECT_EQ(cell.rounds.size(), 2U);
    EXPECT_EQ(cell.frames.size(), 5U);
    EXPECT_EQ(cell.anchors.size(), 3U) << "none and both oracles, paired with every round";
    EXPECT_TRUE(cell.costs.has_value());
    EXPECT_EQ(cell.costs, cells().front().costs) << "measured once in a run";
    EXPECT_FALSE(cell.context.at("machine").empty());
    for (const CellFrame& frame : cell.frames) {
      EXPECT_EQ(ResultStore::open(results()).load_set(frame.set).triangle_count(),
                frame.submitted_triangles);
    }
  }
  EXPECT_EQ(cullers,
            (std::set<std::string>{"none", "none (again)", "oracle", "oracle[level=triangle]",
                                   "frustum.flat", "backface.polygon", "occlusion.stop_and_wait"}));
}

TEST_F(Run, OnAModelledDeviceEveryTimeRepeatsBitForBit) {
  const fs::path modelled =
      folder_.write("modelled.toml",
                    "rounds = 2\ndraw = \"modelled[latency_us=200]\"\n[lists]\n"
                    "culler = [\"frustum.bvh > occlusion.stop_and_wait\", \"occlusion.chcpp\"]\n"
                    "scene = [\"city_tiny\"]\nresolution = [\"64x64\"]\nframes = [4]\n");
  const fs::path again = folder_.path() / "again";
  ASSERT_EQ(run_vislab(call(modelled, results())).exit_code, 0);
  ASSERT_EQ(run_vislab(call(modelled, again)).exit_code, 0);
  std::size_t asking = 0;
  for (const ResultCell& cell : cells()) {
    EXPECT_EQ(cell.status, ResultCell::Status::done) << cell.culler << ": " << cell.reason;
    ASSERT_TRUE(cell.device_model.has_value());
    EXPECT_EQ(cell.device_model->latency_us, 200.0);
    const auto other = ResultStore::open(again).load_cell(cell.key.id());
    ASSERT_TRUE(other.has_value());
    ASSERT_EQ(cell.rounds.size(), 2U);
    EXPECT_EQ(cell.rounds[0].frame_ms, other->rounds[1].frame_ms) << cell.culler;
    EXPECT_EQ(cell.rounds[0].draw_ms, cell.rounds[0].frame_ms);
    for (std::size_t i = 0; i < cell.frames.size(); ++i) {
      EXPECT_EQ(cell.frames[i].set, other->frames[i].set);
      EXPECT_EQ(cell.frames[i].counters, other->frames[i].counters);
    }
    const auto& counters = cell.frames.back().counters;
    asking += counters.contains("state_changes") ? 1 : 0;
  }
  EXPECT_EQ(asking, 2U);
  EXPECT_EQ(answers(results()), answers(again));
}

TEST_F(Run, CellsOfABlockShareOneFitHoweverManyRunsTheyTake) {
  const auto fitted = [&](const std::string& cullers) {
    return call(
        folder_.write("fitted.toml",
                      "rounds = 1\ndraw = \"modelled[preset=osmesa]\"\n[lists]\nculler = [" +
                          cullers +
                          "]\nscene = [\"box_field_tiny\"]\nresolution = [\"64x64\"]\n"
                          "frames = [2]\n"),
        results());
  };
  ASSERT_EQ(run_vislab(fitted("\"frustum.flat\"")).exit_code, 0);
  // As if another fit had come out, but for one cell, which a run of another day has measured.
  const ResultStore store = ResultStore::open(results());
  const std::string other_day = "frustum.flat";
  for (ResultCell cell : store.load_all()) {
    cell.device_model->draw_us = cell.culler == other_day ? 99.0 : 77.0;
    store.save_cell(cell);
  }
  ASSERT_EQ(run_vislab(fitted("\"frustum.flat\", \"frustum.bvh\"")).exit_code, 0);
  std::set<std::string> cullers;
  for (const ResultCell& cell : store.load_all()) {
    cullers.insert(cell.culler);
    EXPECT_EQ(cell.device_model->draw_us, 77.0) << cell.culler;
  }
  EXPECT_TRUE(cullers.contains("frustum.bvh"));
}

TEST_F(Run, FindsWhatIsDone) {
  ASSERT_EQ(run_vislab(call(matrix(), results())).exit_code, 0);
  std::map<fs::path, std::string> before;
  for (const auto& entry : fs::directory_iterator(results() / "cells")) {
    before[entry.path()] = read_file(entry.path());
  }
  ASSERT_EQ(run_vislab(call(matrix(), results())).exit_code, 0);
  for (const auto& [file, content] : before) EXPECT_EQ(read_file(file), content);
}

TEST_F(Run, GoesOnAfterBeingKilledAndLosesNothing) {
  const fs::path killed = folder_.path() / "killed";
  const std::string slow = folder_.write(
      "slow.toml",
      "rounds = 12\n[lists]\nculler = [\"frustum.flat\", \"occlusion.stop_and_wait\"]\n"
      "scene = [\"box_field_tiny\"]\nresolution = [\"256x256\"]\nframes = [20]\n");
  // Long enough for some passes on any machine; if all is done before, the test still holds.
  kill_vislab(call(slow, killed), 1500);
  std::map<std::string, std::size_t> rounds;
  if (fs::is_directory(killed / "cells")) {
    for (const ResultCell& cell : ResultStore::open(killed).load_all()) {
      rounds[cell.key.id()] = cell.rounds.size();
    }
  }
  ASSERT_EQ(run_vislab(call(slow, killed)).exit_code, 0);
  for (const ResultCell& cell : ResultStore::open(killed).load_all()) {
    EXPECT_EQ(cell.status, ResultCell::Status::done);
    EXPECT_EQ(cell.rounds.size(), 12U);
    const std::set<std::string> sessions = [&] {
      std::set<std::string> names;
      for (const Round& round : cell.rounds) names.insert(round.session);
      return names;
    }();
    for (const auto& [chain, anchors] : cell.anchors) {
      EXPECT_EQ(anchors.size(), 12U) << "every round has its pairs: " << chain;
    }
    const std::size_t kept = rounds[cell.key.id()];
    if (kept > 0 && kept < 12) {
      EXPECT_EQ(sessions.size(), 2U) << "the rounds from before are kept";
    }
  }
  ASSERT_EQ(run_vislab(call(slow, results())).exit_code, 0);
  EXPECT_EQ(answers(killed), answers(results()));
}

TEST_F(Run, GivesTheAnswersThatAreCommittedAgainAndWithAnyNumberOfThreads) {
  const fs::path one = folder_.path() / "one";
  ASSERT_EQ(run_vislab(call("smoke", results(), {"--threads", "2"})).exit_code, 0);
  const ProgramResult committed = run_vislab({"baseline", "--results", results()});
  EXPECT_EQ(committed.exit_code, 0) << committed.out << committed.err;
  ASSERT_EQ(run_vislab(call("smoke", one, {"--threads", "1"})).exit_code, 0);
  EXPECT_EQ(answers(results()), answers(one));
#ifndef __SANITIZE_ADDRESS__  // the sanitizers see nothing new in the same run again
  const fs::path again = folder_.path() / "again";
  ASSERT_EQ(run_vislab(call("smoke", again, {"--threads", "2"})).exit_code, 0);
  EXPECT_EQ(answers(results()), answers(again));
#endif
}

TEST_F(Run, KeepsFailedCellsWithTheirReason) {
  const ProgramResult result = run_vislab(call(matrix("draw = \"none\"\n"), results()));
  EXPECT_EQ(result.exit_code, 1);
  int failed = 0;
  for (const ResultCell& cell : cells()) {
    if (cell.status != ResultCell::Status::failed) continue;
    ++failed;
    EXPECT_EQ(cell.culler, "occlusion.stop_and_wait");
    EXPECT_NE(cell.reason.find("device"), std::string::npos) << cell.reason;
  }
  EXPECT_EQ(failed, 1);
}

TEST_F(Run, TellsOfCellsThatOneSeesOutOfElsewhereThanThroughAPortal) {
  folder_.write("mesh.off", "OFF\n3 1 0\n-2 0.5 0\n2 0.5 0\n-2 0.5 1\n3 0 1 2\n");
  const std::string cells =
      "[mesh]\nfile = \"mesh.off\"\n[[cells]]\nboxes = [[-3, 0, -3], [0, 3, 3]]\n"
      "[[cells]]\nboxes = [[0, 0, -3], [3, 3, 3]]\n";
  const auto told = [&](const std::string& portals) {
    const fs::path scene = folder_.write("rooms.toml", cells + portals);
    const ProgramResult run = run_vislab({"run", "--culler", "portal.polygon", "--scene", scene,
                                          "--frames", "2", "--resolution", "32x32", "--rounds", "1",
                                          "--draw", "none", "--force", "--results", results()});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.err.find("elsewhere than through a portal") != std::string::npos;
  };
  EXPECT_TRUE(told(""));
  EXPECT_FALSE(
      told("[[portals]]\nfrom = 0\nto = 1\n"
           "corners = [[0, 0, -3], [0, 0, 3], [0, 3, 3], [0, 3, -3]]\n"));
}

TEST_F(Run, PutsDownATimeOutToItsCell) {
  const std::string heavy = folder_.write(
      "heavy.toml",
      "rounds = 1\ntimeout_s = 0.001\n[lists]\nculler = [\"occlusion.stop_and_wait\"]\n"
      "scene = [\"city_tiny\"]\nresolution = [\"512x512\"]\nframes = [60]\n");
  EXPECT_EQ(run_vislab(call(heavy, results())).exit_code, 1);
  bool timed_out = false;
  for (const ResultCell& cell : cells()) {
    timed_out |= cell.reason.find("timed out after 0.001 s") != std::string::npos;
  }
  EXPECT_TRUE(timed_out);
}

TEST_F(Run, FiltersAndShards) {
  ASSERT_EQ(run_vislab(call(matrix(), results(), {"--filter", "backface"})).exit_code, 0);
  for (const ResultCell& cell : cells()) EXPECT_NE(cell.culler, "frustum.flat");
  const fs::path shard = folder_.path() / "shard";
  ASSERT_EQ(run_vislab(call("smoke", shard, {"--shard", "2/4"})).exit_code, 0);
  for (const ResultCell& cell : ResultStore::open(shard).load_all()) {
    EXPECT_EQ(cell.scene, "city_tiny");
  }
}

TEST_F(Run, ForceMeasuresAgain) {
  ASSERT_EQ(run_vislab(call(matrix(), results())).exit_code, 0);
  const std::string before = cells().front().rounds.front().session;
  ASSERT_EQ(run_vislab(call(matrix(), results(), {"--force"})).exit_code, 0);
  const ResultCell cell = cells().front();
  EXPECT_EQ(cell.rounds.size(), 2U);
  EXPECT_NE(cell.rounds.front().session, before);
}

TEST_F(Run, ForceLeavesWhatIsThereUntilThereIsSomethingBetter) {
  ASSERT_EQ(run_vislab(call(matrix(), results())).exit_code, 0);
  const std::size_t count = cells().size();
  kill_vislab(call(matrix(), results(), {"--force"}), 120);
  EXPECT_EQ(cells().size(), count);
  for (const ResultCell& cell : cells()) EXPECT_FALSE(cell.rounds.empty()) << cell.culler;
}

TEST_F(Run, AnAnchorThatFailsBesideAnotherCellKeepsItsResult) {
  const std::string lists = "scene = [\"city_tiny\"]\nresolution = [\"512x512\"]\nframes = [60]\n";
  const std::string first =
      folder_.write("first.toml", "rounds = 1\n[lists]\nculler = [\"frustum.flat\"]\n" + lists);
  ASSERT_EQ(run_vislab(call(first, results())).exit_code, 0);
  // Now nothing has time enough: the new cell fails, what was done stays done.
  const std::string second = folder_.write(
      "second.toml",
      "rounds = 1\ntimeout_s = 0.001\n[lists]\nculler = [\"occlusion.stop_and_wait\"]\n" + lists);
  EXPECT_EQ(run_vislab(call(second, results())).exit_code, 1);
  for (const ResultCell& cell : cells()) {
    if (cell.culler == "occlusion.stop_and_wait") continue;
    EXPECT_EQ(cell.status, ResultCell::Status::done) << cell.culler;
    EXPECT_EQ(cell.rounds.size(), 1U);
  }
}

TEST_F(Run, FewerRoundsThanAreThereMakeACellDone) {
  const fs::path interrupted = folder_.path() / "interrupted";
  ASSERT_EQ(run_vislab(call(matrix(), interrupted)).exit_code, 0);
  const ResultStore store = ResultStore::open(interrupted);
  for (ResultCell cell : store.load_all()) {
    cell.status = ResultCell::Status::running;
    store.save_cell(cell);
  }
  ASSERT_EQ(run_vislab(call(matrix(), interrupted)).exit_code, 0);
  for (const ResultCell& cell : store.load_all()) {
    EXPECT_EQ(cell.status, ResultCell::Status::done) << cell.culler;
  }
}

TEST_F(Run, RoundsOfAnotherBuildAreNotMixedIn) {
  ASSERT_EQ(run_vislab(call(matrix(), results())).exit_code, 0);
  const ResultStore store = ResultStore::open(results());
  for (ResultCell cell : store.load_all()) {
    cell.context["build_type"] = "another";
    cell.rounds.resize(1);
    store.save_cell(cell);
  }
  ASSERT_EQ(run_vislab(call(matrix(), results())).exit_code, 0);
  for (const ResultCell& cell : store.load_all()) {
    EXPECT_EQ(cell.rounds.size(), 2U);
    EXPECT_EQ(cell.rounds[0].session, cell.rounds[1].session);
    EXPECT_NE(cell.context.at("build_type"), "another");
  }
}

TEST_F(Run, ACellOfMendedSourcesIsMeasuredAgainAndOthersAreNot) {
  ASSERT_EQ(run_vislab(call(matrix(), results())).exit_code, 0);
  // As if frustum.flat had been another when its cell was measured: the cell bears another name
  // then.
  const ResultStore store = ResultStore::open(results());
  std::string mended;
  std::map<std::string, std::string> others;
  for (ResultCell cell : store.load_all()) {
    const fs::path file = results() / "cells" / (cell.key.id() + ".json");
    if (cell.culler == "frustum.flat") {
      mended = cell.key.id();
      fs::remove(file);
      cell.key.sources = "sources before the mend";
      store.save_cell(cell);
    } else {
      others[file] = read_file(file);
    }
  }
  ASSERT_EQ(run_vislab(call(matrix(), results())).exit_code, 0);
  EXPECT_TRUE(store.load_cell(mended).has_value());
  for (const auto& [file, content] : others) EXPECT_EQ(read_file(file), content);
}

}  // namespace
}  // namespace vislab
