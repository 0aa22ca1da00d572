#include "report/device_fits.h"

#include <algorithm>

namespace vislab {

DeviceFits::DeviceFits(const std::vector<BlockSummary>& blocks) {
  for (const BlockSummary& block : blocks) {
    std::vector<GpuModel>& known = models_[block.device];
    for (const GpuModel& model : block.device_models) {
      if (std::ranges::count(known, model) == 0) known.push_back(model);
    }
  }
}

std::string DeviceFits::name_of(const BlockSummary& block, const CellSummary& cell) const {
  if (cell.device_model >= block.device_models.size()) return {};
  return name_of(block, block.device_models[cell.device_model]);
}

std::string DeviceFits::name_of(const BlockSummary& block, const GpuModel& model) const {
  const std::vector<GpuModel>& known = models_.at(block.device);
  if (known.size() < 2) return {};
  return "fit " + std::to_string(std::ranges::find(known, model) - known.begin() + 1);
}

}  // namespace vislab
