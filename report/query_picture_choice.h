// Which frames and methods the report shows pictures of queries for.
#pragma once

#include <vector>

#include "experiments/analysis/summary.h"

namespace vislab {

/// A block, and methods that are right and ask its device; those with the usual parameters, if any
/// are.
struct QueryPictureChoice {
  const BlockSummary* block = nullptr;
  /// The one that changes most often between drawing and asking, the fastest and the one that
  /// changes least often; each once.
  std::vector<const CellSummary*> contrasts;
  /// The one with the most boxes in a query, if any asks about several with one; else null.
  const CellSummary* joint = nullptr;
  /// Of a method that asks about each object alone: how many it found hidden, a frame, times their
  /// share of those that it asked about. The most that one of the methods reaches.
  double found_hidden = 0.0;
};

/// Of each scene the block in which most was found hidden, and of those the two scenes with the
/// most. Blocks in `left_out` do not count. Pointers lead into `blocks`.
std::vector<QueryPictureChoice> choose_query_pictures(
    const std::vector<BlockSummary>& blocks, const std::vector<const BlockSummary*>& left_out);

/// A method that asks the device and is not wrong on purpose.
bool asks_questions(const CellSummary& cell);

}  // namespace vislab
