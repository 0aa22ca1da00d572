#include "experiments/matrix/matrix.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "algorithms/all_cullers.h"
#include "common/scene/library.h"
#include "tests/input_error.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

class MatrixFile : public ::testing::Test {
 protected:
  MatrixFile() { register_all_cullers(registry_); }
  Matrix load(const std::string& text) {
    return load_matrix(folder_.write("test.toml", text), folder_.path(), registry_);
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

/// "a[x=1] > b" as {"a[x=1]", "b"}.
std::vector<std::string> stages_of(const std::string& chain) {
  constexpr std::string_view link = " > ";
  std::vector<std::string> stages;
  for (std::size_t at = 0; at < chain.size();) {
    const std::size_t end = std::min(chain.find(link, at), chain.size());
    stages.push_back(chain.substr(at, end - at));
    at = end + link.size();
  }
  return stages;
}

TEST_F(MatrixFile, ListsMultiply) {
  const Matrix matrix = load(
      "[lists]\nculler = [\"frustum.flat\", \"backface.polygon\"]\nscene = [\"a\", \"b\"]\n"
      "resolution = [\"64x32\", \"128x128\", \"5x7\"]\nframes = [3, 4]\n");
  ASSERT_EQ(matrix.blocks.size(), 2U * 3U * 2U);
  EXPECT_EQ(matrix.blocks.front().scene, "a");
  EXPECT_EQ(matrix.blocks.front().viewport, (Viewport{64, 32}));
  EXPECT_EQ(matrix.blocks.back().frames, 4);
}

TEST_F(MatrixFile, DevicesMultiplyToo) {
  const std::string lists = "[lists]\nculler = [\"none\"]\nscene = [\"a\"]\n";
  const Matrix matrix = load(lists +
                             "device = [\"osmesa\", \"modelled[latency_us=700]\"]\n[[adjust]]\n"
                             "device = \"modelled*\"\nrounds = 1\n");
  ASSERT_EQ(matrix.blocks.size(), 2U);
  EXPECT_EQ(matrix.blocks[0].device, "osmesa");
  EXPECT_EQ(matrix.blocks[0].rounds, 5);
  EXPECT_EQ(matrix.blocks[1].device, "modelled[preset=gpu,latency_us=700]");
  EXPECT_EQ(matrix.blocks[1].rounds, 1);
  EXPECT_EQ(load("draw = \"modelled[preset=modern]\"\n" + lists).blocks.at(0).device,
            "modelled[preset=modern]");
  EXPECT_NE(refusal(lists + "device = [\"modelled[latency=7]\"]\n").find("test.toml:4"),
            std::string::npos);
}

TEST_F(MatrixFile, OptionalScenesAreLeftOutWhereTheirPackageIsNotFetched) {
  const auto describe = [&](const char* name, const std::string& package) {
    return folder_.write(name, "description = \"A world\"\n[quake3]\npackage = \"" + package +
                                   "\"\nfile = \"a.bsp\"\n");
  };
  const std::string there = describe("there.toml", "fetched");
  const std::string absent = describe("absent.toml", "not_fetched");
  std::filesystem::create_directories(folder_.path() / "cache" / "fetched");
  folder_.write("cache/fetched/a.bsp", "a world");
  Matrix matrix =
      load("[lists]\nculler = [\"frustum.flat\"]\nscene = [\"a\"]\noptional_scene = [\"" + there +
           "\", \"" + absent + "\"]\n");
  ASSERT_EQ(matrix.blocks.size(), 3U);
  const std::vector<UnfetchedScene> unfetched =
      leave_out_unfetched(matrix, {folder_.path(), folder_.path() / "cache"});
  ASSERT_EQ(unfetched.size(), 1U);
  EXPECT_EQ(unfetched[0].scene, absent);
  EXPECT_EQ(unfetched[0].package, "not_fetched");
  ASSERT_EQ(matrix.blocks.size(), 2U);
  EXPECT_EQ(matrix.blocks[0].scene, "a");
  EXPECT_EQ(matrix.blocks[1].scene, there);
}

TEST_F(MatrixFile, EveryBlockHasNoneTwiceAndBothOraclesOnce) {
  const Matrix matrix =
      load("[lists]\nculler = [\"none\", \"oracle\", \"frustum.flat\"]\nscene = [\"a\"]\n");
  const Block& block = matrix.blocks.at(0);
  EXPECT_EQ(block.cullers.size(), 5U);
  EXPECT_EQ(count_of(block, registry_.canonical("none")), 2U);
  EXPECT_EQ(count_of(block, registry_.canonical("oracle[level=object]")), 1U);
  EXPECT_EQ(count_of(block, registry_.canonical("oracle[level=triangle]")), 1U);
}

TEST_F(MatrixFile, OptionalCullersMayBeAbsentButAreHeldToTheirParameters) {
  const Matrix matrix = load(
      "[lists]\nculler = [\"frustum.flat\"]\nscene = [\"a\"]\n"
      "optional_culler = [\"frustum.bvh\", \"peer.of_nobody[x=1]\"]\n");
  EXPECT_EQ(count_of(matrix.blocks.at(0), registry_.canonical("frustum.bvh")), 1U);
  EXPECT_EQ(matrix.blocks[0].cullers.size(), 6U);
  EXPECT_EQ(matrix.absent, std::vector<std::string>{"peer.of_nobody[x=1]"});
  EXPECT_NE(refusal("[lists]\nculler = [\"none\"]\nscene = [\"a\"]\n"
                    "optional_culler = [\"frustum.flat[test=cone]\"]\n")
                .find("cone"),
            std::string::npos);
}

TEST_F(MatrixFile, SpellingsOfOneChainAreOneCell) {
  const Matrix matrix = load(
      "[lists]\nculler = [\"frustum.flat\", \"frustum.flat[test=vertex]\", \" frustum.flat \"]\n"
      "scene = [\"a\"]\n");
  EXPECT_EQ(matrix.blocks.at(0).cullers.size(), 5U);
}

TEST_F(MatrixFile, ExcludeLeavesOutWhatFitsAllItsPatterns) {
  const Matrix matrix = load(
      "[lists]\nculler = [\"frustum.flat\", \"backface.polygon\"]\nscene = [\"hares_14\", "
      "\"city\"]\n"
      "[[exclude]]\nculler = \"backface.*\"\nscene = \"hares_*\"\n");
  ASSERT_EQ(matrix.blocks.size(), 2U);
  const std::string backface = registry_.canonical("backface.polygon");
  EXPECT_EQ(count_of(matrix.blocks[0], backface), 0U);
  EXPECT_EQ(count_of(matrix.blocks[1], backface), 1U);
}

TEST_F(MatrixFile, ScenesMayHavePathsOfTheirOwn) {
  const Matrix matrix = load(
      "[lists]\nculler = [\"frustum.flat\"]\nscene = [\"a\", \"hares_14\"]\n"
      "path = [\"p\", \"q\"]\n[[paths]]\nscene = \"hares_*\"\npath = [\"walk\"]\n");
  ASSERT_EQ(matrix.blocks.size(), 3U);
  EXPECT_EQ(matrix.blocks[1].path, "q");
  EXPECT_EQ(matrix.blocks[2].path, "walk");
}

TEST_F(MatrixFile, ScenesMayHaveCullersOfTheirOwn) {
  const std::string text =
      "[lists]\nscene = [\"a\", \"b\", \"c\"]\n"
      "[[cullers]]\nscene = \"a\"\nculler = [\"frustum.flat\"]\n"
      "[[cullers]]\nscene = \"*\"\nculler = [\"backface.polygon\"]\n"
      "optional_culler = [\"peer.of_nobody\"]\n"
      "[[exclude]]\nscene = \"c\"\nculler = \"backface.*\"\n";
  const Matrix matrix = load(text);
  const std::string frustum = registry_.canonical("frustum.flat");
  const std::string backface = registry_.canonical("backface.polygon");
  ASSERT_EQ(matrix.blocks.size(), 2U) << "c has no cell over";
  EXPECT_EQ(count_of(matrix.blocks[0], frustum), 1U);
  EXPECT_EQ(count_of(matrix.blocks[0], backface), 1U);
  EXPECT_EQ(count_of(matrix.blocks[1], frustum), 0U);
  EXPECT_EQ(count_of(matrix.blocks[1], backface), 1U);
  EXPECT_EQ(matrix.absent, std::vector<std::string>{"peer.of_nobody"});
  EXPECT_NE(refusal("[lists]\nscene = [\"a\"]\n[[cullers]]\nscene = \"a\"\n").find("test.toml:3"),
            std::string::npos);
}

TEST_F(MatrixFile, AdjustChangesTheBlocksThatFit) {
  const Matrix matrix = load(
      "rounds = 5\n[lists]\nculler = [\"frustum.flat\"]\nscene = [\"a\", \"b\"]\n"
      "[[adjust]]\nscene = \"b\"\nframes = 7\nrounds = 2\ntimeout_s = 9.5\n");
  EXPECT_EQ(matrix.blocks[0].frames, 60);
  EXPECT_EQ(matrix.blocks[0].rounds, 5);
  EXPECT_EQ(matrix.blocks[1].frames, 7);
  EXPECT_EQ(matrix.blocks[1].rounds, 2);
  EXPECT_DOUBLE_EQ(matrix.blocks[1].timeout_s, 9.5);
}

TEST_F(MatrixFile, ExtendsStartsFromTheOtherMatrix) {
  folder_.write("base.toml",
                "rounds = 3\nseed = 9\n[lists]\nculler = [\"frustum.flat\"]\nscene = [\"a\"]\n");
  const Matrix matrix = load("extends = \"base\"\nrounds = 4\n[lists]\nscene = [\"b\"]\n");
  EXPECT_EQ(matrix.blocks.at(0).scene, "b");
  EXPECT_EQ(matrix.blocks.at(0).rounds, 4);
  EXPECT_EQ(matrix.blocks.at(0).seed, 9U);
  EXPECT_EQ(count_of(matrix.blocks.at(0), registry_.canonical("frustum.flat")), 1U);
}

TEST_F(MatrixFile, MatricesThatExtendEachOtherAreRefused) {
  folder_.write("test.toml", "extends = \"test\"\n");
  EXPECT_NE(refusal("extends = \"test\"\n").find("circle"), std::string::npos);
}

TEST_F(MatrixFile, ErrorsNameFileLineAndWhatWouldBeRight) {
  const std::string lists = "[lists]\nculler = [\"none\"]\nscene = [\"a\"]\n";
  const auto expect = [&](const std::string& text, const std::vector<std::string>& words) {
    const std::string message = refusal(text);
    for (const std::string& word : words) {
      EXPECT_NE(message.find(word), std::string::npos) << "'" << word << "' in: " << message;
    }
  };
  expect("rounds = 0\n" + lists, {"test.toml:1", "rounds", "from 1"});
  expect("rounds = \"many\"\n" + lists, {"test.toml:1", "rounds"});
  expect("draw = \"vulkan\"\n" + lists, {"test.toml:1", "vulkan", "osmesa", "none"});
  expect("timeout_s = -1\n" + lists, {"test.toml:1", "timeout_s"});
  expect(lists + "colour = [1]\n", {"test.toml:4", "colour", "resolution"});
  expect(lists + "resolution = [\"512\"]\n", {"test.toml:4", "WIDTHxHEIGHT"});
  expect("[lists]\nculler = [\"none\"]\n", {"scene"});
  expect("[lists]\nculler = [\"frustum.flat[test=cone]\"]\nscene = [\"a\"]\n",
         {"cone", "vertex", "sphere"});
  expect(lists + "[exclude]\nscene = \"a\"\n", {"test.toml:4", "[[exclude]]"});
  expect(lists + "[[exclude]]\nscene = \"*\"\n", {"no cell"});
  expect(lists + "[[paths]]\nscene = \"a\"\n", {"test.toml:4", "[[paths]]", "list of paths"});
  expect("extends = \"nothing\"\n" + lists, {"nothing"});
}

TEST_F(MatrixFile, EveryMatrixOfTheRepositoryCanBeRead) {
  const std::filesystem::path folder =
      std::filesystem::path(VISLAB_SOURCE_DIR) / "experiments" / "matrices";
  const auto matrices = list_matrices(folder);
  EXPECT_GE(matrices.size(), 2U);
  for (const auto& [name, description] : matrices) {
    EXPECT_FALSE(description.empty()) << name;
    EXPECT_FALSE(load_matrix(name, folder, registry_).blocks.empty()) << name;
  }
}

TEST_F(MatrixFile, SmokeHasEveryCullerOfTheRegistry) {
  const Matrix smoke = load_matrix(
      "smoke", std::filesystem::path(VISLAB_SOURCE_DIR) / "experiments" / "matrices", registry_);
  std::set<std::string> seen;
  for (const Block& block : smoke.blocks) {
    for (const BlockCuller& culler : block.cullers) {
      for (const CullerSpec& stage : parse_chain(culler.chain)) seen.insert(stage.name);
    }
  }
  for (const auto& [name, entry] : registry_.entries()) {
    EXPECT_TRUE(seen.contains(name)) << name << " belongs into experiments/matrices/smoke.toml";
  }
}

TEST_F(MatrixFile, DefaultHasARightMethodOfEveryFamilyInEveryBlock) {
  const Matrix matrix = load_matrix(
      "default", std::filesystem::path(VISLAB_SOURCE_DIR) / "experiments" / "matrices", registry_);
  // The anchors stand everywhere; the skeleton is to be copied; peers may be absent. Leaving out
  // details is approximate by nature: there a method that is so is right.
  const std::set<std::string> not_asked{"none", "oracle", "skeleton", "peer"};
  const auto family_of = [](const std::string& name) { return name.substr(0, name.find('.')); };
  std::set<std::string> families;
  for (const auto& [name, entry] : registry_.entries()) families.insert(family_of(name));
  for (const std::string& family : not_asked) families.erase(family);
  ASSERT_GE(families.size(), 7U);
  for (const Block& block : matrix.blocks) {
    std::set<std::string> right;
    for (const BlockCuller& culler : block.cullers) {
      // Stage by stage: a chain promises no more than its weakest.
      for (const std::string& stage : stages_of(culler.chain)) {
        const Guarantee guarantee = registry_.make(stage)->info().guarantee;
        const std::string family = family_of(stage);
        if (guarantee == Guarantee::conservative || guarantee == Guarantee::image_exact ||
            (family == "detail" && guarantee == Guarantee::approximate)) {
          right.insert(family);
        }
      }
    }
    for (const std::string& family : families) {
      EXPECT_TRUE(right.contains(family)) << block.title() << " has no right method of " << family;
    }
    for (const char* chain : {"frustum.bvh > backface.cluster_tree", "portal.polygon > depth.hzb",
                              "frustum.bvh > occlusion.chcpp > backface.cone"}) {
      EXPECT_EQ(count_of(block, registry_.canonical(chain)), 1U) << block.title() << ": " << chain;
    }
  }
}

TEST(Matches, AStarStandsForAnyText) {
  EXPECT_TRUE(matches("*", ""));
  EXPECT_TRUE(matches("hares_*", "hares_14"));
  EXPECT_TRUE(matches("*.polygon*", "backface.polygon[open=cull]"));
  EXPECT_TRUE(matches("a*b*c", "axxbyyc"));
  EXPECT_FALSE(matches("a*b*c", "axxbyy"));
  EXPECT_FALSE(matches("hares", "hares_14"));
  EXPECT_FALSE(matches("", "a"));
}

}  // namespace
}  // namespace vislab
