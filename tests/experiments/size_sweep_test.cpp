#include "experiments/matrix/size_sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>

#include "algorithms/all_cullers.h"
#include "experiments/analysis/knees_file.h"
#include "experiments/matrix/size_coverage.h"
#include "tests/input_error.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

const fs::path repository = VISLAB_SOURCE_DIR;

const std::string head =
    "description = \"Trees get deeper\"\ndial = \"octree depth\"\nunit = \"levels\"\n"
    "cost = \"decision_us\"\nbecause = \"all keep the same\"\nframes = 3\ndraw = \"none\"\n";
const std::string cullers = "cullers = [\"frustum.octree[depth=${dial}]\"]\n";
const std::string dial_values = "values = [0, 2, 3, 4, 5, 6, 8]\n";
const std::string scenes =
    "[[scenes]]\nscene = \"plant\"\npath = \"plant_walk\"\n[[scenes]]\nscene = \"city\"\nframes = "
    "5\n";

class SizeSweepTest : public ::testing::Test {
 protected:
  SizeSweepTest() { register_all_cullers(registry_); }
  SizeSweep load(const std::string& text) {
    return load_size_sweep(folder_.write("test.toml", text), folder_.path(), registry_);
  }
  std::string refusal(const std::string& text) {
    return input_error([&] { load(text); });
  }

  Registry registry_;
  TemporaryFolder folder_;
};

TEST_F(SizeSweepTest, EverySceneIsABlockWithAllValuesAndAnchors) {
  const SizeSweep sweep = load(head + cullers + dial_values + scenes);
  ASSERT_EQ(sweep.blocks.size(), 2U);
  EXPECT_EQ(sweep.blocks[0].path, "plant_walk");
  EXPECT_EQ(sweep.blocks[0].frames, 3);
  EXPECT_EQ(sweep.blocks[1].frames, 5);
  EXPECT_EQ(sweep.blocks[1].device, "none");
  EXPECT_EQ(sweep.blocks[0].cullers.size(), 4U + 7U) << "none twice, two oracles, seven depths";
  ASSERT_EQ(sweep.methods.size(), 1U);
  EXPECT_EQ(sweep.methods[0].culler, "frustum.octree");
  EXPECT_EQ(sweep.methods[0].parameter, "depth");
  EXPECT_EQ(sweep.methods[0].chains[2], registry_.canonical("frustum.octree[depth=3]"));
  EXPECT_EQ(sweep.methods[0].chains[sweep.methods[0].default_value],
            registry_.canonical("frustum.octree"));
  EXPECT_EQ(sweep.setting(2), "3 levels");
}

TEST_F(SizeSweepTest, ValuesMayBeTexts) {
  const SizeSweep sweep = load(head + "cullers = [\"depth.masked[scale=${dial}]\"]\n" +
                               "values = [\"quarter\", \"half\", \"full\"]\n" + scenes);
  EXPECT_EQ(sweep.values, (std::vector<std::string>{"quarter", "half", "full"}));
}

TEST_F(SizeSweepTest, WhatIsWrongIsNamedWithFileAndLine) {
  const auto has = [&](const std::string& text, const std::string& part) {
    const std::string message = refusal(text);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  has(head + cullers + "values = [1, 2]\n" + scenes, "at least 3 numbers or texts");
  has(head + cullers + "values = [1, 2, 1]\n" + scenes, "each once");
  has(head + cullers + "values = [0, 1, 17]\n" + scenes, "0 to 16");
  has(head + cullers + "values = [0, 1, 2]\n" + scenes, "which is the default of depth");
  has(head + "cullers = [\"frustum.octree\"]\n" + dial_values + scenes, "must be one culler with");
  has(head + "cullers = [\"frustum.octree[depth=${dial}] > frustum.flat\"]\n" + dial_values +
          scenes,
      "must be one culler with");
  has(head + "cullers = [\"frustum.octree[depht=${dial}]\"]\n" + dial_values + scenes, "depht");
  has(head + cullers + dial_values + "[[scenes]]\nscene = \"plant\"\n", "at least 2 [[scenes]]");
  has(head + cullers + dial_values + "cots = 1\n" + scenes, "cots");
  has("cost = \"second\"\n" + cullers + dial_values + scenes, "description");
  has(head + cullers + dial_values + scenes + "[[notes]]\nculler = \"none\"\ntext = \"x\"\n",
      "cullers has no none");
}

TEST_F(SizeSweepTest, AllOfTheLabCanBeReadAndLookAtSeveralScenes) {
  const std::vector<SizeSweep> sweeps =
      load_size_sweeps(repository / "experiments" / "model_size", registry_);
  std::set<std::string> dials;
  for (const SizeSweep& sweep : sweeps) {
    dials.insert(sweep.dial);
    for (const Block& block : sweep.blocks) {
      const fs::path data = repository / "data";
      EXPECT_TRUE(fs::exists(data / "scenes" / (block.scene + ".toml"))) << block.scene;
      if (block.path.empty()) continue;
      EXPECT_TRUE(fs::exists(data / "paths" / (block.path + ".toml"))) << block.path;
    }
  }
  for (const char* dial :
       {"octree depth", "octree leaf size", "bounding volume", "cluster size", "normal classes",
        "sectors", "buffer size", "occluder triangles", "sigma", "query batch", "unit size"}) {
    EXPECT_TRUE(dials.contains(dial)) << dial << " has no sweep";
  }
}

TEST_F(SizeSweepTest, DefaultsAreTheKneesThatAreCommitted) {
  const std::vector<CommittedKnee> knees = read_knees(repository / "data" / "knees.toml");
  const std::vector<SizeSweep> sweeps =
      load_size_sweeps(repository / "experiments" / "model_size", registry_);
  std::size_t methods = 0;
  for (const SizeSweep& sweep : sweeps) methods += sweep.methods.size();
  EXPECT_EQ(knees.size(), methods) << "write them with: vislab knees --write data/knees.toml";
  for (const CommittedKnee& knee : knees) {
    const std::string what = knee.parameter + " of " + knee.culler;
    const auto sweep = std::ranges::find(sweeps, knee.sweep, &SizeSweep::name);
    ASSERT_NE(sweep, sweeps.end()) << what << ": no sweep " << knee.sweep;
    EXPECT_EQ(sweep->dial, knee.dial) << what;
    const auto& parameters = registry_.entry(knee.culler).info.parameters;
    const auto spec = std::ranges::find(parameters, knee.parameter, &ParameterSpec::name);
    ASSERT_NE(spec, parameters.end()) << what;
    // "1" of the file and "1.0" of a declaration are the same to the registry.
    const auto chain = [&](const std::string& value) {
      return registry_.canonical(knee.culler + "[" + knee.parameter + "=" + value + "]");
    };
    EXPECT_EQ(chain(knee.default_value), registry_.canonical(knee.culler))
        << what << " has another default than data/knees.toml says";
    EXPECT_EQ(chain(knee.default_value), knee.chain) << what << " was measured as another";
    const bool may_be = std::ranges::count(knee.may_be_knee, knee.default_value) == 1;
    EXPECT_EQ(may_be, knee.off_knee.empty())
        << what
        << (may_be ? " may be at its knee, and a reason says why it is not"
                   : " has a default that cannot be its knee, and no reason says why");
    EXPECT_EQ(std::ranges::count(knee.may_be_knee, knee.knee), 1) << what;
    EXPECT_GE(knee.scenes.size(), 2U) << what;
    for (const auto& [name, text] : knee.provenance) {
      EXPECT_FALSE(text.empty()) << what << " does not say its " << name;
    }
  }
}

TEST_F(SizeSweepTest, EverySizeOfAModelIsSweptOrHasAReason) {
  const std::vector<SizeSweep> sweeps =
      load_size_sweeps(repository / "experiments" / "model_size", registry_);
  const fs::path file = repository / "experiments" / "model_size" / "coverage" / "entries.toml";
  const SizeCoverage coverage = size_coverage(sweeps, registry_, file);
  EXPECT_GE(coverage.with_sweep, 20U);
  EXPECT_NE(coverage.text().find("leaf_size of frustum.bvh (by default"), std::string::npos)
      << coverage.text();
}

TEST_F(SizeSweepTest, ASizeWithoutSweepAndReasonIsNamedAsIsOneWithBoth) {
  const std::vector<SizeSweep> sweeps =
      load_size_sweeps(repository / "experiments" / "model_size", registry_);
  const auto refused = [&](const std::string& text) {
    return input_error(
        [&] { size_coverage(sweeps, registry_, folder_.write("entries.toml", text)); });
  };
  EXPECT_NE(refused("").find("area of detail.screen_size has no size sweep"), std::string::npos)
      << refused("");
  const std::string both = "[[without]]\ncullers = [\"frustum.octree\"]\nbecause = \"so\"\n";
  EXPECT_NE(refused(both + "parameter = \"depth\"\n").find("has a size sweep"), std::string::npos);
  EXPECT_NE(refused(both + "parameter = \"dept\"\n").find("there is no dept of"),
            std::string::npos);
  EXPECT_NE(refused(both).find("needs parameter, cullers and because"), std::string::npos);
}

// What was measured stands in cells; written down beside them it is soon that of another program.
TEST_F(SizeSweepTest, LimitsAndNotesHoldNoFiguresThatWereMeasured) {
  const std::regex figure("\\.[0-9]{2}|[0-9] ?%");
  for (const auto& [name, entry] : registry_.entries()) {
    EXPECT_FALSE(std::regex_search(entry.info.limits, figure)) << name << ": " << entry.info.limits;
  }
  for (const SizeSweep& sweep :
       load_size_sweeps(repository / "experiments" / "model_size", registry_)) {
    for (const SizeMethod& method : sweep.methods) {
      for (const std::string& text : {method.note, method.off_knee}) {
        EXPECT_FALSE(std::regex_search(text, figure)) << sweep.name << ": " << text;
      }
    }
  }
}

}  // namespace
}  // namespace vislab
