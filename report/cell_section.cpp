#include "report/cell_section.h"

#include <map>
#include <set>
#include <utility>

#include "common/scene/error.h"
#include "report/format.h"

namespace vislab {
namespace {

/// Counters of methods that know of cells: frames in which the viewer was outside of all of them,
/// and what walks through portals count.
constexpr const char* outside = "frames_outside";
constexpr const char* visited = "cells_visited";

double counter_of(const CellSummary& cell, const std::string& name) {
  const auto found = cell.counters.find(name);
  return found == cell.counters.end() ? 0.0 : found->second;
}

std::string counter_text(const CellSummary& cell, const std::string& name) {
  return cell.counters.contains(name) ? format_number(counter_of(cell, name)) : "–";
}

bool was_in_a_cell(const CellSummary& cell) {
  return cell.counters.contains(outside) && counter_of(cell, outside) < 1.0;
}

Fields row_of(const BlockSummary& block, const CellSummary& cell) {
  Fields row;
  row.values["place"] = markdown_text(
      block.scene + ", " + block.path + ", " + std::to_string(block.viewport.width) + " × " +
      std::to_string(block.viewport.height) + ", " + std::to_string(block.frames) + " frames");
  row.values["method"] = markdown_code(cell.culler);
  row.values["promises"] = markdown_text(to_string(cell.guarantee));
  row.values["outside"] = format_percent(counter_of(cell, outside));
  row.values["visited"] = counter_text(cell, visited);
  row.values["clipped"] = counter_text(cell, "portals_clipped");
  row.values["tested"] = counter_text(cell, "objects_tested");
  row.values["triangles"] = format_number(cell.submitted_triangles);
  row.values["over"] = format_number(cell.over);
  row.values["false_px"] = format_count(cell.false_px);
  row.values["cull_us"] =
      cell.cull_us.measured() ? format_number(cell.cull_us.median.value) : "not timed";
  row.values["build_ms"] = format_rounded(cell.build_ms);
  row.values["bytes"] = format_count(cell.bytes);
  return row;
}

/// What the sets of a scene's cells are worth, whatever path was walked.
Fields set_row_of(const BlockSummary& block, const CellSummary& cell) {
  Fields row;
  row.values["scene"] = markdown_text(block.scene);
  row.values["method"] = markdown_code(cell.culler);
  row.values["cells"] = format_count(cell.regions->cells);
  row.values["rays"] = format_count(cell.regions->rays);
  row.values["misses"] = format_count(cell.regions->misses);
  row.values["over"] = format_number(cell.metric("region_over"));
  row.values["over_points"] = format_number(cell.metric("region_over_points"));
  row.values["set_bytes"] = counter_text(cell, "set_bytes");
  row.values["raw_bytes"] = counter_text(cell, "set_raw_bytes");
  row.values["bytes"] = format_count(cell.bytes);
  row.values["build_ms"] = format_rounded(cell.build_ms);
  return row;
}

/// Walks through portals and does it right, not by luck alone as a negative control may; with the
/// fewest triangles, the first of equals. Null if there is none.
const CellSummary* best_walk(const BlockSummary& block) {
  const CellSummary* best = nullptr;
  for (const CellSummary& cell : block.cells) {
    if (cell.guarantee == Guarantee::erroneous || !was_in_a_cell(cell) ||
        counter_of(cell, visited) == 0.0 || !is_free_of_errors(cell) ||
        cell.granularity != Granularity::object || cell.canonical.find('>') != std::string::npos) {
      continue;
    }
    if (best == nullptr || cell.submitted_triangles < best->submitted_triangles) best = &cell;
  }
  return best;
}

}  // namespace

void add_cell_fields(const ReportInput& input, const std::filesystem::path& folder,
                     Fields& fields) {
  auto& rows = fields.lists["cell_rows"];
  auto& plans = fields.lists["plans"];
  auto& missing = fields.lists["plans_missing"];
  auto& set_rows = fields.lists["set_rows"];
  std::set<std::string> drawn;                             // scenes
  std::map<std::string, Fields> not_drawn;                 // scenes: the first reason
  std::set<std::pair<std::string, std::string>> has_sets;  // scenes and methods
  for (const BlockSummary& block : input.blocks) {
    for (const CellSummary& cell : block.cells) {
      if (cell.judged && was_in_a_cell(cell)) rows.push_back(row_of(block, cell));
      if (cell.regions && has_sets.emplace(block.scene_hash, cell.canonical).second) {
        set_rows.push_back(set_row_of(block, cell));
      }
    }
    const CellSummary* const walk = best_walk(block);
    if (walk == nullptr || !input.plan || drawn.contains(block.scene_hash)) continue;
    const std::string file = "plan-" + std::to_string(plans.size() + 1) + ".png";
    Fields plan;
    plan.values["scene"] = markdown_text(block.scene);
    try {
      plan.values["place"] = markdown_text(input.plan(block, *walk, folder / file));
      plan.values["file"] = file;
      plans.push_back(std::move(plan));
      drawn.insert(block.scene_hash);
    } catch (const InputError& error) {
      // Results outlive the scenes they were measured on; the report is whole without pictures.
      // Another block of the scene, with its own path and device, may still give one.
      plan.values["reason"] = markdown_text(error.what());
      not_drawn.emplace(block.scene_hash, std::move(plan));
    }
  }
  for (const BlockSummary& block : input.blocks) {
    const auto found = not_drawn.find(block.scene_hash);
    if (found == not_drawn.end() || !drawn.insert(block.scene_hash).second) continue;
    missing.push_back(std::move(found->second));
  }
  fields.flag("has_cells", !rows.empty() || !set_rows.empty());
  fields.flag("has_walks", !rows.empty());
  fields.flag("has_sets", !set_rows.empty());
}

}  // namespace vislab
