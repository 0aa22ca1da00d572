#include "report/sections.h"

#include <algorithm>
#include <cctype>
#include <cmath>
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
#include "report/sweep_section.h"

namespace vislab {
namespace {

/// The scene's name, with path and resolution where several blocks share it.
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

/// The value, and its interval on a line of its own.
std::string in_cell(const Estimate& estimate) {
  const std::string text = format_estimate(estimate);
  const std::size_t open = text.find(" (");
  if (open == std::string::npos) return text;
  return text.substr(0, open) + " [" + text.substr(open + 2, text.size() - open - 3) +
         "]{.interval}";
}

Fields speed_fields(const CellSummary& cell, std::size_t number, const std::string& fit) {
  Fields row;
  row.values["number"] = std::to_string(number);
  row.values["method"] =
      markdown_code(cell.culler) + (fit.empty() ? "" : " [" + fit + "]{.interval}");
  row.values["frame_ms"] = in_cell(cell.frame_ms.median);
  row.values["frame_tail"] = format_number(cell.frame_ms.p95) + " · " +
                             format_number(cell.frame_ms.p99) + " · " +
                             format_number(cell.frame_ms.worst);
  row.values["against_none"] = in_cell(cell.against_none);
  row.values["efficiency"] = in_cell(cell.efficiency);
  row.values["update_us"] = format_number(cell.update_us.median.value);
  row.values["cull_us"] = in_cell(cell.cull_us.median);
  row.values["draw_ms"] = in_cell(cell.draw_ms.median);
  row.values["modelled"] = format_number(cell.modelled_frame_ms);
  row.values["build_ms"] = format_rounded(cell.build_ms);
  row.values["bytes"] = format_bytes(cell.bytes);
  return row;
}

/// Only samples of J bound what lies between the pixels, and only for methods that promise it.
std::string lost_rays(const CellSummary& cell) {
  if (cell.guarantee != Guarantee::conservative || cell.jittered == 0) return "–";
  if (cell.false_jittered > 0) return format_of(cell.false_jittered, cell.jittered);
  return "0 [< " + format_scientific(3.0 / static_cast<double>(cell.jittered)) + "]{.interval}";
}

Fields accuracy_fields(const CellSummary& cell, std::size_t number) {
  Fields row;
  row.values["number"] = std::to_string(number);
  row.values["method"] = markdown_code(cell.culler);
  row.values["guarantee"] = markdown_text(to_string(cell.guarantee));
  row.values["submitted"] = format_number(cell.submitted_triangles);
  row.values["over"] = format_number(cell.over);
  row.values["recall"] = format_percent(cell.recall);
  row.values["false_px"] = format_of(cell.false_px, cell.pixels);
  row.values["max_false_px"] = format_count(cell.max_false_px);
  row.values["false_objects"] = format_count(cell.false_objects);
  row.values["false_triangles"] = format_count(cell.false_triangles);
  row.values["image_px"] = cell.drawn ? format_of(cell.image_px, cell.pixels) : "not drawn";
  row.values["jittered"] = lost_rays(cell);
  return row;
}

/// Why a cell is missing from a table, if it is.
std::string what_is_missing(const CellSummary& cell) {
  if (cell.status == ResultCell::Status::failed) return "failed";
  if (cell.status == ResultCell::Status::running) return "is not finished";
  if (!cell.judged) return "is not judged";
  return {};
}

void add_tables(const ReportInput& input, const BlockSummary& block, const DeviceFits& fits,
                Fields& fields) {
  auto& speed = fields.lists["speed"];
  auto& accuracy = fields.lists["accuracy"];
  auto& missing = fields.lists["not_measured"];
  for (std::size_t i = 0; i < block.cells.size(); ++i) {
    const CellSummary& cell = block.cells[i];
    if (cell.frame_ms.measured()) {
      speed.push_back(speed_fields(cell, i + 1, fits.name_of(block, cell)));
    }
    if (cell.judged) accuracy.push_back(accuracy_fields(cell, i + 1));
    if (const std::string what = what_is_missing(cell); !what.empty()) {
      Fields entry;
      entry.values["method"] = markdown_code(cell.culler);
      entry.values["what"] = what;
      entry.values["reason"] =
          markdown_text(cell.reason.empty() ? "another run goes on with it" : cell.reason);
      missing.push_back(std::move(entry));
    }
  }
  if (input.missing_cells) {
    for (const MissingCell& cell : input.missing_cells(block)) {
      Fields entry;
      entry.values["method"] = markdown_code(cell.name);
      entry.values["what"] = "is missing";
      entry.values["reason"] = markdown_text(cell.reason);
      missing.push_back(std::move(entry));
    }
  }
  fields.flag("has_not_measured", !missing.empty());
  fields.flag("has_speed", !speed.empty());
  fields.flag("has_accuracy", !accuracy.empty());
}

/// Pictures of the best method without errors, and of the one with the most false pixels.
void add_pictures(const ReportInput& input, const BlockSummary& block, std::size_t index,
                  const std::filesystem::path& folder, Fields& fields) {
  auto& pictures = fields.lists["pictures"];
  auto& missing = fields.lists["picture_missing"];
  if (!input.picture) return;
  std::vector<const CellSummary*> cells;
  if (const CellSummary* best = find(block).best; best != nullptr) cells.push_back(best);
  const CellSummary* worst = nullptr;
  for (const CellSummary& cell : block.cells) {
    if (!cell.judged || cell.false_px == 0) continue;
    if (worst == nullptr || cell.false_px > worst->false_px) worst = &cell;
  }
  if (worst != nullptr) cells.push_back(worst);
  for (const CellSummary* cell : cells) {
    const std::string file =
        "picture-" + std::to_string(index + 1) + "-" + std::to_string(pictures.size() + 1) + ".png";
    Fields entry;
    entry.values["method"] = markdown_code(cell->culler);
    try {
      entry.values["caption"] = markdown_text(input.picture(block, *cell, folder / file));
      entry.values["file"] = file;
      pictures.push_back(std::move(entry));
    } catch (const InputError& error) {
      // Results outlive the scenes they were measured on; the report is whole without pictures.
      entry.values["reason"] = markdown_text(error.what());
      missing.push_back(std::move(entry));
    }
  }
}

std::string trimmed_to_one_line(const std::string& text) {
  std::string line;
  for (const char c : text) {
    if (c == '\n' || c == ' ') {
      if (!line.empty() && line.back() != ' ') line += ' ';
    } else {
      line += c;
    }
  }
  while (line.ends_with(' ')) line.pop_back();
  return line;
}

/// "`dials`", with the fit's name where there are several.
std::string dials_of(const BlockSummary& block, const DeviceFits& fits) {
  std::string dials;
  for (const GpuModel& model : block.device_models) {
    const std::string fit = fits.name_of(block, model);
    dials += (dials.empty() ? "" : "; ") + (fit.empty() ? "" : fit + ": ") +
             markdown_code(to_text(model));
  }
  return dials;
}

Fields scene_fields(const ReportInput& input, std::size_t index, const DeviceFits& fits,
                    const std::string& verdict_template, const std::filesystem::path& folder) {
  const BlockSummary& block = input.blocks[index];
  const std::string title = markdown_text(title_of(input.blocks, block));
  Fields fields;
  fields.values["title"] = title;
  fields.values["description"] = markdown_text(block.scene_description);
  fields.values["object_count"] = format_count(block.objects);
  fields.values["triangle_count"] = format_count(block.triangles);
  fields.values["path"] = markdown_code(block.path);
  fields.values["frame_count"] = std::to_string(block.frames);
  fields.values["width"] = std::to_string(block.viewport.width);
  fields.values["height"] = std::to_string(block.viewport.height);
  fields.values["rounds"] = rounds_of(block);
  fields.values["threads"] = std::to_string(block.threads);
  fields.values["device"] = markdown_code(block.device);
  fields.flag("modelled_device", !block.device_models.empty());
  fields.values["dials"] = dials_of(block, fits);
  fields.flag("mixed_fits", block.device_models.size() > 1);
  fields.values["fit_count"] = std::to_string(block.device_models.size());
  fields.values["verdict"] = trimmed_to_one_line(
      fill_template(verdict_template, finding_fields(block, title), "verdict.md"));
  fields.flag("undrawn", !block.drawn);
  fields.flag("mixed_machines", block.machines.size() > 1);
  fields.values["machine_count"] = std::to_string(block.machines.size());
  const bool charted = !charted_cells(block).empty();
  fields.flag("chart", charted);
  fields.values["file"] = chart_file_name(index);
  fields.values["x_meaning"] =
      has_time_axis(block) ? "median time of a frame" : "triangles submitted per frame";
  add_tables(input, block, fits, fields);
  add_pictures(input, block, index, folder, fields);
  return fields;
}

Fields floor_fields(const BlockSummary& block, const std::string& title) {
  Fields row;
  row.values["title"] = title;
  row.values["pixels"] = format_count(block.floor_pixels);
  row.values["disputed"] = format_count(block.floor_disputed_px);
  row.values["share"] = format_percent(static_cast<double>(block.floor_disputed_px) /
                                       static_cast<double>(block.floor_pixels));
  row.values["undisputed"] = format_count(block.floor_undisputed_px);
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
  for (std::size_t i = 0; i < input.blocks.size(); ++i) {
    const BlockSummary& block = input.blocks[i];
    if (std::ranges::count(in_diagrams, &block) > 0) continue;
    Fields scene = scene_fields(input, i, fits, verdict_template, folder);
    if (block.floor_pixels > 0) floors.push_back(floor_fields(block, scene.values["title"]));
    Fields noise;
    for (const char* name : {"title", "frame_count", "rounds"}) {
      noise.values[name] = scene.values[name];
    }
    noise.values["noise"] = block.drawn ? format_estimate(block.noise) : "nothing drawn";
    noises.push_back(std::move(noise));
    scenes.push_back(std::move(scene));
  }
  auto& gaps = fields.lists["missing_blocks"];
  for (const MissingCell& block : input.missing_blocks) {
    gaps.emplace_back();
    gaps.back().values["block"] = markdown_text(block.name);
    gaps.back().values["reason"] = markdown_text(block.reason);
  }
  fields.flag("has_floors", !floors.empty());
  fields.flag("has_diagrams", !in_diagrams.empty());
  const FloorSum floor = floor_of(in_diagrams);
  fields.values["diagram_blocks"] = format_count(in_diagrams.size());
  fields.values["diagram_floor"] = format_of(floor.disputed, floor.pixels);
  fields.values["diagram_undisputed"] = format_count(floor.undisputed);
  add_depth_fields(input, in_diagrams, folder, fields);
  fields.lists["surfaces"] = surface_fields(input, folder);
  fields.flag("has_surfaces", !fields.lists["surfaces"].empty());
  fields.lists["sweeps"] = sweep_fields(input.sweeps);
  fields.flag("has_sweeps", !fields.lists["sweeps"].empty());
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
