#include "report/sections.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>

#include "common/judge/metrics.h"
#include "common/scene/error.h"
#include "report/chart.h"
#include "report/comparison_sections.h"
#include "report/depth_section.h"
#include "report/device_fits.h"
#include "report/finding.h"
#include "report/format.h"
#include "report/method_fields.h"
#include "report/parallel.h"
#include "report/scene_section.h"
#include "report/sweep_section.h"

namespace vislab {
namespace {

constexpr std::size_t most_in_abstract = 12;

Fields noise_fields(const BlockSummary& block, const std::string& title) {
  Fields row;
  row.values["title"] = title;
  row.values["frame_count"] = std::to_string(block.frames);
  row.values["rounds"] = rounds_of(block);
  row.values["noise"] = block.drawn ? format_estimate(block.noise) : "nothing drawn";
  return row;
}

struct FloorSum {
  std::uint64_t pixels = 0, disputed = 0, undisputed = 0;
};

FloorSum floor_of(const std::vector<const BlockSummary*>& blocks) {
  FloorSum sum;
  for (const BlockSummary* block : blocks) {
    sum.pixels += block->floor_pixels;
    sum.disputed += block->floor_disputed_px;
    sum.undisputed += block->floor_undisputed_px;
  }
  return sum;
}

Fields floor_fields(const std::string& scene, const FloorSum& floor) {
  Fields row;
  row.values["title"] = scene;
  row.values["pixels"] = format_count(floor.pixels);
  row.values["disputed"] = format_count(floor.disputed);
  row.values["share"] =
      format_percent(static_cast<double>(floor.disputed) / static_cast<double>(floor.pixels));
  row.values["undisputed"] = format_count(floor.undisputed);
  return row;
}

std::vector<const BlockSummary*> blocks_of(const ReportInput& input, const ShownScene& scene) {
  std::vector<const BlockSummary*> blocks{&input.blocks[scene.block]};
  for (const std::size_t other : scene.others) blocks.push_back(&input.blocks[other]);
  return blocks;
}

/// A fact's name as the report writes it: "build_type" as "Build type".
std::string context_label(std::string name) {
  if (name == "dirty") return "Uncommitted changes";
  if (name == "load") return "Load at the start";
  if (name.starts_with("cpu")) name.replace(0, 3, "CPU");
  std::ranges::replace(name, '_', ' ');
  if (!name.empty()) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return name;
}

/// One entry a fact of the run; where blocks differ, all that was found.
std::vector<Fields> context_fields(const std::vector<BlockSummary>& blocks) {
  std::map<std::string, std::set<std::string>> facts;
  for (const BlockSummary& block : blocks) {
    for (const auto& [name, text] : block.context) facts[name].insert(text);
    for (const auto& [name, texts] : block.mixed_context) {
      facts[name].insert(texts.begin(), texts.end());
    }
    for (const std::string& machine : block.machines) facts["machine"].insert(machine);
  }
  std::vector<Fields> entries;
  for (const auto& [name, texts] : facts) {
    Fields entry;
    std::string all;
    for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
    entry.values["name"] = markdown_text(context_label(name));
    entry.values["text"] = all.empty() ? "–" : markdown_text(all);
    entries.push_back(std::move(entry));
  }
  return entries;
}

/// One entry for each fact of the build that differs between cells or blocks, for then times may
/// differ for that reason.
std::vector<Fields> mixed_build_fields(const std::vector<BlockSummary>& blocks) {
  std::vector<Fields> entries;
  for (const char* name : {"build_type", "compiler", "compiler_flags", "revision"}) {
    std::set<std::string> texts;
    std::string within;
    for (const BlockSummary& block : blocks) {
      if (const auto one = block.context.find(name); one != block.context.end()) {
        texts.insert(one->second);
      }
      const auto mixed = block.mixed_context.find(name);
      if (mixed == block.mixed_context.end()) continue;
      texts.insert(mixed->second.begin(), mixed->second.end());
      within += (within.empty() ? "" : "; ") + markdown_text(title_of(blocks, block));
    }
    if (texts.size() < 2) continue;
    Fields entry;
    entry.values["fact"] = markdown_text(context_label(name));
    std::string all;
    for (const std::string& text : texts) {
      all += (all.empty() ? "" : "; ") + (text.empty() ? "unknown" : markdown_text(text));
    }
    entry.values["found"] = all;
    entry.flag("is_within", !within.empty());
    entry.values["within"] = within;
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::vector<Fields> metric_fields() {
  std::vector<Fields> rows;
  for (const Metric& metric : metrics()) {
    Fields row;
    row.values["metric"] = markdown_code(metric.name);
    row.values["unit"] = metric.unit == "us" ? "µs" : markdown_text(metric.unit);
    row.values["better"] = metric.better == Metric::Better::lower    ? "lower"
                           : metric.better == Metric::Better::higher ? "higher"
                                                                     : "–";
    row.values["meaning"] = markdown_text(metric.meaning);
    rows.push_back(std::move(row));
  }
  return rows;
}

/// "`default` 120 of 137, `seeds` 3 of 447; all of `smoke`", or empty.
std::string shares_of(const std::vector<MatrixShare>& matrices) {
  std::string parts;
  std::string whole;
  for (const MatrixShare& matrix : matrices) {
    std::string& list = matrix.present == matrix.planned ? whole : parts;
    list += (list.empty() ? "" : ", ") + markdown_code(matrix.name);
    if (matrix.present == matrix.planned) continue;
    list += " " + format_of(matrix.present, matrix.planned);
  }
  if (whole.empty()) return parts;
  return parts + (parts.empty() ? "" : "; ") + "all of " + whole;
}

std::size_t count_distinct(const std::vector<BlockSummary>& blocks, bool methods) {
  std::set<std::string> names;
  for (const BlockSummary& block : blocks) {
    if (!methods) names.insert(block.scene);
    for (const CellSummary& cell : block.cells) {
      if (methods && !cell.anchor) names.insert(cell.canonical);
    }
  }
  return names.size();
}

}  // namespace

std::string title_of(const std::vector<BlockSummary>& blocks, const BlockSummary& block) {
  const auto same = std::ranges::count(blocks, block.scene, &BlockSummary::scene);
  if (same <= 1) return block.scene;
  return block.scene + ", " + block.path + ", " + std::to_string(block.viewport.width) + " × " +
         std::to_string(block.viewport.height) + ", " + block.device;
}

std::string rounds_of(const BlockSummary& block) {
  int least = 0;
  int most = 0;
  for (const CellSummary& cell : block.cells) {
    if (cell.rounds == 0) continue;
    least = least == 0 ? cell.rounds : std::min(least, cell.rounds);
    most = std::max(most, cell.rounds);
  }
  if (least == most) return std::to_string(most);
  return std::to_string(least) + "–" + std::to_string(most);
}

std::string chart_file_name(std::size_t block) {
  return "chart-" + std::to_string(block + 1) + ".svg";
}

Fields report_fields(const ReportInput& input, const std::string& verdict_template,
                     const std::vector<const BlockSummary*>& in_diagrams,
                     const std::filesystem::path& folder) {
  const DeviceFits fits(input.blocks);
  Fields fields;
  fields.values["method_count"] = format_count(count_distinct(input.blocks, true));
  fields.values["scene_count"] = format_count(count_distinct(input.blocks, false));
  auto& scenes = fields.lists["scenes"];  // stays empty if only sweeps were run
  auto& floors = fields.lists["floors"];
  auto& noises = fields.lists["noises"];
  const std::vector<ShownScene> shown = shown_scenes(input.blocks, in_diagrams);
  scenes.resize(shown.size());
  for_each_index(shown.size(), [&](std::size_t i) {
    scenes[i] = scene_fields(input, shown[i], fits, verdict_template, folder);
  });
  // Those with most methods, in the order of the scenes.
  std::vector<std::size_t> order(shown.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t i) {
    return input.blocks[shown[i].block].cells.size();
  });
  order.resize(std::min(order.size(), most_in_abstract));
  std::ranges::sort(order);
  auto& in_abstract = fields.lists["abstract_scenes"];
  for (const std::size_t i : order) {
    in_abstract.emplace_back();
    in_abstract.back().values["verdict"] = scenes[i].values["verdict"];
  }
  fields.flag("has_more_in_abstract", shown.size() > order.size());
  fields.values["more_in_abstract"] = format_count(shown.size() - order.size());
  std::size_t others = 0;
  for (const ShownScene& scene : shown) others += scene.others.size();
  fields.flag("has_other_runs", others > 0);
  fields.values["other_runs"] = format_count(others);
  for (const ShownScene& scene : shown) {
    const BlockSummary& block = input.blocks[scene.block];
    if (const FloorSum floor = floor_of(blocks_of(input, scene)); floor.pixels > 0) {
      floors.push_back(floor_fields(markdown_text(block.scene), floor));
    }
    noises.push_back(noise_fields(block, markdown_text(title_of(input.blocks, block))));
  }
  auto& gaps = fields.lists["missing_blocks"];
  for (const MissingCell& block : input.missing_blocks) {
    gaps.emplace_back();
    gaps.back().values["block"] = markdown_text(block.name);
    gaps.back().values["reason"] = markdown_text(block.reason);
  }
  fields.flag("has_matrices", !input.matrices.empty());
  fields.values["matrix_shares"] = shares_of(input.matrices);
  fields.flag("has_floors", !floors.empty());
  fields.flag("has_diagrams", !in_diagrams.empty());
  const FloorSum floor = floor_of(in_diagrams);
  fields.values["diagram_blocks"] = format_count(in_diagrams.size());
  fields.values["diagram_floor"] = format_of(floor.disputed, floor.pixels);
  fields.values["diagram_undisputed"] = format_count(floor.undisputed);
  add_depth_fields(input, in_diagrams, folder, fields);
  add_surface_fields(input, folder, fields);
  add_sweep_fields(input.sweeps, fields);
  fields.lists["methods"] = method_fields(input);
  fields.lists["metrics"] = metric_fields();
  fields.lists["mixed_build"] = mixed_build_fields(input.blocks);
  fields.flag("is_mixed", !fields.lists["mixed_build"].empty());
  fields.lists["context"] = context_fields(input.blocks);
  fields.lists["costs"] = cost_fields(input.blocks);
  fields.flag("has_costs", !fields.lists["costs"].empty());
  const std::size_t uncalibrated = count_uncalibrated(input.blocks);
  fields.flag("has_uncalibrated", uncalibrated > 0);
  fields.values["uncalibrated"] = format_count(uncalibrated);
  return fields;
}

}  // namespace vislab
