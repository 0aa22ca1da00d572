#include "experiments/verbs/missing_cells.h"

#include <gtest/gtest.h>

#include "algorithms/all_cullers.h"

namespace vislab {
namespace {

class MissingCells : public ::testing::Test {
 protected:
  MissingCells() {
    register_all_cullers(registry_);
    matrix_.name = "made_up";
    Block block;
    block.scene = "one_scene";
    block.viewport = {64, 64};
    block.frames = 2;
    block.cullers = with_anchors(
        {registry_.canonical("frustum.flat"), registry_.canonical("frustum.bvh[leaf_size=2]")},
        registry_);
    matrix_.blocks = {block, block};
    matrix_.blocks[1].scene = "other_scene";
  }

  /// Everything that the matrix plans.
  std::vector<ResultCell> everything() const {
    std::vector<ResultCell> cells;
    for (const Block& block : matrix_.blocks) {
      for (const BlockCuller& culler : block.cullers) {
        ResultCell cell;
        cell.key.chain = culler.chain;
        cell.key.replicate = culler.replicate;
        cell.key.viewport = block.viewport;
        cell.key.scene_hash = block.scene;
        cell.scene_source = block.scene;
        cell.frames.resize(2);
        cells.push_back(cell);
      }
    }
    return cells;
  }

  PlannedGaps gaps(const std::vector<ResultCell>& cells,
                   const std::set<std::string>& run = {"made_up"}) const {
    std::vector<const ResultCell*> pointers;
    for (const ResultCell& cell : cells) pointers.push_back(&cell);
    return find_planned_gaps({matrix_}, run, pointers, registry_, paths_);
  }

  Registry registry_;
  Matrix matrix_;
  OwnPaths paths_{std::map<std::string, std::string>{{"other_scene", "own_walk"}}};
};

TEST_F(MissingCells, APathThatIsTheScenesOwnMayBeNamedOrNot) {
  std::vector<ResultCell> cells = everything();
  for (ResultCell& cell : cells) cell.path_source = "own_walk";
  EXPECT_EQ(gaps(cells).blocks.size(), 1U) << "own_walk is the path of other_scene only";
  matrix_.blocks[1].path = "own_walk";
  EXPECT_TRUE(gaps(everything()).blocks.empty());
}

TEST_F(MissingCells, NothingIsMissingWhereAllIsThere) {
  const PlannedGaps found = gaps(everything());
  EXPECT_TRUE(found.of_block_with.empty());
  EXPECT_TRUE(found.blocks.empty());
}

TEST_F(MissingCells, ADeletedCellIsAGapOfItsBlock) {
  std::vector<ResultCell> cells = everything();
  const std::string chain = registry_.canonical("frustum.bvh[leaf_size=2]");
  std::erase_if(cells, [&](const ResultCell& cell) {
    return cell.key.chain == chain && cell.scene_source == "one_scene";
  });
  const PlannedGaps found = gaps(cells);
  EXPECT_TRUE(found.blocks.empty());
  const auto of_block = found.of_block_with.find(cells.front().key.id());
  ASSERT_NE(of_block, found.of_block_with.end());
  ASSERT_EQ(of_block->second.size(), 1U);
  EXPECT_EQ(of_block->second[0].name, "frustum.bvh[leaf_size=2]");
  EXPECT_NE(of_block->second[0].reason.find("vislab run made_up"), std::string::npos);
  EXPECT_FALSE(found.of_block_with.contains(cells.back().key.id()));  // of the other scene
}

TEST_F(MissingCells, ADeletedControlIsAGapOfItsBlock) {
  std::vector<ResultCell> cells = everything();
  std::erase_if(cells, [](const ResultCell& cell) {
    return cell.key.replicate > 0 && cell.scene_source == "one_scene";
  });
  const PlannedGaps found = gaps(cells);
  const auto of_block = found.of_block_with.find(cells.front().key.id());
  ASSERT_NE(of_block, found.of_block_with.end());
  ASSERT_EQ(of_block->second.size(), 1U);
  EXPECT_EQ(of_block->second[0].name, "none (again)");
}

TEST_F(MissingCells, ABlockThatIsGoneIsNamed) {
  std::vector<ResultCell> cells = everything();
  matrix_.blocks.push_back(matrix_.blocks[0]);
  matrix_.blocks[2].scene = "third_scene";
  const PlannedGaps found = gaps(cells);
  ASSERT_EQ(found.blocks.size(), 1U);
  EXPECT_NE(found.blocks[0].name.find("third_scene"), std::string::npos);
}

TEST_F(MissingCells, OfAMatrixThatWasNotRunNothingIsMissing) {
  std::vector<ResultCell> cells = everything();
  cells.pop_back();  // the others may be of another matrix
  const PlannedGaps found = gaps(cells, {"another"});
  EXPECT_TRUE(found.of_block_with.empty());
  EXPECT_TRUE(found.blocks.empty());
}

TEST_F(MissingCells, OfAMatrixThatWasRunAllMayBeMissing) { EXPECT_EQ(gaps({}).blocks.size(), 2U); }

TEST_F(MissingCells, HowMuchOfAMatrixIsThereIsSaidHoweverLittleItIs) {
  std::vector<ResultCell> cells = everything();
  const std::size_t planned = cells.size();
  cells.resize(3);
  const PlannedGaps found = gaps(cells);
  ASSERT_EQ(found.matrices.size(), 1U);
  EXPECT_EQ(found.matrices[0].name, "made_up");
  EXPECT_EQ(found.matrices[0].planned, planned);
  EXPECT_EQ(found.matrices[0].present, 3U);
  EXPECT_EQ(found.matrices[0].missing.at("frustum.bvh[leaf_size=2]"), 2U);
  EXPECT_TRUE(gaps(cells, {}).matrices.empty()) << "it was not run";
}

}  // namespace
}  // namespace vislab
