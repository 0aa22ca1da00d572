#include "report/scene_section.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "common/scene/error.h"
#include "report/chart.h"
#include "report/finding.h"
#include "report/format.h"
#include "report/sections.h"

namespace vislab {
namespace {

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
  row.values["p95"] = format_number(cell.frame_ms.p95);
  row.values["p99"] = format_number(cell.frame_ms.p99);
  row.values["worst"] = format_number(cell.frame_ms.worst);
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
  return "[0 (< " + format_scientific(3.0 / static_cast<double>(cell.jittered)) + ")]{.bound}";
}

/// Of how many pixels the cells' figures are, if all are of the same number; else 0.
std::uint64_t common_pixels(const BlockSummary& block) {
  std::set<std::uint64_t> numbers;
  for (const CellSummary& cell : block.cells) {
    if (cell.judged) numbers.insert(cell.pixels);
  }
  return numbers.size() == 1 ? *numbers.begin() : 0;
}

/// `pixels` is the number that all cells share, which then need not stand in every row.
Fields accuracy_fields(const CellSummary& cell, std::size_t number, std::uint64_t pixels) {
  const auto count = [&](std::uint64_t wrong) {
    return pixels > 0 ? format_count(wrong) : format_of(wrong, cell.pixels);
  };
  Fields row;
  row.values["number"] = std::to_string(number);
  row.values["method"] = markdown_code(cell.culler);
  row.values["guarantee"] = markdown_text(to_string(cell.guarantee));
  row.values["submitted"] = format_number(cell.submitted_triangles);
  row.values["over"] = format_number(cell.over);
  row.values["recall"] = format_percent(cell.recall);
  row.values["false_px"] = count(cell.false_px);
  row.values["max_false_px"] = format_count(cell.max_false_px);
  row.values["false_objects"] = format_count(cell.false_objects);
  row.values["false_triangles"] = format_count(cell.false_triangles);
  row.values["image_px"] = cell.drawn ? count(cell.image_px) : "not drawn";
  row.values["surface_px"] = cell.paints ? count(cell.surface_px) : "–";
  row.values["jittered"] = lost_rays(cell);
  return row;
}

/// Why a cell is missing from a table, if it is.
std::string what_is_missing(const CellSummary& cell) {
  if (cell.status == ResultCell::Status::failed) return "failed";
  if (cell.status == ResultCell::Status::running) return "not finished";
  if (!cell.judged) return "not judged";
  return {};
}

/// What is missing from a block, with the reasons; methods with the same reason stand together.
std::vector<Fields> gaps_of(const ReportInput& input, const BlockSummary& block) {
  std::vector<Fields> gaps;
  const auto add = [&](const std::string& name, const std::string& what,
                       const std::string& reason) {
    const std::string text = markdown_text(reason);
    const auto same = std::ranges::find_if(gaps, [&](const Fields& gap) {
      return gap.values.at("what") == what && gap.values.at("reason") == text;
    });
    if (same != gaps.end()) {
      same->values["method"] += ", " + markdown_code(name);
      return;
    }
    gaps.emplace_back();
    gaps.back().values["method"] = markdown_code(name);
    gaps.back().values["what"] = what;
    gaps.back().values["reason"] = text;
  };
  for (const CellSummary& cell : block.cells) {
    const std::string what = what_is_missing(cell);
    if (what.empty()) continue;
    add(cell.culler, what, cell.reason.empty() ? "another run goes on with it" : cell.reason);
  }
  if (!input.missing_cells) return gaps;
  for (const MissingCell& cell : input.missing_cells(block)) {
    add(cell.name, "missing", cell.reason);
  }
  return gaps;
}

void add_tables(const BlockSummary& block, const DeviceFits& fits, Fields& fields) {
  auto& speed = fields.lists["speed"];
  auto& accuracy = fields.lists["accuracy"];
  const std::uint64_t pixels = common_pixels(block);
  for (std::size_t i = 0; i < block.cells.size(); ++i) {
    const CellSummary& cell = block.cells[i];
    if (cell.frame_ms.measured()) {
      speed.push_back(speed_fields(cell, i + 1, fits.name_of(block, cell)));
    }
    if (cell.judged) accuracy.push_back(accuracy_fields(cell, i + 1, pixels));
  }
  fields.flag("has_common_pixels", pixels > 0);
  fields.flag("has_painted", std::ranges::any_of(block.cells, &CellSummary::paints));
  fields.values["pixels"] = format_count(pixels);
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

Fields block_fields(const ReportInput& input, std::size_t index, const DeviceFits& fits,
                    const std::string& verdict_template, const std::filesystem::path& folder) {
  const BlockSummary& block = input.blocks[index];
  const std::string title = markdown_text(title_of(input.blocks, block));
  Fields fields;
  fields.values["title"] = title;
  fields.values["scene_name"] = markdown_text(block.scene);
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
  fields.flag("mixed_machines", !is_of_one_machine(block));
  fields.values["machine_count"] = std::to_string(block.machines.size());
  const bool charted = !charted_cells(block).empty();
  fields.flag("chart", charted);
  fields.values["file"] = chart_file_name(index);
  fields.values["x_meaning"] =
      has_time_axis(block) ? "median time of a frame" : "triangles submitted per frame";
  add_tables(block, fits, fields);
  add_pictures(input, block, index, folder, fields);
  return fields;
}

/// A block that has no section of its own, in one row.
Fields other_fields(const BlockSummary& block) {
  Fields row;
  row.values["path"] = markdown_text(block.path.empty() ? "–" : block.path);
  row.values["size"] = std::to_string(block.viewport.width) + " × " +
                       std::to_string(block.viewport.height) + ", " + std::to_string(block.frames);
  row.values["device"] = markdown_code(block.device);
  const auto methods =
      std::ranges::count_if(block.cells, [](const CellSummary& cell) { return !cell.anchor; });
  row.values["methods"] = std::to_string(methods);
  const Finding finding = find(block);
  for (const char* name : {"best", "against_none", "over", "worst"}) row.values[name] = "–";
  if (finding.best != nullptr) {
    row.values["best"] = markdown_code(finding.best->culler);
    row.values["against_none"] = format_estimate(finding.best->against_none);
    row.values["over"] = format_number(finding.best->over);
  }
  const CellSummary* worst = nullptr;
  for (const CellSummary& cell : block.cells) {
    if (!cell.judged || cell.false_px == 0) continue;
    if (worst == nullptr || cell.false_px > worst->false_px) worst = &cell;
  }
  if (worst != nullptr) {
    row.values["worst"] =
        markdown_code(worst->culler) + ", " +
        format_percent(static_cast<double>(worst->false_px) / static_cast<double>(worst->pixels));
  }
  return row;
}

/// How much a block has to tell: measured methods that are no anchors, then frames, then pixels.
std::tuple<std::size_t, int, int> weight(const BlockSummary& block) {
  const auto methods = std::ranges::count_if(block.cells, [](const CellSummary& cell) {
    return !cell.anchor && cell.judged && cell.frame_ms.measured();
  });
  return {static_cast<std::size_t>(methods) * (has_time_axis(block) ? 2 : 1), block.frames,
          block.viewport.width * block.viewport.height};
}

}  // namespace

std::vector<ShownScene> shown_scenes(const std::vector<BlockSummary>& blocks,
                                     const std::vector<const BlockSummary*>& in_diagrams) {
  std::vector<ShownScene> scenes;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (std::ranges::count(in_diagrams, &blocks[i]) > 0) continue;
    const auto known = std::ranges::find_if(scenes, [&](const ShownScene& scene) {
      return blocks[scene.block].scene == blocks[i].scene;
    });
    if (known == scenes.end()) {
      scenes.push_back({i, {}});
      continue;
    }
    known->others.push_back(i);
    if (weight(blocks[i]) > weight(blocks[known->block])) {
      std::swap(known->block, known->others.back());
      std::ranges::sort(known->others);
    }
  }
  return scenes;
}

Fields scene_fields(const ReportInput& input, const ShownScene& scene, const DeviceFits& fits,
                    const std::string& verdict_template, const std::filesystem::path& folder) {
  Fields fields = block_fields(input, scene.block, fits, verdict_template, folder);
  auto& gaps = fields.lists["not_measured"];
  gaps = gaps_of(input, input.blocks[scene.block]);
  auto& others = fields.lists["others"];
  for (const std::size_t other : scene.others) {
    const BlockSummary& block = input.blocks[other];
    others.push_back(other_fields(block));
    for (Fields& gap : gaps_of(input, block)) {
      gap.values["what"] +=
          ", on " + others.back().values["path"] + ", " + others.back().values["device"];
      gaps.push_back(std::move(gap));
    }
  }
  fields.flag("has_others", !others.empty());
  fields.flag("has_not_measured", !gaps.empty());
  return fields;
}

}  // namespace vislab
