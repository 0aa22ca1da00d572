#include "report/query_section.h"

#include <algorithm>
#include <map>
#include <utility>

#include "common/scene/error.h"
#include "report/device_fits.h"
#include "report/format.h"

namespace vislab {
namespace {

std::string counter_of(const CellSummary& cell, const std::string& name) {
  const auto found = cell.counters.find(name);
  return found == cell.counters.end() ? "–" : format_number(found->second);
}

Fields row_of(const BlockSummary& block, const CellSummary& cell, const DeviceFits& fits) {
  Fields row;
  row.values["place"] = markdown_text(block.scene + ", " + block.path);
  row.values["device"] = markdown_code(block.device);
  if (const std::string fit = fits.name_of(block, cell); !fit.empty()) {
    row.values["device"] += ", " + fit;
  }
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
  double over_frustum = 0.0;
  int ties = 0;
  for (const PhaseRow& row : diagram.rows) {
    for (const auto& cell : row.by_latency) {
      if (!cell) continue;
      lead = std::max(lead, cell->lead);
      over_frustum = std::max(over_frustum, cell->over_frustum.value_or(0.0));
      ties += cell->decided ? 0 : 1;
    }
  }
  entry.values["lead"] = format_number(lead);
  entry.values["ties"] = std::to_string(ties);
  entry.flag("has_over_frustum", over_frustum > 0.0);
  entry.values["over_frustum"] = format_number(over_frustum);
  std::string shares;
  for (const PhaseRow& row : diagram.rows) {
    const bool on_several_paths = std::ranges::count(diagram.rows, row.scene, &PhaseRow::scene) > 1;
    shares += (shares.empty() ? "" : ", ") +
              markdown_text(row.scene + (on_several_paths ? " (" + row.path + ")" : "")) + " " +
              format_percent(row.hidden_share);
  }
  entry.values["shares"] = shares;
  for (const PhaseAbsence& absence : diagram.absences) {
    Fields missing;
    missing.values["method"] = markdown_code(absence.culler);
    missing.values["reason"] = markdown_text(absence.reason);
    missing.values["cells"] = format_of(absence.cells, diagram.blocks.size());
    entry.lists["absences"].push_back(std::move(missing));
  }
  entry.flag("has_absences", !diagram.absences.empty());
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

/// "`a`, `b` and `c`".
std::string names_of(const std::vector<const CellSummary*>& cells) {
  std::string names;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) names += i + 1 == cells.size() ? " and " : ", ";
    names += markdown_code(cells[i]->culler);
  }
  return names;
}

/// All pictures of the chosen blocks, written into `folder`.
void add_pictures(const ReportInput& input, const QueryFindings& findings,
                  const std::filesystem::path& folder, Fields& fields) {
  auto& missing = fields.lists["query_pictures_missing"];
  bool any = false;
  for (const QueryPicture picture : query_pictures) {
    const std::string kind(to_string(picture));
    auto& entries = fields.lists["query_" + kind];
    for (const QueryPictureChoice& choice : findings.pictures) {
      std::vector<const CellSummary*> cells = choice.contrasts;
      if (picture == QueryPicture::boxes)
        cells.assign(choice.joint == nullptr ? 0 : 1, choice.joint);
      if (cells.empty() || !input.query_picture) continue;
      const std::string file = "query-" + kind + "-" + std::to_string(entries.size() + 1) + ".png";
      Fields entry;
      entry.values["file"] = file;
      entry.values["methods"] = names_of(cells);
      try {
        const std::string place = input.query_picture(*choice.block, cells, picture, folder / file);
        entry.values["place"] = markdown_text(place);
        entries.push_back(std::move(entry));
        any = true;
      } catch (const InputError& error) {
        // Results outlive the scenes they were measured on; the report is whole without pictures.
        entry.values["what"] = kind + " of " + markdown_text(choice.block->scene);
        entry.values["reason"] = markdown_text(error.what());
        missing.push_back(std::move(entry));
      }
    }
  }
  fields.flag("has_query_pictures", any || !missing.empty());
}

/// Of each scene on each device the block in which most methods asked, in the blocks' order.
std::vector<const BlockSummary*> telling_blocks(const std::vector<BlockSummary>& blocks,
                                                const std::vector<const BlockSummary*>& left_out) {
  using Place = std::pair<std::string, std::string>;
  std::map<Place, std::pair<std::ptrdiff_t, const BlockSummary*>> best;
  for (const BlockSummary& block : blocks) {
    if (std::ranges::count(left_out, &block) > 0) continue;
    const auto asking = std::ranges::count_if(block.cells, asks_questions);
    auto& known = best[{block.scene, block.device}];
    if (asking > known.first) known = {asking, &block};
  }
  std::vector<const BlockSummary*> chosen;
  for (const auto& [place, found] : best) {
    if (found.second != nullptr) chosen.push_back(found.second);
  }
  std::ranges::sort(chosen);  // all lie in one vector
  return chosen;
}

}  // namespace

void add_query_fields(const ReportInput& input, const QueryFindings& findings,
                      const std::filesystem::path& folder, Fields& fields) {
  const DeviceFits fits(input.blocks);
  const std::vector<const BlockSummary*> charted = findings.diagram_blocks();
  auto& rows = fields.lists["queries"];
  for (const BlockSummary* block : telling_blocks(input.blocks, charted)) {
    for (const CellSummary& cell : block->cells) {
      if (asks_questions(cell)) rows.push_back(row_of(*block, cell, fits));
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
  auto& bunches = fields.lists["bunches"];
  for (std::size_t i = 0; i < findings.bunches.size(); ++i) {
    Fields chart;
    chart.values["device"] = markdown_code(findings.bunches[i].device);
    chart.values["file"] = bunch_file_name(i);
    bunches.push_back(std::move(chart));
  }
  fields.flag("has_bunches", !bunches.empty());
  add_pictures(input, findings, folder, fields);
  fields.flag("has_queries",
              !rows.empty() || !phases.empty() || !retests.empty() || !bunches.empty());
}

}  // namespace vislab
