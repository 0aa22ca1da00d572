#include <iostream>

#include "common/judge/metrics.h"
#include "common/scene/error.h"
#include "experiments/analysis/summary.h"
#include "experiments/verbs/present_results.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {

int export_results(const Lab& lab, const std::string& format,
                   const std::filesystem::path& results) {
  if (format != "csv" && format != "json") throw unknown_name("format", format, {"csv", "json"});
  std::vector<std::string> columns{"id",     "scene",   "path",   "width",  "height",
                                   "device", "threads", "seed",   "culler", "chain",
                                   "status", "reason",  "frames", "rounds", "guarantee"};
  for (const Metric& metric : metrics()) columns.emplace_back(metric.name);
  Table table(columns);
  for (const BlockSummary& block : summarise(require_present_cells(results, lab.cullers))) {
    for (const CellSummary& cell : block.cells) {
      std::vector<TableValue> row{cell.id,
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
      for (const Metric& metric : metrics())
        row.emplace_back(cell.metric(std::string(metric.name)));
      table.add(std::move(row));
    }
  }
  format == "csv" ? table.print_csv(std::cout) : table.print_json(std::cout);
  return 0;
}

}  // namespace vislab
