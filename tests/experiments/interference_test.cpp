// What may come between a verb and its files: a user who does not wait, a disk that is full under
// verbs that write, other runs into the same folder, files of older formats.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <future>
#include <map>

#include "experiments/results/files.h"
#include "experiments/results/store.h"
#include "tests/experiments/program.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

class Interference : public ::testing::Test {
 protected:
  std::string results() const { return folder_.path() / "results"; }
  std::string in_folder(const std::string& name) const { return folder_.path() / name; }

  /// One block; those with as many frames are the same.
  std::vector<std::string> call(const std::string& culler, int rounds = 1, int frames = 4,
                                const std::string& resolution = "64x64") const {
    const std::string matrix = folder_.write(
        culler + ".toml", "rounds = " + std::to_string(rounds) + "\n[lists]\nculler = [\"" +
                              culler + "\"]\nscene = [\"box_field_tiny\"]\n" + "resolution = [\"" +
                              resolution + "\"]\nframes = [" + std::to_string(frames) + "]\n");
    return {"run", matrix, "--results", results(), "--quiet", "--threads", "1"};
  }

  std::vector<ResultCell> cells() const { return ResultStore::open(results()).load_all(); }

  /// How many files are in a part of the results; 0 if there is no such part yet.
  std::size_t files_in(const char* part) const {
    std::error_code code;
    const fs::directory_iterator files(fs::path(results()) / part, code);
    return code ? 0 : static_cast<std::size_t>(std::distance(files, {}));
  }

  void expect_nothing_half_written() const {
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
    }
  }

  static void expect_one_line(const std::string& text, const std::string& word) {
    EXPECT_EQ(std::ranges::count(text, '\n'), 1) << text;
    EXPECT_NE(text.find(word), std::string::npos) << text;
  }

  TemporaryFolder folder_;
};

TEST_F(Interference, AnInterruptDoesNotWaitForTheRaysOfTheWholePath) {
  constexpr int frames = 3000;
  const ProgramResult stopped =
      signal_vislab(call("frustum.flat", 1, frames), SIGINT, [&] { return files_in("truth") > 0; });
  EXPECT_EQ(stopped.exit_code, 1) << stopped.err;
  expect_one_line(stopped.err, "stopped; the same call goes on from here");
  EXPECT_LT(files_in("truth"), static_cast<std::size_t>(frames));
  EXPECT_TRUE(cells().empty());
  expect_nothing_half_written();
}

TEST_F(Interference, ASecondInterruptDoesNotWaitForTheWorkUnderWay) {
  // The first one waits for the rays of the frame under way, here of a large one.
  const ProgramResult stopped = interrupt_vislab_twice(call("frustum.flat", 1, 2, "3072x3072"),
                                                       [&] { return files_in("truth") > 0; });
  EXPECT_EQ(stopped.exit_code, 1) << stopped.err;
  expect_one_line(stopped.err, "stopped; the same call goes on from here");
  EXPECT_EQ(files_in("truth"), 1U) << "it has waited";
  EXPECT_NO_THROW(cells());
  EXPECT_EQ(run_vislab(call("frustum.flat")).exit_code, 0) << "nothing is in the next one's way";
  expect_nothing_half_written();
}

TEST_F(Interference, APictureThatDoesNotFitLeavesTheOldOne) {
  const std::string picture = folder_.write("old.png", "the old picture");
  const ProgramResult full =
      run_vislab_on_full_disk({"show", "--culler", "frustum.flat", "--scene", "box_field_tiny",
                               "--resolution", "64x64", "-o", picture},
                              300);
  EXPECT_EQ(full.exit_code, 2) << full.err;
  expect_one_line(full.err, picture);
  EXPECT_EQ(read_file(picture), "the old picture");
  expect_nothing_half_written();
}

TEST_F(Interference, AReportThatDoesNotFitLeavesTheOldOne) {
  ASSERT_EQ(run_vislab(call("frustum.flat")).exit_code, 0);
  fs::create_directories(in_folder("report"));
  const std::string page = folder_.write("report/index.html", "the old page");
  const std::string print = folder_.write("report/report.pdf", "the old print");
  const ProgramResult full =
      run_vislab_on_full_disk({"report", "--results", results(), "-o", in_folder("report")}, 1000);
  EXPECT_EQ(full.exit_code, 2) << full.err;
  expect_one_line(full.err, "vislab: ");
  EXPECT_EQ(read_file(page), "the old page");
  EXPECT_EQ(read_file(print), "the old print");
  expect_nothing_half_written();
}

TEST_F(Interference, ATableThatDoesNotFitIsNoSuccess) {
  ASSERT_EQ(run_vislab(call("frustum.flat")).exit_code, 0);
  const ProgramResult full =
      run_vislab_on_full_disk({"export", "csv", "--results", results()}, 1000);
  EXPECT_EQ(full.exit_code, 1) << full.err;
  expect_one_line(full.err, "the output could not be written");
}

TEST_F(Interference, ABaselineThatDoesNotFitLeavesTheCommittedOne) {
  const fs::path committed = fs::path(VISLAB_SOURCE_DIR) / "tests" / "baseline.toml";
  const std::string before = read_file(committed);
  const ProgramResult run = run_vislab(
      {"run", "--culler", "frustum.flat", "--scene", "box_field_tiny", "--resolution", "128x128",
       "--frames", "10", "--rounds", "1", "--threads", "2", "--results", results(), "--quiet"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const ProgramResult full =
      run_vislab_on_full_disk({"baseline", "--write", "--results", results()}, 300);
  if (read_file(committed) != before) {
    write_file(committed, before);
    ADD_FAILURE() << "the committed file was changed; it is as before again";
  }
  EXPECT_EQ(full.exit_code, 2) << full.err;
  EXPECT_EQ(std::ranges::count(full.err, '\n'), 1) << full.err;
  const bool may_write = full.err.find("the baseline is written") == std::string::npos;
  if (!may_write) GTEST_SKIP() << "this build may not write it: " << full.err;
  EXPECT_NE(full.err.find("cannot write " + committed.string()), std::string::npos) << full.err;
}

TEST_F(Interference, KneesThatAreNotAllMeasuredLeaveTheOldFile) {
  ASSERT_EQ(run_vislab(call("frustum.flat")).exit_code, 0);
  const std::string file = folder_.write("knees.toml", "the old knees");
  const ProgramResult result = run_vislab({"knees", "--write", file, "--results", results()});
  EXPECT_EQ(result.exit_code, 2);
  expect_one_line(result.err, "vislab run model_size");
  EXPECT_EQ(read_file(file), "the old knees");
}

TEST_F(Interference, TwoMatricesAtOnceBothAddTheirCellsToOneBlock) {
  const std::vector<std::string> call_a = call("frustum.flat", 3);
  const std::vector<std::string> call_b = call("frustum.bvh", 3);
  auto a = std::async(std::launch::async, [&] { return run_vislab(call_a); });
  auto b = std::async(std::launch::async, [&] { return run_vislab(call_b); });
  const ProgramResult of_a = a.get();
  const ProgramResult of_b = b.get();
  EXPECT_EQ(of_a.exit_code, 0) << of_a.err;
  EXPECT_EQ(of_b.exit_code, 0) << of_b.err;
  expect_nothing_half_written();
  EXPECT_EQ(cells().size(), 6U) << "two and the block's four, each once";
  for (const ResultCell& cell : cells()) {
    EXPECT_EQ(cell.status, ResultCell::Status::done) << cell.culler;
    EXPECT_EQ(cell.rounds.size(), 3U) << cell.culler;
    if (!cell.key.chain.starts_with("frustum")) continue;
    const auto none = cell.anchors.find("none");
    ASSERT_NE(none, cell.anchors.end()) << cell.culler;
    ASSERT_EQ(none->second.size(), cell.rounds.size()) << cell.culler;
    for (std::size_t i = 0; i < cell.rounds.size(); ++i) {
      EXPECT_EQ(none->second[i].session, cell.rounds[i].session) << cell.culler;
    }
  }
}

TEST_F(Interference, AReportCanBeMadeWhileARunWrites) {
  ASSERT_EQ(run_vislab(call("frustum.flat")).exit_code, 0);
  const std::vector<std::string> more = call("frustum.bvh", 60, 12);
  auto run = std::async(std::launch::async, [&] { return run_vislab(more); });
  while (cells().size() < 8 &&
         run.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
  }
  const ProgramResult report =
      run_vislab({"report", "--results", results(), "-o", in_folder("report")});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_TRUE(read_file(in_folder("report/report.pdf")).starts_with("%PDF-"));
  const ProgramResult finished = run.get();
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  for (const ResultCell& cell : cells()) EXPECT_EQ(cell.status, ResultCell::Status::done);
}

TEST_F(Interference, TruthOfAnOlderFormatIsTracedAgain) {
  ASSERT_EQ(run_vislab(call("frustum.flat")).exit_code, 0);
  std::map<fs::path, std::string> present;
  for (const auto& entry : fs::directory_iterator(fs::path(results()) / "truth")) {
    std::string text = present[entry.path()] = read_file(entry.path());
    ASSERT_TRUE(text.starts_with("vltruth1"));
    text.replace(0, 8, "vltruth0");
    write_file(entry.path(), text);
  }
  ASSERT_EQ(present.size(), 4U);
  // Nothing has to be judged again, so the run has no use for it; who reads it says so or goes on.
  const ProgramResult report =
      run_vislab({"report", "--results", results(), "-o", in_folder("report")});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  fs::remove_all(fs::path(results()) / "verdicts");
  const ProgramResult again = run_vislab(call("frustum.flat"));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  for (const auto& [file, text] : present) EXPECT_EQ(read_file(file), text) << file;
  const ProgramResult judged = run_vislab({"export", "json", "--results", results()});
  EXPECT_EQ(judged.out.find("\"false_px\":null"), std::string::npos) << judged.out;
}

TEST_F(Interference, SetsOfAnotherFormatAreNamedAndMeasuredAgainOnceTheyAreGone) {
  ASSERT_EQ(run_vislab(call("frustum.flat")).exit_code, 0);
  // Read as runs of triangles, these bytes are another set than the one that the name stands for.
  for (const auto& entry : fs::directory_iterator(fs::path(results()) / "sets")) {
    write_file(entry.path(), "VISLABSET0" + read_file(entry.path()));
  }
  fs::remove_all(fs::path(results()) / "verdicts");
  const ProgramResult again = run_vislab(call("frustum.flat"));
  EXPECT_EQ(again.exit_code, 2) << again.err;
  expect_one_line(again.err, "delete it and run again with --force");
  fs::remove_all(fs::path(results()) / "sets");
  std::vector<std::string> forced = call("frustum.flat");
  forced.emplace_back("--force");
  const ProgramResult measured = run_vislab(forced);
  EXPECT_EQ(measured.exit_code, 0) << measured.err;
  const ProgramResult judged = run_vislab({"export", "json", "--results", results()});
  EXPECT_EQ(judged.out.find("\"false_px\":null"), std::string::npos) << judged.out;
}

}  // namespace
}  // namespace vislab
