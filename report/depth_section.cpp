#include "report/depth_section.h"

#include <optional>

#include "common/scene/error.h"
#include "report/format.h"
#include "report/parallel.h"
#include "report/scene_section.h"

namespace vislab {
namespace {

Fields row_of(const BlockSummary& block, const DepthComplexityTable& table) {
  Fields row;
  row.values["scene"] = markdown_text(block.scene);
  row.values["path"] = markdown_code(block.path);
  row.values["frame"] = std::to_string(block.frames / 3);
  row.values["size"] =
      std::to_string(block.viewport.width) + " × " + std::to_string(block.viewport.height);
  for (const DepthComplexity definition : depth_complexities) {
    const DepthComplexityFigures& figures = table[static_cast<std::size_t>(definition)];
    row.values[std::string(to_string(definition))] = format_number(figures.mean) + " · " +
                                                     format_count(figures.p95) + " · " +
                                                     format_count(figures.max);
  }
  return row;
}

}  // namespace

void add_depth_fields(const ReportInput& input, const std::vector<const BlockSummary*>& left_out,
                      const std::filesystem::path& folder, Fields& fields) {
  auto& rows = fields.lists["depths"];
  auto& pictures = fields.lists["depth_pictures"];
  const std::vector<ShownScene> scenes = shown_scenes(input.blocks, left_out);
  std::vector<std::optional<DepthComplexityTable>> tables(scenes.size());
  for_each_index(input.depth_complexity ? scenes.size() : 0, [&](std::size_t i) {
    try {
      tables[i] = input.depth_complexity(input.blocks[scenes[i].block], {});
    } catch (const InputError&) {
      // The scene's own section says why it cannot be had.
    }
  });
  const BlockSummary* deepest = nullptr;
  double greatest = 0.0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (!tables[i]) continue;
    const BlockSummary& block = input.blocks[scenes[i].block];
    rows.push_back(row_of(block, *tables[i]));
    if ((*tables[i])[0].mean > greatest) {
      greatest = (*tables[i])[0].mean;
      deepest = &block;
    }
  }
  if (deepest != nullptr) {
    const std::string file = "depth-complexity.png";
    input.depth_complexity(*deepest, folder / file);
    Fields picture;
    picture.values["file"] = file;
    picture.values["scene"] = markdown_text(deepest->scene);
    pictures.push_back(std::move(picture));
  }
  fields.flag("has_depths", !rows.empty());
}

}  // namespace vislab
