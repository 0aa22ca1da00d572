// Which method of a family should be used: made from what was measured.
#pragma once

#include <string>
#include <vector>

#include "experiments/analysis/summary.h"

namespace vislab {

/// Time to decide about a frame: update and cull, µs; NaN if not measured.
double decision_us(const CellSummary& cell);

/// The best of a family on one block. Pointers lead into the blocks.
struct GuideRow {
  const BlockSummary* block = nullptr;
  const CellSummary* best = nullptr;        // decides soonest
  const CellSummary* runner_up = nullptr;   // the next
  const CellSummary* best_frame = nullptr;  // least frame_ms; null if nothing is drawn
};

/// How one method fares on a group of blocks, against the best on each.
struct GuideCandidate {
  std::string culler;
  int wins = 0;
  double mean_ratio = 0.0;   // geometric mean of its decision time / the best's
  double worst_ratio = 0.0;  // the largest, and where
  const BlockSummary* worst_block = nullptr;
};

/// The method to take for a group of blocks: the one with the least mean ratio among those that
/// were measured free of errors on every block of the group.
struct GuideAdvice {
  enum class Group { all, still, moving } group = Group::all;
  std::size_t blocks = 0;
  GuideCandidate choice;
};

struct FamilyGuide {
  std::string family;
  std::vector<GuideRow> rows;
  /// For all blocks; where there are both, for those whose objects are still and those where some
  /// move.
  std::vector<GuideAdvice> advice;
};

/// One guide for each family that has at least three methods (not chains, not anchors, nothing
/// erroneous) measured free of errors on some block, from those blocks.
std::vector<FamilyGuide> make_guides(const std::vector<BlockSummary>& blocks);

}  // namespace vislab
