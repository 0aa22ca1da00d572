// A mended family gets another hash, and no other family does.
#include "experiments/context/sources.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>

#include "experiments/results/files.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

class SourceHashes : public ::testing::Test {
 protected:
  SourceHashes() {
    for (const char* file : {"common/geometry/plane.h", "common/judge/metrics.cpp",
                             "algorithms/frustum/flat.cpp", "algorithms/backface/polygon.cpp",
                             "algorithms/oracle/oracle.cpp", "algorithms/peers/bullet.cpp",
                             "algorithms/depth/hzb.cpp", "common/raster/depth_raster.cpp"}) {
      fs::create_directories((folder_.path() / file).parent_path());
      folder_.write(file, "int x;\n");
    }
  }

  /// Hashes by name, as the script writes them for the files as they are now.
  std::map<std::string, std::string> hashes() {
    const fs::path output = folder_.path() / "hashes.cpp";
    const std::string command =
        std::string(VISLAB_CMAKE) + " -D SOURCE_DIR=" + folder_.path().string() +
        " -D FAMILIES=frustum:algorithms/frustum,backface:algorithms/backface,oracle:algorithms/"
        "oracle,peer:algorithms/peers,depth:algorithms/depth -D "
        "TRUTH_FAMILIES=oracle -D OUTPUT=" +
        output.string() + " -P " VISLAB_SOURCE_DIR "/cmake/WriteSourceHashes.cmake";
    EXPECT_EQ(std::system(command.c_str()), 0);
    const std::string text = read_file(output);
    std::map<std::string, std::string> found;
    const std::regex entry("\\{\"(\\w+)\", \"([0-9a-f]{64})\"\\}|hash = \"([0-9a-f]{64})\"");
    for (std::sregex_iterator it(text.begin(), text.end(), entry), end; it != end; ++it) {
      found[(*it)[1].matched ? (*it)[1].str() : "judge"] =
          (*it)[2].matched ? (*it)[2].str() : (*it)[3].str();
    }
    EXPECT_EQ(found.size(), 6U);
    return found;
  }

  TemporaryFolder folder_;
};

TEST_F(SourceHashes, AMendedFamilyChangesAlone) {
  const auto before = hashes();
  folder_.write("algorithms/frustum/flat.cpp", "int y;\n");
  const auto after = hashes();
  EXPECT_NE(after.at("frustum"), before.at("frustum"));
  EXPECT_EQ(after.at("backface"), before.at("backface"));
  EXPECT_EQ(after.at("judge"), before.at("judge"));
}

TEST_F(SourceHashes, AFamilyIsKnownByItsFolder) {
  const auto before = hashes();
  folder_.write("algorithms/peers/bullet.cpp", "int y;\n");
  EXPECT_NE(hashes().at("peer"), before.at("peer"));
}

TEST_F(SourceHashes, ALowerLayerChangesEveryFamilyAndTheJudge) {
  const auto before = hashes();
  folder_.write("common/geometry/plane.h", "int y;\n");
  const auto after = hashes();
  for (const auto& [name, hash] : after) EXPECT_NE(hash, before.at(name)) << name;
  // Devices are of the lower layers, and the modelled one answers by the rasteriser.
  folder_.write("common/raster/depth_raster.cpp", "int y;\n");
  for (const auto& [name, hash] : hashes()) EXPECT_NE(hash, after.at(name)) << name;
}

TEST_F(SourceHashes, AMendedJudgeLeavesTheMethodsAlone) {
  const auto before = hashes();
  folder_.write("common/judge/metrics.cpp", "int y;\n");
  const auto after = hashes();
  EXPECT_NE(after.at("judge"), before.at("judge"));
  EXPECT_EQ(after.at("frustum"), before.at("frustum"));
  EXPECT_EQ(after.at("backface"), before.at("backface"));
  EXPECT_NE(after.at("oracle"), before.at("oracle")) << "its answers are the judge's";
}

TEST(ChainSourceHash, DependsOnTheFamiliesOfItsStages) {
  EXPECT_EQ(chain_source_hash("frustum.flat[test=vertex]"), chain_source_hash("frustum.flat"));
  EXPECT_NE(chain_source_hash("frustum.flat"), chain_source_hash("backface.polygon"));
  EXPECT_NE(chain_source_hash("frustum.flat"),
            chain_source_hash("frustum.flat > backface.polygon"));
}

}  // namespace
}  // namespace vislab
