// Runs matrices block by block, each in a process of its own.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "experiments/run/block_runner.h"

namespace vislab {

struct RunOptions {
  RunSettings settings;
  int shard = 1, shards = 1;  // this run takes blocks shard, shard + shards, … (counted from 1)
  bool quiet = false;
};

struct RunOutcome {
  std::set<std::string> cells;  // ids of all cells of the blocks
  /// The same for each block; empty for blocks that this run did not look at.
  std::vector<std::vector<std::string>> cells_of_block;
  int measured = 0, present = 0, failed = 0;  // cells
  bool stopped = false;                       // by Ctrl-C
  std::vector<std::string> errors;            // of blocks whose input was wrong
  std::vector<std::string> failures;          // of blocks that ended for another reason
};

/// Each block runs in a child process: its memory is given back, a crash or a hang of a cell is put
/// down to that cell and the block goes on without it. To be called before the process has started
/// threads. Ctrl-C (or SIGTERM) lets the present pass end, or the rays of the
/// present frame; whole rounds are kept, the one under way is measured again next time. A second
/// Ctrl-C does not wait. A result that cannot be written, as on a full disk, ends the run as an
/// error; its cell is not marked as failed. The caller has made the results folder
/// (ResultStore::create) and holds its FolderLock.
RunOutcome run_blocks(const std::vector<Block>& blocks, const RunOptions& options,
                      const Registry& registry);

}  // namespace vislab
