#include "experiments/show/stored_depth_complexity.h"

#include <gtest/gtest.h>

#include "common/scene/error.h"
#include "experiments/results/files.h"
#include "experiments/results/store.h"
#include "tests/scene/repository_data.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;
using test::repository_data;

/// A block with one cell on a small scene, in a results folder.
class StoredDepthComplexity : public testing::Test {
 protected:
  StoredDepthComplexity() {
    const LoadedScene loaded = load_scene("box_field_tiny", repository_data());
    block_.scene = "box_field_tiny";
    block_.viewport = {32, 24};
    block_.frames = 3;
    block_.scene_hash = loaded.scene.content_hash();
    block_.path_hash = load_path(loaded.default_path, loaded.scene, block_.viewport, block_.frames,
                                 repository_data())
                           .content_hash();
    ResultCell cell;
    cell.key.chain = "none";
    cell.key.scene_hash = block_.scene_hash;
    cell.key.path_hash = block_.path_hash;
    cell.key.viewport = block_.viewport;
    cell.scene_source = "box_field_tiny";
    ResultStore::create(results()).save_cell(cell);
    block_.cells.emplace_back();
    block_.cells.front().id = cell.key.id();
  }

  fs::path results() const { return temporary_.path() / "results"; }
  fs::path kept() const { return results() / "depths" / (block_.cells.front().id + ".json"); }

  double mean_of_rays(const BlockSummary& block) const {
    StoredScenes scenes(results(), repository_data());
    return stored_depth_complexity(results(), scenes, block, {})[0].mean;
  }

  TemporaryFolder temporary_;
  BlockSummary block_;
};

TEST_F(StoredDepthComplexity, IsCountedOnce) {
  const double mean = mean_of_rays(block_);
  EXPECT_GT(mean, 0.0);
  ASSERT_TRUE(fs::exists(kept()));
  BlockSummary changed = block_;
  changed.scene_hash = "of another scene";
  EXPECT_EQ(mean_of_rays(changed), mean) << "the scene is not loaded again";
}

TEST_F(StoredDepthComplexity, IsCountedAgainWhereWhatWasKeptIsDamagedOrOfAnotherJudge) {
  const double mean = mean_of_rays(block_);
  const std::string whole = read_file(kept());
  for (const std::string& other : {whole.substr(0, whole.size() / 2), std::string("{}"),
                                   std::string(R"({"judge":"older","definitions":[]})")}) {
    write_file(kept(), other);
    EXPECT_EQ(mean_of_rays(block_), mean);
    EXPECT_EQ(read_file(kept()), whole);
  }
}

TEST_F(StoredDepthComplexity, OfASceneThatHasChangedIsRefused) {
  block_.scene_hash = "of another scene";
  EXPECT_THROW(mean_of_rays(block_), InputError);
}

}  // namespace
}  // namespace vislab
