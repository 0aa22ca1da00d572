// Which of the methods that cull the same should be used: made from what was measured.
#pragma once

#include <string>
#include <vector>

#include "experiments/analysis/summary.h"

namespace vislab {

/// Time to decide about a frame: update and cull, µs; NaN if not measured.
double decision_us(const CellSummary& cell);

/// What a user pays for a frame, ms: modelled_frame_ms where the block is drawn (deciding, and
/// drawing what is submitted), else decision_us; NaN if not measured.
double cost_ms(const BlockSummary& block, const CellSummary& cell);

/// The best of a kind on one block. Pointers lead into the blocks.
struct GuideRow {
  const BlockSummary* block = nullptr;
  const CellSummary* best = nullptr;       // costs least
  const CellSummary* runner_up = nullptr;  // the next
  const CellSummary* soonest = nullptr;    // least decision_us of those that leave out
};

/// How one method fares on a group of blocks, against the best on each.
struct GuideCandidate {
  std::string culler;
  Guarantee guarantee = Guarantee::conservative;
  int wins = 0;
  double mean_ratio = 0.0;   // geometric mean of its cost / the best's
  double worst_ratio = 0.0;  // the largest, and where
  const BlockSummary* worst_block = nullptr;
};

/// The method to take for a group of blocks: the one with the least mean ratio among those that
/// are candidates on every block of the group.
struct GuideAdvice {
  enum class Group { all, still, moving } group = Group::all;
  std::size_t blocks = 0;
  std::size_t eligible = 0;  // candidates on every block
  GuideCandidate choice;
};

struct CullerGuide {
  Culls culls = Culls::hidden;
  std::vector<GuideRow> rows;
  /// For all blocks; where there are both, for those whose objects are still and those where some
  /// move.
  std::vector<GuideAdvice> advice;
};

/// One guide for each kind of culling, whatever the families, from the blocks that have at least
/// three candidates of that kind, one of which at least leaves something out. A candidate is a
/// method (no chain, no anchor, nothing declared erroneous) that was measured free of errors. Where
/// nothing is drawn, only methods that submit at most 1 % more triangles than the fewest are:
/// deciding soon is no merit in one that keeps everything.
std::vector<CullerGuide> make_guides(const std::vector<BlockSummary>& blocks);
std::vector<CullerGuide> make_guides(std::vector<BlockSummary>&& blocks) = delete;  // it points in

}  // namespace vislab
