#include "report/query_section.h"

#include <algorithm>

#include "report/format.h"

namespace vislab {
namespace {

std::string counter_of(const CellSummary& cell, const std::string& name) {
  const auto found = cell.counters.find(name);
  return found == cell.counters.end() ? "–" : format_number(found->second);
}

/// Methods that rasterise themselves count queries, too, but ask no device.
bool asks(const CellSummary& cell) {
  const auto found = cell.counters.find("queries");
  return cell.asks_device && found != cell.counters.end() && found->second > 0.0 &&
         cell.guarantee != Guarantee::erroneous;
}

bool has_diagram(const QueryFindings& findings, const BlockSummary& block) {
  return std::ranges::any_of(findings.phases, [&](const PhaseDiagram& diagram) {
    return std::ranges::count(diagram.blocks, &block) > 0;
  });
}

Fields row_of(const BlockSummary& block, const CellSummary& cell) {
  Fields row;
  row.values["place"] = markdown_text(block.scene + ", " + block.path);
  row.values["device"] = markdown_code(block.device);
  row.values["method"] = markdown_code(cell.culler);
  row.values["frame_ms"] = format_number(cell.frame_ms.median.value);
  row.values["p99"] = format_number(cell.frame_ms.p99);
  for (const char* name : {"queries", "query_boxes", "state_changes", "flushes", "waits"}) {
    row.values[name] = counter_of(cell, name);
  }
  row.values["image_px"] = !cell.judged ? "–"
                           : cell.drawn ? format_count(cell.image_px)
                                        : "not drawn";
  return row;
}

/// "`a` in 5 cells, `b` in 3".
std::string wins_of(const PhaseDiagram& diagram) {
  std::string text;
  for (std::size_t i = 0; i < diagram.winners.size(); ++i) {
    int wins = 0;
    for (const PhaseRow& row : diagram.rows) {
      for (const auto& cell : row.by_latency) {
        if (cell && cell->winner == diagram.winners[i]) ++wins;
      }
    }
    text += (text.empty() ? "" : ", ") + phase_letter(i) + " " + markdown_code(diagram.winners[i]) +
            " in " + std::to_string(wins) + (i == 0 ? " of the cells" : "");
  }
  return text;
}

Fields phase_fields(const PhaseDiagram& diagram, std::size_t index) {
  Fields entry;
  entry.values["title"] = markdown_text(diagram.title);
  entry.values["file"] = phase_file_name(index);
  entry.values["wins"] = wins_of(diagram);
  double lead = 1.0;
  double over_bvh = 0.0;
  int ties = 0;
  for (const PhaseRow& row : diagram.rows) {
    for (const auto& cell : row.by_latency) {
      if (!cell) continue;
      lead = std::max(lead, cell->lead);
      over_bvh = std::max(over_bvh, cell->over_bvh.value_or(0.0));
      ties += cell->decided ? 0 : 1;
    }
  }
  entry.values["lead"] = format_number(lead);
  entry.values["ties"] = std::to_string(ties);
  entry.flag("has_bvh", over_bvh > 0.0);
  entry.values["over_bvh"] = format_number(over_bvh);
  std::string shares;
  for (const PhaseRow& row : diagram.rows) {
    shares += (shares.empty() ? "" : ", ") + markdown_text(row.scene) + " " +
              format_percent(row.hidden_share);
  }
  entry.values["shares"] = shares;
  return entry;
}

Fields retest_fields(const RetestPair& pair) {
  Fields row;
  row.values["title"] = markdown_text(pair.title);
  row.values["method"] = markdown_code(pair.method);
  row.values["aligned"] = format_number(pair.aligned_deviation_ms);
  row.values["random"] = format_number(pair.random_deviation_ms);
  row.values["ratio"] = pair.aligned_deviation_ms > 0.0
                            ? format_number(pair.random_deviation_ms / pair.aligned_deviation_ms)
                            : "–";
  row.values["worst_aligned"] = format_number(pair.aligned_worst_ms);
  row.values["worst_random"] = format_number(pair.random_worst_ms);
  return row;
}

}  // namespace

void add_query_fields(const ReportInput& input, const QueryFindings& findings, Fields& fields) {
  auto& rows = fields.lists["queries"];
  for (const BlockSummary& block : input.blocks) {
    if (has_diagram(findings, block)) continue;
    for (const CellSummary& cell : block.cells) {
      if (asks(cell)) rows.push_back(row_of(block, cell));
    }
  }
  auto& phases = fields.lists["phases"];
  for (std::size_t i = 0; i < findings.phases.size(); ++i) {
    phases.push_back(phase_fields(findings.phases[i], i));
  }
  auto& retests = fields.lists["retests"];
  for (const RetestPair& pair : findings.retests) retests.push_back(retest_fields(pair));
  auto& charts = fields.lists["retest_charts"];
  for (const std::size_t i : findings.charted_retests) {
    Fields chart = retest_fields(findings.retests[i]);
    chart.values["file"] = retest_file_name(i);
    charts.push_back(std::move(chart));
  }
  fields.flag("has_query_rows", !rows.empty());
  fields.flag("has_phases", !phases.empty());
  fields.flag("has_retests", !retests.empty());
  fields.flag("has_bunches", !findings.bunches.series.empty());
  fields.values["bunch_file"] = bunch_file_name;
  fields.flag("has_queries", !rows.empty() || !phases.empty() || !retests.empty() ||
                                 !findings.bunches.series.empty());
}

}  // namespace vislab
