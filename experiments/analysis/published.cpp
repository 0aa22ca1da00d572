#include "experiments/analysis/published.h"

#include <algorithm>

#include "experiments/matrix/toml_keys.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;
using namespace toml_keys;

std::string text_of(const toml::table& table, std::string_view key, const std::string& file) {
  const auto text = value_of<std::string>(table, key, "a text", file);
  if (!text) throw InputError(place(file, table) + ": " + std::string(key) + " is missing");
  return *text;
}

double frames_a_second(const toml::table& table, std::string_view key, const std::string& file) {
  const auto value = value_of<double>(table, key, "a number", file);
  if (!value || !(*value > 0.0)) {
    throw InputError(place(file, table) + ": " + std::string(key) +
                     " must be a number of frames a second above 0");
  }
  return *value;
}

PublishedRow::Metric metric_of(const toml::table& table, const std::string& file) {
  using enum PublishedRow::Metric;
  const auto name = value_of<std::string>(table, "metric", "a text", file).value_or("frame_ms");
  std::vector<std::string> known;
  for (const auto& [text, metric] : {std::pair{"frame_ms", frame_ms},
                                     {"cull_us", cull_us},
                                     {"culled", culled},
                                     {"decision_share", decision_share}}) {
    if (name == text) return metric;
    known.emplace_back(text);
  }
  throw InputError(place(file, table) + ": " +
                   unknown_name("metric of a [[row]]", name, known).what());
}

PublishedRow read_row(const toml::table& table, const Registry& registry, const std::string& file) {
  refuse_unknown_keys(table,
                      {"what", "table", "without_fps", "with_fps", "published", "metric", "scene",
                       "path", "culler", "against", "cannot_be_told"},
                      "[[row]]", file);
  PublishedRow row;
  row.what = text_of(table, "what", file);
  row.table = text_of(table, "table", file);
  if (const auto published = value_of<std::string>(table, "published", "a text", file)) {
    row.published = *published;
  } else {
    row.without_fps = frames_a_second(table, "without_fps", file);
    row.with_fps = frames_a_second(table, "with_fps", file);
  }
  if (const auto why = value_of<std::string>(table, "cannot_be_told", "a text", file)) {
    for (const char* key : {"metric", "scene", "path", "culler", "against"}) {
      if (table.contains(key)) {
        throw InputError(place(file, table) + ": a row that cannot be told has no " + key);
      }
    }
    row.cannot_be_told = *why;
    return row;
  }
  row.metric = metric_of(table, file);
  if (row.is_share() && (row.published.empty() || table.contains("against"))) {
    throw InputError(place(file, table) +
                     ": a share has `published`, and nothing that it is against");
  }
  row.scene = text_of(table, "scene", file);
  row.path = value_of<std::string>(table, "path", "a text", file).value_or("");
  const std::string culler = text_of(table, "culler", file);
  const std::string against =
      value_of<std::string>(table, "against", "a text", file).value_or("none");
  try {
    row.culler = registry.canonical(culler);
    row.against = registry.canonical(against);
    row.short_culler = registry.short_name(culler);
    row.short_against = registry.short_name(against);
  } catch (const InputError& error) {
    throw InputError(place(file, table) + ": " + error.what());
  }
  return row;
}

PublishedFigures read_figures(const fs::path& path, const Registry& registry) {
  const std::string file = path.string();
  const toml::table root = parse_file(path);
  refuse_unknown_keys(root, {"title", "source", "note", "row"}, "published figures", file);
  PublishedFigures figures;
  figures.title = text_of(root, "title", file);
  figures.source = text_of(root, "source", file);
  figures.note = value_of<std::string>(root, "note", "a text", file).value_or("");
  const toml::array* const rows = tables(root, "row", file);
  if (rows == nullptr) throw InputError(file + ": there is no [[row]]");
  for (const toml::node& row : *rows) {
    figures.rows.push_back(read_row(*row.as_table(), registry, file));
  }
  return figures;
}

/// What the ratio is made of: ÷ none's for frame_ms, in µs for cull_us.
const Estimate& measure_of(const CellSummary& cell, PublishedRow::Metric metric) {
  return metric == PublishedRow::Metric::cull_us ? cell.cull_us.median : cell.against_none;
}

/// NaN if it was not measured.
double share_of(const CellSummary& cell, const CellSummary& none, PublishedRow::Metric metric) {
  if (metric == PublishedRow::Metric::culled) {
    return 1.0 - cell.submitted_triangles / none.submitted_triangles;
  }
  return (cell.update_us.median.value + cell.cull_us.median.value) / 1e3 /
         cell.frame_ms.median.value;
}

const CellSummary* find_cell(const BlockSummary& block, const std::string& chain,
                             PublishedRow::Metric metric) {
  const auto found = std::ranges::find_if(block.cells, [&](const CellSummary& cell) {
    return cell.canonical == chain && cell.replicate == 0 &&
           cell.status == ResultCell::Status::done && measure_of(cell, metric).measured();
  });
  return found == block.cells.end() ? nullptr : &*found;
}

/// Orders the blocks that may stand for a row: the more the better.
auto weight_of(const BlockSummary& block) {
  return std::pair(block.frames, block.viewport.width * block.viewport.height);
}

}  // namespace

std::vector<PublishedFigures> load_published(const fs::path& folder, const Registry& registry) {
  std::vector<fs::path> files;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::vector<PublishedFigures> all;
  for (const fs::path& file : files) all.push_back(read_figures(file, registry));
  return all;
}

OwnFigure own_figure(const PublishedRow& row, const std::vector<BlockSummary>& blocks) {
  OwnFigure own;
  if (!row.cannot_be_told.empty()) return own;
  for (const BlockSummary& block : blocks) {
    if (!block.device_models.empty()) continue;  // its times are nobody's to compare with
    if (block.scene != row.scene || (!row.path.empty() && block.path != row.path)) continue;
    const CellSummary* const cell = find_cell(block, row.culler, row.metric);
    const CellSummary* const against = find_cell(block, row.against, row.metric);
    if (cell == nullptr || against == nullptr) continue;
    if (own.block != nullptr && weight_of(block) <= weight_of(*own.block)) continue;
    if (row.is_share()) {
      const double share = share_of(*cell, *against, row.metric);
      own = {&block, cell, {share, share, share}};
      continue;
    }
    const Estimate& method = measure_of(*cell, row.metric);
    const Estimate& other = measure_of(*against, row.metric);
    // none's ratio to itself is 1, without an interval.
    const bool paired =
        row.metric == PublishedRow::Metric::frame_ms && against->canonical == "none";
    own = {&block, cell,
           paired ? Estimate{1.0 / method.value, 1.0 / method.high, 1.0 / method.low}
                  : Estimate{other.value / method.value, other.low / method.high,
                             other.high / method.low}};
  }
  return own;
}

}  // namespace vislab
