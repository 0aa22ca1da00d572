#include "experiments/analysis/modelled_time.h"
#include "report/comparison_sections.h"
#include "report/format.h"

namespace vislab {

std::vector<Fields> cost_fields(const std::vector<BlockSummary>& blocks) {
  // Mesa draws with as many threads as the cells were measured with.
  std::map<std::pair<std::string, int>, std::vector<CostTable>> machines;
  for (const BlockSummary& block : blocks) {
    for (const auto& [machine, costs] : block.costs) {
      machines[{machine, block.threads}].push_back(costs);
    }
  }
  std::vector<Fields> rows;
  for (const auto& [place, tables] : machines) {
    const std::string machine = markdown_text(place.first) + ", " + std::to_string(place.second) +
                                (place.second == 1 ? " thread" : " threads");
    const CostTable costs = median_table(tables);
    for (const CostQuantity& quantity : cost_quantities()) {
      const Cost& cost = costs.*quantity.cost;
      Fields row;
      row.values["machine"] = machine;
      row.values["quantity"] = markdown_code(std::string(quantity.name));
      row.values["cost"] = format_estimate({cost.ns, cost.low_ns, cost.high_ns});
      row.values["meaning"] = markdown_text(std::string(quantity.meaning));
      rows.push_back(std::move(row));
    }
    Fields ratio;
    ratio.values["machine"] = machine;
    ratio.values["quantity"] = "t_C ÷ r";
    ratio.values["cost"] = format_number(costs.cluster_test_over_triangle());
    ratio.values["meaning"] =
        "the test of a cluster in triangles drawn, for the cost model of clusters (no unit)";
    rows.push_back(std::move(ratio));
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
