#include <array>
#include <cmath>
#include <iostream>
#include <set>
#include <utility>

#include "common/judge/metrics.h"
#include "common/scene/error.h"
#include "experiments/analysis/summary.h"
#include "experiments/verbs/present_results.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

using Row = std::vector<TableValue>;

constexpr std::array<std::pair<const char*, TimeSummary CellSummary::*>, 4> times{
    {{"frame_ms", &CellSummary::frame_ms},
     {"update_us", &CellSummary::update_us},
     {"cull_us", &CellSummary::cull_us},
     {"draw_ms", &CellSummary::draw_ms}}};

/// Counts that are whole are written without a fraction.
TableValue whole_if_exact(double value) {
  constexpr double largest = 9007199254740992.0;  // 2^53: whole numbers are exact up to here
  if (!(value >= 0.0) || value > largest || value != std::floor(value)) return value;
  return static_cast<std::uint64_t>(value);
}

/// Names of all counters that any cell has, so that every row has the same columns.
std::set<std::string> counter_names(const std::vector<BlockSummary>& blocks) {
  std::set<std::string> names;
  for (const BlockSummary& block : blocks) {
    for (const CellSummary& cell : block.cells) {
      for (const auto& [name, value] : cell.counters) names.insert(name);
    }
  }
  return names;
}

std::vector<std::string> column_names(const std::set<std::string>& counters) {
  std::vector<std::string> columns{"id",     "scene",   "path",   "width",  "height",
                                   "device", "threads", "seed",   "culler", "chain",
                                   "status", "reason",  "frames", "rounds", "guarantee"};
  for (const Metric& metric : metrics()) columns.emplace_back(metric.name);
  for (const auto& [name, time] : times) {
    for (const char* part : {"_low", "_high", "_p95", "_p99", "_worst"}) {
      columns.push_back(std::string(name) + part);
    }
  }
  for (const char* name : {"against_none", "against_none_low", "against_none_high",
                           "efficiency_low", "efficiency_high"}) {
    columns.emplace_back(name);
  }
  for (const CostQuantity& quantity : cost_quantities()) {
    for (const char* part : {"_ns", "_ns_low", "_ns_high"}) {
      columns.push_back("cost." + std::string(quantity.name) + part);
    }
  }
  for (const GpuDial& dial : gpu_dials()) columns.push_back("device." + std::string(dial.name));
  for (const std::string& name : counters) columns.push_back("counter." + name);
  return columns;
}

void add_statistics(const CellSummary& cell, Row& row) {
  for (const auto& [name, member] : times) {
    const TimeSummary& time = cell.*member;
    row.insert(row.end(), {time.median.low, time.median.high, time.p95, time.p99, time.worst});
  }
  row.insert(row.end(), {cell.against_none.value, cell.against_none.low, cell.against_none.high,
                         cell.efficiency.low, cell.efficiency.high});
}

/// What drawing and testing cost on the cell's machine; old results do not have it.
void add_costs(const BlockSummary& block, const CellSummary& cell, Row& row) {
  const auto costs = block.costs.find(cell.machine);
  for (const CostQuantity& quantity : cost_quantities()) {
    if (costs == block.costs.end()) {
      row.insert(row.end(), 3, TableValue());
      continue;
    }
    const Cost& cost = costs->second.*quantity.cost;
    row.insert(row.end(), {cost.ns, cost.low_ns, cost.high_ns});
  }
}

/// Of a modelled device, as the cell was measured on it.
void add_device(const BlockSummary& block, const CellSummary& cell, Row& row) {
  if (cell.device_model >= block.device_models.size()) {
    row.insert(row.end(), gpu_dials().size(), TableValue());
    return;
  }
  const GpuModel& model = block.device_models[cell.device_model];
  for (const GpuDial& dial : gpu_dials()) row.emplace_back(dial.value(model));
}

/// Per frame; a counter that the cell does not have does not apply.
void add_counters(const CellSummary& cell, const std::set<std::string>& counters, Row& row) {
  for (const std::string& name : counters) {
    const auto found = cell.counters.find(name);
    row.push_back(found == cell.counters.end() ? TableValue() : whole_if_exact(found->second));
  }
}

}  // namespace

int export_results(const Lab& lab, const std::string& format,
                   const std::filesystem::path& results) {
  if (format != "csv" && format != "json") throw unknown_name("format", format, {"csv", "json"});
  const std::vector<BlockSummary> blocks = summarise(require_present_cells(results, lab.cullers));
  const std::set<std::string> counters = counter_names(blocks);
  Table table(column_names(counters));
  for (const BlockSummary& block : blocks) {
    for (const CellSummary& cell : block.cells) {
      Row row{cell.id,
              block.scene,
              block.path,
              static_cast<std::uint64_t>(block.viewport.width),
              static_cast<std::uint64_t>(block.viewport.height),
              block.device,
              static_cast<std::uint64_t>(block.threads),
              block.seed,
              cell.culler,
              cell.canonical,
              to_string(cell.status),
              cell.reason,
              static_cast<std::uint64_t>(block.frames),
              static_cast<std::uint64_t>(cell.rounds),
              std::string(to_string(cell.guarantee))};
      for (const Metric& metric : metrics()) {
        row.push_back(whole_if_exact(cell.metric(std::string(metric.name))));
      }
      add_statistics(cell, row);
      add_costs(block, cell, row);
      add_device(block, cell, row);
      add_counters(cell, counters, row);
      table.add(std::move(row));
    }
  }
  format == "csv" ? table.print_csv(std::cout) : table.print_json(std::cout);
  return 0;
}

}  // namespace vislab
