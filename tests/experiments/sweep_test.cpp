#include "experiments/matrix/sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "algorithms/all_cullers.h"
#include "experiments/analysis/coverage.h"
#include "experiments/results/files.h"
#include "tests/input_error.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

const std::string dial =
    "[dial]\nname = \"edge\"\nunit = \"m\"\nvalues = [0.5, 1, 2, 4, 8, 16, 32, 64]\n";
const std::string head =
    "description = \"Boxes grow\"\nfailure = \"F1\"\ncullers = [\"frustum.flat\"]\nframes = 3\n";
const std::string scene =
    "[scene.generator]\nkind = \"box_field\"\ncount = 20\nmax_half_size_m = \"${dial}\"\n";

class SweepFileTest : public ::testing::Test {
 protected:
  SweepFileTest() { register_all_cullers(registry_); }
  Sweep load(const std::string& text) {
    return load_sweep(folder_.write("test.toml", text), folder_.path(), folder_.path() / "results",
                      registry_);
  }
  std::string refusal(const std::string& text) {
    return input_error([&] { load(text); });
  }

  Registry registry_;
  TemporaryFolder folder_;
};

std::size_t count_of(const Block& block, const std::string& chain) {
  return static_cast<std::size_t>(std::ranges::count(block.cullers, chain, &BlockCuller::chain));
}

TEST_F(SweepFileTest, EveryValueOfTheDialIsABlockWithASceneOfItsOwn) {
  const Sweep sweep = load(head + dial + scene + "[path]\nkind = \"turn\"\neye = [0, 0, 0]\n");
  ASSERT_EQ(sweep.blocks.size(), 8U);
  EXPECT_EQ(sweep.block_of_value, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(sweep.blocks[3].title(), "test: edge = 4 m");
  EXPECT_EQ(sweep.blocks[3].frames, 3);
  EXPECT_NE(sweep.blocks[0].scene, sweep.blocks[1].scene);
  EXPECT_EQ(sweep.blocks[0].path, sweep.blocks[1].path) << "the path does not depend on the dial";
  EXPECT_EQ(sweep.files.size(), 9U);
  EXPECT_TRUE(std::filesystem::path(sweep.blocks[0].scene).filename() == "test-0.5.toml");
  EXPECT_EQ(count_of(sweep.blocks[0], "none"), 2U) << "with the control";
}

TEST_F(SweepFileTest, OptionalCullersThatTheBuildDoesNotHaveAreLeftOutAndNamed) {
  const std::string expected =
      "[[expect]]\nculler = \"peer.unheard_of*\"\nbreaks = \"never\"\nsource = \"s\"\n"
      "because = \"b\"\n";
  const Sweep sweep =
      load("optional_cullers = [\"peer.unheard_of[size=${dial}]\", \"frustum.bvh\"]\n" + head +
           dial + scene + expected);
  EXPECT_EQ(sweep.absent, (std::vector<std::string>{"peer.unheard_of[size=${dial}]"}));
  ASSERT_EQ(sweep.methods.size(), 2U);
  EXPECT_EQ(sweep.methods[1].culler, "frustum.bvh");
  EXPECT_EQ(count_of(sweep.blocks[0], registry_.canonical("frustum.bvh")), 1U);
  EXPECT_NE(refusal("optional_cullers = [\"frustum.bvh[unheard_of=1]\"]\n" + head + dial + scene)
                .find("unheard_of"),
            std::string::npos)
      << "what the build has must be right";
}

TEST_F(SweepFileTest, ASweepThatExtendsAnotherHoldsTheSameToAnotherLimit) {
  folder_.write("base.toml", "resolution = \"48x32\"\noptional_cullers = [\"frustum.bvh\"]\n" +
                                 head + dial + scene +
                                 "[limit]\nmetric = \"over\"\nat_most = 7\n"
                                 "[[expect]]\nculler = \"frustum.*\"\nbreaks = \"never\"\n"
                                 "source = \"s\"\nbecause = \"b\"\n");
  const std::string other = "description = \"Other\"\nfailure = \"F2\"\nextends = \"base\"\n";
  const std::string limit = "[limit]\nmetric = \"flicker\"\nat_most = 1\n";
  const Sweep base = load_sweep("base", folder_.path(), folder_.path() / "results", registry_);
  const Sweep sweep = load(other + limit);
  EXPECT_EQ(sweep.failure, "F2");
  EXPECT_EQ(sweep.description, "Other");
  EXPECT_EQ(sweep.limit.metric, "flicker");
  EXPECT_EQ(sweep.limit.at_most, 1.0);
  ASSERT_EQ(sweep.methods.size(), 2U);
  EXPECT_FALSE(sweep.methods[0].expectation) << "what is expected is not the base's";
  ASSERT_EQ(sweep.blocks.size(), base.blocks.size());
  EXPECT_EQ(sweep.blocks[3].viewport, (Viewport{48, 32}));
  EXPECT_EQ(sweep.blocks[3].frames, base.blocks[3].frames);
  EXPECT_EQ(load(other).limit.metric, "false_px") << "nor is the limit";

  const Sweep own =
      load(other + "cullers = [\"frustum.octree\"]\nresolution = \"16x16\"\n" + limit);
  ASSERT_EQ(own.methods.size(), 1U) << "the base's optional cullers belong to its list";
  EXPECT_EQ(own.methods[0].culler, "frustum.octree");
  EXPECT_EQ(own.blocks[0].viewport, (Viewport{16, 16}));

  EXPECT_NE(refusal("extends = \"bass\"\n" + head).find("base"), std::string::npos);
  folder_.write("second.toml", other + limit);
  const std::string twice = refusal("extends = \"second\"\n" + head);
  EXPECT_NE(twice.find("extends another"), std::string::npos) << twice;
  EXPECT_TRUE(is_sweep_file(folder_.path() / "second.toml")) << "without a dial of its own";
}

TEST_F(SweepFileTest, TheResolutionMayDependOnTheDial) {
  const std::string widths =
      "[dial]\nname = \"width\"\nunit = \"px\"\nvalues = [16, 17, 18, 19, 20, 21, 22, 23]\n";
  const std::string field = "[scene.generator]\nkind = \"box_field\"\ncount = 20\n";
  const Sweep sweep = load("resolution = \"${dial}x32\"\n" + head + widths + field);
  ASSERT_EQ(sweep.blocks.size(), 8U);
  EXPECT_EQ(sweep.blocks[3].viewport, (Viewport{19, 32}));
  EXPECT_EQ(sweep.blocks[0].scene, sweep.blocks[3].scene);
  EXPECT_NE(sweep.conditions[0], sweep.conditions[3]);
  EXPECT_NE(refusal("resolution = \"${dial}x32\"\n" + head + dial + field).find("WIDTHxHEIGHT"),
            std::string::npos)
      << "half a pixel";
}

TEST_F(SweepFileTest, TheDeviceMayDependOnTheDial) {
  const std::string field = "[scene.generator]\nkind = \"box_field\"\ncount = 20\n";
  const Sweep sweep = load("draw = \"modelled[latency_us=${dial}]\"\n" + head + dial + field);
  ASSERT_EQ(sweep.blocks.size(), 8U);
  EXPECT_EQ(sweep.blocks[3].device, "modelled[preset=gpu,latency_us=4]");
  EXPECT_EQ(sweep.blocks[0].scene, sweep.blocks[3].scene);
  EXPECT_NE(sweep.conditions[0], sweep.conditions[3]);
  EXPECT_NE(refusal("draw = \"modelled[pipeline_depth=${dial}]\"\n" + head + dial + field)
                .find("pipeline_depth"),
            std::string::npos)
      << "half a command";
}

TEST_F(SweepFileTest, TheSeedMayBeTheDial) {
  const std::string seeds =
      "[dial]\nname = \"seed\"\nunit = \"\"\nvalues = [1, 2, 3, 5, 8, 13, 21, 34]\n";
  const std::string field = "[scene.generator]\nkind = \"box_field\"\ncount = 20\n";
  const Sweep sweep = load("seed = \"${dial}\"\n" + head + seeds + field);
  ASSERT_EQ(sweep.blocks.size(), 8U);
  EXPECT_EQ(sweep.blocks[4].seed, 8U);
  EXPECT_EQ(sweep.blocks[0].scene, sweep.blocks[4].scene);
  EXPECT_NE(sweep.conditions[0], sweep.conditions[4]);
  EXPECT_NE(refusal("seed = \"${dial}\"\n" + head + dial + field).find("whole values"),
            std::string::npos)
      << "half a seed";
}

TEST_F(SweepFileTest, AGapAloneInItsQuotesBecomesTheNumberAsItWasWritten) {
  const Sweep sweep = load(head + dial + scene);
  const auto text_of = [&](std::size_t value) {
    const auto file = std::ranges::find(
        sweep.files, std::filesystem::path(sweep.blocks[value].scene), &SweepFile::file);
    return file->text;
  };
  EXPECT_NE(text_of(0).find("max_half_size_m = 0.5"), std::string::npos) << text_of(0);
  EXPECT_NE(text_of(1).find("max_half_size_m = 1\n"), std::string::npos) << text_of(1);
  EXPECT_NE(text_of(0).find("kind = 'box_field'"), std::string::npos) << text_of(0);
  EXPECT_NE(text_of(0).find("description = 'Boxes grow'"), std::string::npos) << text_of(0);
}

TEST_F(SweepFileTest, AGapInACullerIsFilledAtEveryValueAndOneSceneServesAll) {
  const Sweep sweep = load(
      "description = \"d\"\nfailure = \"F17\"\n"
      "cullers = [\"frustum.flat\", \"frustum.octree[depth=${dial}]\"]\n"
      "[dial]\nname = \"depth\"\nvalues = [1, 2, 3, 4, 5, 6, 7, 8]\n"
      "[scene.generator]\nkind = \"box_field\"\ncount = 20\n");
  ASSERT_EQ(sweep.blocks.size(), 1U);
  EXPECT_EQ(sweep.files.size(), 1U);
  EXPECT_EQ(sweep.methods[1].culler, "frustum.octree[depth=<depth>]");
  EXPECT_EQ(sweep.methods[1].chains[4], registry_.canonical("frustum.octree[depth=5]"));
  EXPECT_EQ(count_of(sweep.blocks[0], registry_.canonical("frustum.octree[depth=5]")), 1U);
  EXPECT_EQ(count_of(sweep.blocks[0], registry_.canonical("frustum.flat")), 1U);
  EXPECT_EQ(sweep.blocks[0].title(), "test: several values of depth");
}

TEST_F(SweepFileTest, FilesAreWrittenOnceAndAlikeEveryTime) {
  const Sweep sweep = load(head + dial + scene);
  write_sweep_files(sweep);
  const std::filesystem::path file = sweep.files.front().file;
  EXPECT_EQ(read_file(file), sweep.files.front().text);
  const auto before = std::filesystem::last_write_time(file);
  write_sweep_files(load(head + dial + scene));
  EXPECT_EQ(std::filesystem::last_write_time(file), before);
  EXPECT_EQ(file.parent_path(), folder_.path() / "results" / "stress" / "test");
}

TEST_F(SweepFileTest, TheFirstExpectationThatFitsACullerCounts) {
  const Sweep sweep = load(
      "description = \"d\"\nfailure = \"F1\"\n"
      "cullers = [\"frustum.flat\", \"frustum.flat[test=sphere]\", \"backface.polygon\"]\n" +
      dial + scene +
      "[[expect]]\nculler = \"frustum.flat\"\nbreaks = \"never\"\nsource = \"s\"\nbecause = \"b\"\n"
      "[[expect]]\nculler = \"frustum.*\"\nbreaks = [16, 4]\nsource = \"t\"\nbecause = \"c\"\n");
  ASSERT_TRUE(sweep.methods[0].expectation && sweep.methods[1].expectation);
  EXPECT_TRUE(sweep.methods[0].expectation->never);
  EXPECT_FALSE(sweep.methods[1].expectation->never);
  EXPECT_EQ(sweep.methods[1].expectation->low, 4.0);
  EXPECT_EQ(sweep.methods[1].expectation->high, 16.0);
  EXPECT_FALSE(sweep.methods[2].expectation);
}

TEST_F(SweepFileTest, AnExpectationThatEarlierOnesLeaveNothingIsRefused) {
  const std::string expect = "[[expect]]\nbreaks = \"never\"\nsource = \"s\"\nbecause = \"b\"\n";
  const std::string text =
      head + dial + scene + expect + "culler = \"*\"\n" + expect + "culler = \"frustum.*\"\n";
  EXPECT_NE(refusal(text).find("patterns before it fit all"), std::string::npos) << refusal(text);
}

TEST_F(SweepFileTest, ErrorsAreOneLineThatNamesFilePlaceAndWhatWouldBeRight) {
  const auto expect = [&](const std::string& text, const std::vector<std::string>& words) {
    const std::string message = refusal(text);
    EXPECT_FALSE(message.empty());
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const std::string& word : words) {
      EXPECT_NE(message.find(word), std::string::npos) << "'" << word << "' in: " << message;
    }
  };
  const auto with_dial = [&](const std::string& values) {
    return head + "[dial]\nname = \"edge\"\nvalues = " + values + "\n" + scene;
  };
  const std::string good = head + dial + scene;
  ASSERT_NO_THROW(load(good));
  expect(with_dial("[1, 2, 3]"), {"test.toml:7", "at least 8"});
  expect(with_dial("[1, 2, 3, 4, 5, 6, 7, 7]"), {"test.toml:7", "order"});
  expect(with_dial("[1, 2, 3, 4, 5, 6, 7, 6]"), {"order"});
  expect(with_dial("[1, 2, 3, 4, 5, 6, 7, nan]"), {"finite"});
  expect(with_dial("[1, 2, 3, 4, 5, 6, 7, \"8\"]"), {"finite numbers"});
  expect(head + scene, {"test.toml", "[dial]", "missing"});
  expect(head + dial, {"test.toml", "[scene]", "missing"});
  expect("failure = \"F1\"\n", {"description", "missing"});
  expect("colour = 1\n" + good, {"test.toml:1", "colour", "resolution"});
  expect("resolution = \"big\"\n" + good, {"test.toml:1", "WIDTHxHEIGHT"});
  expect("rounds = 0\n" + good, {"test.toml:1", "rounds"});
  expect("description = \"d\"\nfailure = \"F\"\ncullers = [\"frustum.octree[depth=${dial}]\"]\n" +
             dial + scene,
         {"test.toml:3", "depth"});
  expect(good + "[limit]\nmetric = \"recall\"\n", {"recall", "false_px", "at_least"});
  expect(good + "[limit]\nmetric = \"over\"\nat_least = 1\n", {"over", "recall", "higher"});
  expect(good + "[limit]\nat_least = 1\n", {"test.toml", "at_least", "metric"});
  expect(good + "[limit]\ncounter = \"plane_tests\"\nat_least = 1\n", {"at_least", "metric"});
  EXPECT_EQ(load(good + "[limit]\nmetric = \"recall\"\nat_least = 0.5\n").limit.at_least, 0.5);
  expect(good + "[limit]\nmetric = \"over\"\ncounter = \"plane_tests\"\n", {"not both"});
  expect(good + "[limit]\nat_most = 1\nat_most_ratio = 2\n", {"one of at_most"});
  expect(good + "[limit]\nmetric = \"recall\"\nat_least = 1\nat_most = 2\n", {"one of at_most"});
  expect(good + "[limit]\ncounter = \"plane_tests\"\n", {"at_most"});
  const std::string why = "source = \"s\"\nbecause = \"b\"\n";
  expect(good + "[[expect]]\nculler = \"frustum.*\"\nbreaks = \"soon\"\n" + why, {"never"});
  expect(good + "[[expect]]\nculler = \"frustum.*\"\nbreaks = [100, 200]\n" + why,
         {"no value of the dial"});
  expect(good + "[[expect]]\nculler = \"portal.*\"\nbreaks = \"never\"\n" + why,
         {"portal.*", "frustum.flat"});
  expect(good + "[[expect]]\nculler = \"frustum.*\"\nbreaks = \"never\"\n", {"source"});
}

TEST_F(SweepFileTest, EverySweepOfTheRepositoryCanBeReadAndSaysWhatItExpects) {
  const std::filesystem::path folder =
      std::filesystem::path(VISLAB_SOURCE_DIR) / "experiments" / "stress";
  const std::vector<Sweep> sweeps = load_sweeps(folder, folder_.path(), registry_);
  EXPECT_FALSE(sweeps.empty());
  for (const Sweep& sweep : sweeps) {
    EXPECT_FALSE(sweep.description.empty()) << sweep.name;
    EXPECT_TRUE(std::ranges::any_of(sweep.methods, [](const SweepMethod& method) {
      return method.expectation.has_value();
    })) << sweep.name;
  }
}

TEST_F(SweepFileTest, EveryCullerOfTheRegistryStandsInASweepOrHasAReason) {
  const std::filesystem::path folder =
      std::filesystem::path(VISLAB_SOURCE_DIR) / "experiments" / "stress";
  const std::vector<Sweep> sweeps = load_sweeps(folder, folder_.path(), registry_);
  std::set<std::string> seen;
  for (const auto& [name, because] :
       atlas_coverage(sweeps, folder / "coverage" / "entries.toml").cullers_without) {
    seen.insert(name);
    EXPECT_NO_THROW(registry_.make(name)) << name << " has a reason and is no culler";
  }
  for (const Sweep& sweep : sweeps) {
    for (const SweepMethod& method : sweep.methods) {
      for (const std::string& chain : method.chains) {
        for (const CullerSpec& stage : parse_chain(chain)) seen.insert(stage.name);
      }
    }
  }
  for (const auto& [name, entry] : registry_.entries()) {
    EXPECT_TRUE(seen.contains(name) || name == "oracle")
        << name << " belongs into a sweep of experiments/stress or, with a reason, into its "
        << "coverage/entries.toml (the oracle stands in every block)";
  }
}

TEST_F(SweepFileTest, FiguresAreMeasuredAndNotWrittenIntoTheRepositorysFiles) {
  const std::vector<Sweep> sweeps =
      load_sweeps(std::filesystem::path(VISLAB_SOURCE_DIR) / "experiments" / "stress",
                  folder_.path(), registry_);
  for (const Sweep& sweep : sweeps) {
    for (const SweepMethod& method : sweep.methods) {
      if (!method.expectation) continue;
      EXPECT_EQ(method.expectation->because.find("measured"), std::string::npos)
          << sweep.name << ": because says what follows, before anything is measured";
      EXPECT_EQ(method.expectation->hindsight.find_first_of("0123456789"), std::string::npos)
          << sweep.name << ": the report has the figures of its own cells";
    }
  }
}

}  // namespace
}  // namespace vislab
