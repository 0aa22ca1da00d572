#include "experiments/analysis/chains.h"

#include <gtest/gtest.h>

namespace vislab {
namespace {

CellSummary method(const std::string& name, double low, double high, std::uint64_t false_px = 0) {
  CellSummary cell;
  cell.culler = cell.canonical = name;
  cell.judged = cell.drawn = true;
  cell.pixels = 100'000;
  cell.false_px = false_px;
  cell.guarantee = false_px > 0 ? Guarantee::approximate : Guarantee::conservative;
  cell.against_none = {0.5 * (low + high), low, high};
  return cell;
}

BlockSummary block_with(std::vector<CellSummary> cells) {
  BlockSummary block;
  block.scene = "s";
  block.machines = {"one"};
  block.noise = {1.0, 0.98, 1.02};
  block.cells = std::move(cells);
  return block;
}

TEST(Chains, TheFastestWithoutAnErrorIsNamedAndWhatCannotBeToldFromIt) {
  const std::vector<BlockSummary> blocks{
      block_with({method("frustum.a", 0.50, 0.54), method("frustum.b", 0.53, 0.60),
                  method("frustum.c > depth.d", 0.40, 0.51), method("depth.e", 0.7, 0.8)})};
  const auto choices = choose_chains(blocks);
  ASSERT_EQ(choices.size(), 1U);
  EXPECT_EQ(choices[0].best->culler, "frustum.c > depth.d");
  ASSERT_EQ(choices[0].undecided.size(), 1U);
  EXPECT_EQ(choices[0].undecided[0]->culler, "frustum.a");
  EXPECT_EQ(choices[0].worth, ChainChoice::Worth::saves);
  EXPECT_EQ(choices[0].nearly_right, nullptr);
  EXPECT_EQ(choices[0].families.at("chain")->culler, "frustum.c > depth.d");
  EXPECT_EQ(choices[0].families.at("frustum")->culler, "frustum.a");
  EXPECT_EQ(choices[0].families.at("depth")->culler, "depth.e");
}

TEST(Chains, OneWithFewErrorsIsNamedOnlyWhereItIsFasterBeyondDoubt) {
  const std::vector<BlockSummary> blocks{
      block_with({method("a.right", 0.5, 0.6), method("a.near", 0.3, 0.4, 100)}),
      block_with({method("a.right", 0.5, 0.6), method("a.near", 0.45, 0.55, 100)}),
      block_with({method("a.right", 0.5, 0.6), method("a.far", 0.1, 0.2, 101)})};
  const auto choices = choose_chains(blocks);
  ASSERT_EQ(choices.size(), 3U);
  ASSERT_NE(choices[0].nearly_right, nullptr);
  EXPECT_EQ(choices[0].nearly_right->culler, "a.near");
  EXPECT_EQ(choices[1].nearly_right, nullptr);
  EXPECT_EQ(choices[2].nearly_right, nullptr);
}

TEST(Chains, WhatIsNoFasterThanDrawingEverythingSaysSo) {
  const std::vector<BlockSummary> blocks{block_with({method("a.b", 0.97, 1.01)}),
                                         block_with({method("a.b", 1.03, 1.1)}),
                                         block_with({method("a.b", 0.5, 0.6, 5)})};
  const auto choices = choose_chains(blocks);
  EXPECT_EQ(choices[0].worth, ChainChoice::Worth::within_noise);
  EXPECT_EQ(choices[1].worth, ChainChoice::Worth::loses);
  EXPECT_EQ(choices[2].worth, ChainChoice::Worth::nothing);
  EXPECT_EQ(choices[2].best, nullptr);
}

TEST(Chains, WithoutAControlNothingIsSaidToSaveOrToLose) {
  BlockSummary fast = block_with({method("a.b", 0.5, 0.6)});
  BlockSummary slow = block_with({method("a.b", 1.5, 1.6)});
  fast.noise = slow.noise = Estimate::none();
  const std::vector<BlockSummary> blocks{fast, slow};
  for (const ChainChoice& choice : choose_chains(blocks)) {
    EXPECT_EQ(choice.worth, ChainChoice::Worth::within_noise);
  }
}

TEST(Chains, BlocksWhoseTimesHaveNoCommonOrderAndMethodsThatCannotBeUsedAreLeftOut) {
  BlockSummary machines = block_with({method("a.b", 0.5, 0.6)});
  machines.machines.emplace_back("two");
  BlockSummary undrawn = block_with({method("a.b", 0.5, 0.6)});
  undrawn.drawn = false;
  BlockSummary useless = block_with({method("a.b", 0.5, 0.6), method("a.c", 0.5, 0.6)});
  useless.cells[0].guarantee = Guarantee::erroneous;
  useless.cells[1].paints = true;
  const std::vector<BlockSummary> blocks{machines, undrawn, useless};
  EXPECT_TRUE(choose_chains(blocks).empty());
}

TEST(Chains, AFamilyWinsOnlyWhereItIsToldApartFromAllOthers) {
  const std::vector<BlockSummary> blocks{
      block_with({method("a.x", 0.1, 0.2), method("b.y", 0.3, 0.4)}),
      block_with({method("a.x", 0.1, 0.3), method("b.y", 0.25, 0.4), method("c.z", 0.5, 0.6)})};
  const auto choices = choose_chains(blocks);
  const auto tallies = tally_families(choices);
  EXPECT_EQ(tallies.at("a").wins, 1U);
  EXPECT_EQ(tallies.at("a").undecided, 2U);
  EXPECT_EQ(tallies.at("b").wins, 0U);
  EXPECT_EQ(tallies.at("b").undecided, 1U);
  EXPECT_EQ(tallies.at("c").blocks, 1U);
}

}  // namespace
}  // namespace vislab
