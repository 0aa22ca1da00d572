#include "experiments/analysis/modelled_time.h"
#include "report/comparison_sections.h"
#include "report/format.h"

namespace vislab {

std::vector<Fields> cost_fields(const std::vector<BlockSummary>& blocks) {
  std::map<std::string, std::vector<CostTable>> machines;
  for (const BlockSummary& block : blocks) {
    for (const auto& [machine, costs] : block.costs) machines[machine].push_back(costs);
  }
  std::vector<Fields> rows;
  for (const auto& [machine, tables] : machines) {
    const CostTable costs = median_table(tables);
    for (const CostQuantity& quantity : cost_quantities()) {
      const Cost& cost = costs.*quantity.cost;
      Fields row;
      row.values["machine"] = markdown_text(machine);
      row.values["quantity"] = markdown_code(std::string(quantity.name));
      row.values["cost"] = format_estimate({cost.ns, cost.low_ns, cost.high_ns});
      row.values["meaning"] = markdown_text(std::string(quantity.meaning));
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::size_t count_uncalibrated(const std::vector<BlockSummary>& blocks) {
  std::size_t count = 0;
  for (const BlockSummary& block : blocks) {
    for (const CellSummary& cell : block.cells) {
      count += !cell.calibrated && cell.rounds > 0 ? 1 : 0;
    }
  }
  return count;
}

}  // namespace vislab
