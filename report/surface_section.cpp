#include <algorithm>
#include <functional>

#include "common/scene/error.h"
#include "report/comparison_sections.h"
#include "report/format.h"

namespace vislab {
namespace {

constexpr std::size_t most_pictures = 2;

std::string counter_of(const CellSummary& cell, const std::string& name) {
  const auto found = cell.counters.find(name);
  return found == cell.counters.end() ? "–" : format_number(found->second);
}

Fields row_of(const BlockSummary& block, const CellSummary& cell) {
  Fields row;
  row.values["place"] = markdown_text(block.scene + (block.path.empty() ? "" : ", " + block.path));
  row.values["method"] = markdown_code(cell.culler);
  row.values["guarantee"] = markdown_text(to_string(cell.guarantee));
  row.values["surface_px"] = format_count(cell.surface_px);
  row.values["pixels"] = format_count(cell.pixels);
  row.values["excused"] = format_count(cell.disputed_surface_px);
  row.values["written"] = counter_of(cell, "pixels_written");
  row.values["fragments"] = counter_of(cell, "fragments");
  row.values["build_ms"] = format_rounded(cell.build_ms);
  row.values["cull_us"] =
      cell.cull_us.measured() ? format_number(cell.cull_us.median.value) : "not timed";
  return row;
}

struct Telling {
  const BlockSummary* block = nullptr;
  std::pair<std::uint64_t, std::uint64_t> wrong;  // and excused pixels, of methods that are not
                                                  // wrong on purpose
};

/// Those with most wrong pixels, then with most excused ones; one of each scene.
std::vector<Telling> telling_blocks(const std::vector<BlockSummary>& blocks) {
  std::vector<Telling> all;
  for (const BlockSummary& block : blocks) {
    Telling telling;
    for (const CellSummary& cell : block.cells) {
      if (!cell.judged || !cell.paints || cell.guarantee == Guarantee::erroneous) continue;
      telling.block = &block;
      telling.wrong.first += cell.surface_px;
      telling.wrong.second += cell.disputed_surface_px;
    }
    if (telling.block != nullptr) all.push_back(telling);
  }
  std::ranges::stable_sort(all, std::greater<>(), &Telling::wrong);
  std::vector<Telling> chosen;
  for (const Telling& telling : all) {
    if (chosen.size() == most_pictures) break;
    const bool is_known = std::ranges::any_of(
        chosen, [&](const Telling& other) { return other.block->scene == telling.block->scene; });
    if (!is_known) chosen.push_back(telling);
  }
  return chosen;
}

}  // namespace

void add_surface_fields(const ReportInput& input, const std::filesystem::path& folder,
                        Fields& fields) {
  auto& rows = fields.lists["surfaces"];
  for (const BlockSummary& block : input.blocks) {
    for (const CellSummary& cell : block.cells) {
      if (cell.judged && cell.paints) rows.push_back(row_of(block, cell));
    }
  }
  fields.flag("has_surfaces", !rows.empty());
  auto& pictures = fields.lists["surface_pictures"];
  auto& missing = fields.lists["surface_pictures_missing"];
  if (!input.surface_picture) return;
  for (const Telling& telling : telling_blocks(input.blocks)) {
    const std::string file = "surfaces-" + std::to_string(pictures.size() + 1) + ".png";
    Fields picture;
    picture.values["scene"] = markdown_text(telling.block->scene);
    try {
      picture.values["caption"] =
          markdown_text(input.surface_picture(*telling.block, folder / file));
      picture.values["file"] = file;
      pictures.push_back(std::move(picture));
    } catch (const InputError& error) {
      // Results outlive the scenes they were measured on; the report is whole without pictures.
      picture.values["reason"] = markdown_text(error.what());
      missing.push_back(std::move(picture));
    }
  }
}

}  // namespace vislab
