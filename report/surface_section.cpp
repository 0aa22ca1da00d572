#include "common/scene/error.h"
#include "report/comparison_sections.h"
#include "report/format.h"

namespace vislab {
namespace {

std::string counter_of(const CellSummary& cell, const std::string& name) {
  const auto found = cell.counters.find(name);
  return found == cell.counters.end() ? "–" : format_number(found->second);
}

Fields row_of(const CellSummary& cell) {
  Fields row;
  row.values["method"] = markdown_code(cell.culler);
  row.values["guarantee"] = markdown_text(to_string(cell.guarantee));
  row.values["surface_px"] = format_of(cell.surface_px, cell.pixels);
  row.values["excused"] = format_count(cell.disputed_surface_px);
  row.values["written"] = counter_of(cell, "pixels_written");
  row.values["fragments"] = counter_of(cell, "fragments");
  row.values["build_ms"] = format_rounded(cell.build_ms);
  row.values["cull_us"] =
      cell.cull_us.measured() ? format_number(cell.cull_us.median.value) : "not timed";
  return row;
}

}  // namespace

std::vector<Fields> surface_fields(const ReportInput& input, const std::filesystem::path& folder) {
  std::vector<Fields> entries;
  for (const BlockSummary& block : input.blocks) {
    Fields entry;
    for (const CellSummary& cell : block.cells) {
      if (cell.judged && cell.paints) entry.lists["rows"].push_back(row_of(cell));
    }
    if (entry.lists["rows"].empty()) continue;
    entry.values["title"] = markdown_text(block.scene);
    entry.values["path"] = markdown_text(block.path);
    auto& pictures = entry.lists["pictures"];
    auto& missing = entry.lists["picture_missing"];
    if (input.surface_picture) {
      const std::string file = "surfaces-" + std::to_string(entries.size() + 1) + ".png";
      Fields picture;
      try {
        picture.values["caption"] = markdown_text(input.surface_picture(block, folder / file));
        picture.values["file"] = file;
        pictures.push_back(std::move(picture));
      } catch (const InputError& error) {
        // Results outlive the scenes they were measured on; the report is whole without pictures.
        picture.values["reason"] = markdown_text(error.what());
        missing.push_back(std::move(picture));
      }
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace vislab
