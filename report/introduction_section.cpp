#include "report/introduction_section.h"

#include <algorithm>
#include <tuple>

#include "common/scene/error.h"
#include "report/format.h"

namespace vislab {
namespace {

constexpr std::size_t blocks_looked_at = 3;
constexpr std::size_t all_kinds = 5;

using Place = std::tuple<std::string, Space, PipelineStage, Granularity, Guarantee>;

std::vector<Fields> taxonomy_rows(const Registry& cullers) {
  std::map<Place, std::string> methods;
  for (const auto& [name, entry] : cullers.entries()) {
    const CullerInfo& info = entry.info;
    std::string& list =
        methods[Place(info.family, info.space, info.stage, info.granularity, info.guarantee)];
    list += (list.empty() ? "" : ", ") + markdown_code(info.name);
  }
  std::vector<Fields> rows;
  for (const auto& [place, list] : methods) {
    const auto& [family, space, stage, granularity, guarantee] = place;
    Fields row;
    row.values["family"] = markdown_text(family);
    row.values["methods"] = list;
    row.values["space"] = std::string(to_string(space));
    row.values["stage"] = std::string(to_string(stage));
    row.values["granularity"] = std::string(to_string(granularity)) + "s";
    row.values["promise"] = markdown_text(to_string(guarantee));
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Does a method of the block know of cells and portals? Then the scene may have some.
bool clips_portals(const BlockSummary& block) {
  return std::ranges::any_of(block.cells, [](const CellSummary& cell) {
    const auto found = cell.counters.find("portals_clipped");
    return found != cell.counters.end() && found->second > 0.0;
  });
}

/// Those with portals first, of these the lightest: they are the soonest drawn.
std::vector<const BlockSummary*> candidates(const ReportInput& input,
                                            const std::vector<const BlockSummary*>& in_diagrams) {
  std::vector<const BlockSummary*> blocks;
  for (const BlockSummary& block : input.blocks) {
    if (std::ranges::find(in_diagrams, &block) != in_diagrams.end()) continue;
    const bool known = std::ranges::any_of(blocks, [&](const BlockSummary* other) {
      return other->scene_hash == block.scene_hash && other->path_hash == block.path_hash;
    });
    if (!known) blocks.push_back(&block);
  }
  std::ranges::stable_sort(blocks, {}, [](const BlockSummary* block) {
    return std::tuple(!clips_portals(*block), block->triangles);
  });
  if (blocks.size() > blocks_looked_at) blocks.resize(blocks_looked_at);
  return blocks;
}

}  // namespace

void add_introduction_fields(const ReportInput& input,
                             const std::vector<const BlockSummary*>& in_diagrams,
                             const std::filesystem::path& work, Fields& fields) {
  auto& taxonomy = fields.lists["taxonomy"];
  if (input.cullers != nullptr) taxonomy = taxonomy_rows(*input.cullers);
  fields.flag("has_taxonomy", !taxonomy.empty());
  auto& pictures = fields.lists["kinds_pictures"];
  auto& missing = fields.lists["kinds_missing"];
  if (!input.kinds_picture) return;
  std::pair<std::size_t, double> most{0, 0.0};  // kinds; of the same number, the least threshold
  std::string reason;
  std::size_t number = 0;
  for (const BlockSummary* block : candidates(input, in_diagrams)) {
    const std::string file = "kinds-" + std::to_string(++number) + ".png";
    try {
      const KindsPicture picture = input.kinds_picture(*block, work / file);
      const std::pair shown(picture.kinds, -picture.detail_px);
      if (shown <= most) continue;
      most = shown;
      Fields entry;
      entry.values["file"] = file;
      entry.values["place"] = markdown_text(picture.place);
      entry.flag("has_detail", picture.detail_px > 0.0);
      entry.values["detail_px"] = format_number(picture.detail_px);
      entry.flag("is_partial", picture.kinds < all_kinds);
      entry.values["kinds"] = std::to_string(picture.kinds);
      pictures = {std::move(entry)};
    } catch (const InputError& error) {
      if (reason.empty()) reason = error.what();
    }
  }
  if (!pictures.empty() || reason.empty()) return;
  missing.emplace_back();
  missing.back().values["reason"] = markdown_text(reason);
}

}  // namespace vislab
