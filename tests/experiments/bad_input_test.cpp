// Wrong input gives one clear message and exit code 2, and leaves nothing half-written.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/experiments/program.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

constexpr const char* cube_off =
    "OFF\n8 12 0\n-1 -1 -1\n1 -1 -1\n-1 1 -1\n1 1 -1\n-1 -1 1\n1 -1 1\n-1 1 1\n1 1 1\n"
    "3 0 4 6\n3 0 6 2\n3 1 3 7\n3 1 7 5\n3 0 1 5\n3 0 5 4\n3 2 6 7\n3 2 7 3\n3 0 2 3\n3 0 3 1\n"
    "3 4 5 7\n3 4 7 6\n";

class BadInput : public ::testing::Test {
 protected:
  /// Runs one culler on a scene into a fresh results folder.
  ProgramResult run_on(const std::string& scene, const std::string& culler = "frustum.flat") {
    return run_vislab({"run", "--culler", culler, "--scene", scene, "--frames", "2", "--rounds",
                       "1", "--resolution", "32x32", "--results", results()});
  }
  std::string results() const { return folder_.path() / "results"; }

  /// Exit code 2, a single line that holds all the words, and no result.
  void expect_refused(const ProgramResult& result, const std::vector<std::string>& words) {
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    for (const std::string& word : words) {
      EXPECT_NE(result.err.find(word), std::string::npos) << "'" << word << "' in: " << result.err;
    }
    EXPECT_EQ(result.out, "");
    if (fs::exists(results())) {
      for (const auto& entry : fs::recursive_directory_iterator(results())) {
        EXPECT_TRUE(entry.is_directory()) << entry.path() << " was left behind";
      }
    }
  }

  TemporaryFolder folder_;
};

TEST_F(BadInput, AGoodMeshIsAccepted) {
  const ProgramResult result = run_on(folder_.write("cube.off", cube_off));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("frustum.flat"), std::string::npos);
}

TEST_F(BadInput, ATruncatedMeshIsRefused) {
  const std::string whole = cube_off;
  expect_refused(run_on(folder_.write("cut.off", whole.substr(0, whole.size() / 2))), {"cut.off"});
}

TEST_F(BadInput, ATruncatedPlyIsRefused) {
  expect_refused(run_on(folder_.write(
                     "cut.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                     "end_header\n0 0 0\n1 0 0\n")),
                 {"cut.ply"});
}

TEST_F(BadInput, ATruncatedQuakeWorldIsRefused) {
  expect_refused(run_on(folder_.write("cut.bsp", std::string("IBSP\x2e\0\0\0", 8) + "short")),
                 {"cut.bsp"});
}

TEST_F(BadInput, AFileThatIsNoQuakeWorldIsRefused) {
  expect_refused(run_on(folder_.write("no.bsp", std::string(5000, 'x'))), {"no.bsp"});
}

TEST_F(BadInput, AMissingFileIsRefused) {
  expect_refused(run_on((folder_.path() / "missing.off").string()), {"missing.off"});
}

TEST_F(BadInput, ADirectoryInsteadOfAFileIsRefused) {
  fs::create_directories(folder_.path() / "folder.off");
  expect_refused(run_on((folder_.path() / "folder.off").string()), {"folder.off"});
}

TEST_F(BadInput, AnEmptyFileIsRefused) {
  expect_refused(run_on(folder_.write("empty.off", "")), {"empty.off"});
}

TEST_F(BadInput, AVertexThatIsNotANumberIsRefused) {
  std::string mesh = cube_off;
  mesh.replace(mesh.find("1 1 1\n3"), 5, "1 nan 1");
  expect_refused(run_on(folder_.write("nan.off", mesh)), {"nan.off"});
}

TEST_F(BadInput, AnIndexOutOfRangeIsRefused) {
  std::string mesh = cube_off;
  mesh.replace(mesh.find("3 4 7 6"), 7, "3 4 7 66");
  expect_refused(run_on(folder_.write("index.off", mesh)), {"index.off"});
}

TEST_F(BadInput, ASceneWithoutATriangleIsRefused) {
  expect_refused(run_on(folder_.write("bare.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n")),
                 {"bare.off"});
}

TEST_F(BadInput, ASceneDescriptionWithAnUnknownKeyIsRefused) {
  expect_refused(run_on(folder_.write("scene.toml", "description = \"x\"\nmaterial = \"red\"\n")),
                 {"scene.toml", "material"});
}

TEST_F(BadInput, AnUnknownSceneNamesTheKnownOnes) {
  expect_refused(run_on("no_such_scene"), {"no_such_scene", "box_field_tiny"});
}

TEST_F(BadInput, AnUnknownCullerNamesTheKnownOnes) {
  expect_refused(run_on("box_field_tiny", "frustum.fast"), {"frustum.fast", "frustum.flat"});
}

TEST_F(BadInput, AnUnknownParameterNamesTheKnownOnes) {
  expect_refused(run_on("box_field_tiny", "frustum.flat[depth=3]"), {"depth", "test"});
}

TEST_F(BadInput, AParameterOutOfRangeNamesTheRange) {
  expect_refused(run_on("box_field_tiny", "occlusion.stop_and_wait[threshold_px=-1]"),
                 {"threshold_px", "-1", "0"});
}

TEST_F(BadInput, AMissingPathFileIsRefused) {
  expect_refused(run_vislab({"run", "--culler", "none", "--scene", "box_field_tiny", "--path",
                             "no_such_path", "--results", results()}),
                 {"no_such_path"});
}

TEST_F(BadInput, AMalformedMatrixIsRefusedWithItsLine) {
  const fs::path matrix = folder_.write("broken.toml", "rounds = 5\n[lists\nculler = 3\n");
  expect_refused(run_vislab({"run", matrix, "--results", results()}), {"broken.toml:2"});
}

TEST_F(BadInput, AMatrixWithAnUnknownKeyIsRefusedWithItsLine) {
  const fs::path matrix = folder_.write(
      "odd.toml", "round = 5\n[lists]\nculler = [\"none\"]\nscene = [\"box_field_tiny\"]\n");
  expect_refused(run_vislab({"run", matrix, "--results", results()}), {"odd.toml:1", "round"});
}

TEST_F(BadInput, AMatrixWithAnUnknownCullerIsRefused) {
  const fs::path matrix = folder_.write(
      "culler.toml", "[lists]\nculler = [\"frustum.fast\"]\nscene = [\"box_field_tiny\"]\n");
  expect_refused(run_vislab({"run", matrix, "--results", results()}),
                 {"culler.toml", "frustum.fast"});
}

TEST_F(BadInput, AnUnknownMatrixNamesTheKnownOnes) {
  expect_refused(run_vislab({"run", "no_such_matrix", "--results", results()}),
                 {"no_such_matrix", "default"});
}

TEST_F(BadInput, APlanOfUnknownScenesOrPathsNamesTheKnownOnes) {
  const auto matrix = [&](const std::string& scene, const std::string& path) {
    return folder_.write("plan.toml", "[lists]\nculler = [\"none\"]\nscene = [\"" + scene +
                                          "\"]\npath = [\"" + path +
                                          "\"]\nresolution = [\"32x32\"]\n");
  };
  EXPECT_EQ(run_vislab({"plan", matrix("box_field_tiny", "orbit")}).exit_code, 0);
  expect_refused(run_vislab({"plan", matrix("nowhere", "orbit")}), {"nowhere", "box_field_tiny"});
  expect_refused(run_vislab({"plan", matrix("box_field_tiny", "away")}), {"away", "orbit"});
}

TEST_F(BadInput, AResultsFolderThatIsAFileIsRefused) {
  const fs::path file = folder_.write("file", "");
  const ProgramResult result =
      run_vislab({"run", "--culler", "none", "--scene", "box_field_tiny", "--results", file});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("file"), std::string::npos) << result.err;
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
}

TEST_F(BadInput, AResultsFolderThatCannotBeMadeIsRefused) {
  // /proc takes no folders, not even from root.
  const ProgramResult result = run_vislab({"run", "--culler", "none", "--scene", "box_field_tiny",
                                           "--results", "/proc/vislab-results"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("/proc/vislab-results"), std::string::npos) << result.err;
}

TEST_F(BadInput, AReportWithoutResultsIsRefused) {
  expect_refused(run_vislab({"report", "--results", results(), "-o", folder_.path() / "report"}),
                 {"results"});
  EXPECT_FALSE(fs::exists(folder_.path() / "report" / "index.html"));
}

TEST_F(BadInput, AFrameBeyondThePathNamesTheLastOne) {
  const ProgramResult result =
      run_vislab({"show", "--culler", "none", "--scene", "box_field_tiny", "--frame", "100000",
                  "-o", folder_.path() / "picture.png"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("100000"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(folder_.path() / "picture.png"));
}

TEST_F(BadInput, AnUnwritablePictureIsRefused) {
  const ProgramResult result =
      run_vislab({"show", "--culler", "none", "--scene", "box_field_tiny", "--resolution", "32x32",
                  "-o", folder_.path() / "no" / "such" / "folder.png"});
  EXPECT_EQ(result.exit_code, 2) << result.err;
}

TEST_F(BadInput, AnUnknownDepthComplexityNamesTheKnownAndNeedsNoCuller) {
  const std::string picture = folder_.path() / "picture.png";
  const ProgramResult unknown = run_vislab(
      {"show", "--depth-complexity", "holes", "--scene", "box_field_tiny", "-o", picture});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("transparent"), std::string::npos) << unknown.err;
  const ProgramResult both = run_vislab({"show", "--depth-complexity", "rays", "--culler", "none",
                                         "--scene", "box_field_tiny", "-o", picture});
  EXPECT_EQ(both.exit_code, 2);
  const ProgramResult late = run_vislab({"show", "--depth-complexity", "rays", "--scene",
                                         "box_field_tiny", "--frame", "100000", "-o", picture});
  EXPECT_EQ(late.exit_code, 2);
  EXPECT_FALSE(fs::exists(picture));
}

TEST_F(BadInput, APictureOfQueriesNeedsAKnownKindAFrameAndACullerThatAsks) {
  const std::string picture = folder_.path() / "picture.png";
  const auto show = [&](const std::string& kind, const std::string& culler,
                        const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {
        "show",           "--queries",    kind,    "--culler", culler, "--scene",
        "box_field_tiny", "--resolution", "32x32", "-o",       picture};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = run_vislab(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    return result.err;
  };
  EXPECT_NE(show("stripes", "occlusion.batched", {}).find("strip, boxes, timeline"),
            std::string::npos);
  EXPECT_NE(show("strip", "frustum.flat", {}).find("never asks a device"), std::string::npos);
  EXPECT_NE(show("strip", "occlusion.batched", {"--frame", "100000"}).find("has frames 0 to"),
            std::string::npos);
  EXPECT_NE(show("timeline", "occlusion.batched", {"--draw", "osmesa"}).find("modelled device"),
            std::string::npos);
  EXPECT_NE(show("boxes", "occlusion.batched", {"--draw", "none"}).find("needs a device"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(picture));
}

TEST_F(BadInput, WrongCallsSayOneLineAndEndWithCodeTwo) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{},
        {"fly"},
        {"help", "fly"},
        {"--fly"},
        {"list", "cullers", "all"},
        {"describe"},
        {"run"},
        {"show", "--scene", "box_field_tiny", "--frame", "first", "-o", "x.png"},
        {"run", "--culler", "none"},
        {"list", "colours"},
        {"describe", "nothing.known"},
        {"export", "xml"},
        {"run", "smoke", "--shard", "3/2", "--results", results()},
        {"run", "smoke", "--filter", "fits nothing", "--results", results()},
        {"run", "smoke", "--frames", "3", "--results", results()},
        {"run", "--culler", "none", "--scene", "box_field_tiny", "--resolution", "0x5"},
        {"run", "--culler", "none", "--scene", "box_field_tiny", "--draw", "modelled[latency=1]"},
        {"run", "--culler", "none", "--scene", "box_field_tiny", "--draw", "vulkan"},
        {"describe", "modelled[preset=voodoo]"},
        {"check", "--culler", "frustum.fast"},
        {"compare", "none", "frustum.fast"}}) {
    SCOPED_TRACE(arguments.empty() ? "" : arguments.front());
    expect_refused(run_vislab(arguments), {"vislab: "});
  }
}

}  // namespace
}  // namespace vislab
