// Numbers for the settings of modelled devices that share a name: dials that are fitted to a
// machine differ from run to run.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiments/analysis/summary.h"

namespace vislab {

class DeviceFits {
 public:
  /// Numbered from 1 in the blocks' order, for each device of its own.
  explicit DeviceFits(const std::vector<BlockSummary>& blocks);

  /// "fit 2": which one a cell was measured on, as Markdown or plain text; "" if all cells on that
  /// device were measured on the same. The block is one of those that were given.
  std::string name_of(const BlockSummary& block, const CellSummary& cell) const;
  std::string name_of(const BlockSummary& block, const GpuModel& model) const;

 private:
  std::map<std::string, std::vector<GpuModel>> models_;  // by device
};

}  // namespace vislab
