// Which method or chain of methods is the fastest on each scene, as far as can be told.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiments/analysis/summary.h"

namespace vislab {

/// With errors in at most this share of the pixels a method counts as nearly right.
constexpr double nearly_right_share = 0.001;

/// What was found on one block. All comparisons are of against_none; two methods are told apart if
/// their 95 % intervals do not overlap. Pointers lead into the block.
struct ChainChoice {
  enum class Worth {
    saves,         // the fastest is faster than none, beyond the noise
    within_noise,  // it cannot be told from none; nor can any without a control
    loses,         // it is slower than none, beyond the noise
    nothing        // no method without an error was timed
  };

  const BlockSummary* block = nullptr;
  Worth worth = Worth::nothing;
  /// The fastest without an error, of those that are told to be faster than none if there are any.
  const CellSummary* best = nullptr;
  /// The others without an error that cannot be told from it, in the order of is_sooner().
  std::vector<const CellSummary*> undecided;
  /// The fastest that is nearly right, if it is faster than `best`, told apart; else null.
  const CellSummary* nearly_right = nullptr;
  /// As `best`, of each family; of chains of several methods under "chain".
  std::map<std::string, const CellSummary*> families;

  /// Can the family's fastest not be told from `best`?
  bool is_undecided(const CellSummary& cell) const;
};

/// How often a family had the fastest method.
struct FamilyTally {
  std::size_t blocks = 0;     // where it has any without an error
  std::size_t wins = 0;       // where its fastest is the fastest, and told apart from all others'
  std::size_t undecided = 0;  // where its fastest is, or cannot be told from, the fastest
};

/// One for each block that was drawn, on a real device and on one machine, with any method that was
/// judged and timed against none; in the blocks' order. Anchors are not to choose from, nor methods
/// that paint an image of their own, nor what is declared erroneous.
std::vector<ChainChoice> choose_chains(const std::vector<BlockSummary>& blocks);
std::vector<ChainChoice> choose_chains(std::vector<BlockSummary>&& blocks) = delete;

/// By family, over all choices that have a best.
std::map<std::string, FamilyTally> tally_families(const std::vector<ChainChoice>& choices);

/// "frustum", or "chain" if there are several stages.
std::string family_of_chain(const std::string& canonical);

}  // namespace vislab
