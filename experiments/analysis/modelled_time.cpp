#include "experiments/analysis/modelled_time.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace vislab {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double modelled_ms(const CellSummary& cell, const CostTable& costs) {
  const double drawing_ns = cell.submitted_triangles * costs.triangle.ns +
                            cell.draws * costs.draw.ns +
                            (cell.pieces - cell.draws) * costs.piece.ns;
  return (cell.update_us.median.value + cell.cull_us.median.value) / 1e3 + drawing_ns / 1e6;
}

}  // namespace

CostTable median_table(const std::vector<CostTable>& tables) {
  if (tables.empty()) throw std::logic_error("median_table: there is no table");
  const auto median_of = [&](Cost CostTable::*cost, double Cost::*part) {
    std::vector<double> values;
    for (const CostTable& table : tables) values.push_back(table.*cost.*part);
    return median(std::move(values));
  };
  CostTable all;
  for (const CostQuantity& quantity : cost_quantities()) {
    all.*quantity.cost = {median_of(quantity.cost, &Cost::ns),
                          median_of(quantity.cost, &Cost::low_ns),
                          median_of(quantity.cost, &Cost::high_ns)};
  }
  return all;
}

void model_frame_times(BlockSummary& block) {
  const auto none = std::ranges::find_if(block.cells, [](const CellSummary& cell) {
    return cell.canonical == "none" && cell.replicate == 0;
  });
  for (CellSummary& cell : block.cells) {
    const auto costs = block.costs.find(cell.machine);
    if (!block.device_models.empty() || costs == block.costs.end() || !cell.calibrated) {
      cell.modelled_frame_ms = nan;
    } else if (!cell.asks_device) {
      cell.modelled_frame_ms = modelled_ms(cell, costs->second);
    } else {
      cell.modelled_frame_ms = none == block.cells.end() || !none->calibrated
                                   ? nan
                                   : cell.against_none.value * modelled_ms(*none, costs->second);
    }
  }
}

}  // namespace vislab
