#include "experiments/analysis/published.h"

#include <algorithm>
#include <cmath>

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

PublishedRow::Metric metric_of(const std::string& name) {
  using enum PublishedRow::Metric;
  if (name == "frame_ms") return frame_ms;
  if (name == "cull_us") return cull_us;
  if (name == "culled") return culled;
  if (name == "decision_share") return decision_share;
  return named;
}

bool is_time(PublishedRow::Metric metric) {
  return metric == PublishedRow::Metric::frame_ms || metric == PublishedRow::Metric::cull_us;
}

/// Of the row, or what the tolerance of rows in frames a second makes of them.
void read_accept(const toml::table& table, double tolerance, const std::string& file,
                 PublishedRow& row) {
  const toml::node* const node = table.get("accept");
  if (node == nullptr && row.published.empty() && tolerance > 0.0) {
    row.accept = {row.ratio() / tolerance, row.ratio() * tolerance};
    return;
  }
  const toml::array* const bounds = node == nullptr ? nullptr : node->as_array();
  if (bounds != nullptr && bounds->size() == 2) {
    const auto low = (*bounds)[0].value<double>();
    const auto high = (*bounds)[1].value<double>();
    if (low && high && *low <= *high) {
      row.accept = {*low, *high};
      return;
    }
  }
  throw InputError(place(file, table) +
                   ": accept must be [low, high], from where to where our figure confirms the "
                   "claim, such as [1.0, inf]");
}

/// What stands for the claim here.
void read_place(const toml::table& table, const Registry& registry, const std::string& file,
                PublishedRow& row) {
  row.metric_name = value_of<std::string>(table, "metric", "a text", file).value_or("frame_ms");
  row.metric = metric_of(row.metric_name);
  row.scene = text_of(table, "scene", file);
  row.path = value_of<std::string>(table, "path", "a text", file).value_or("");
  if (const auto device = value_of<std::string>(table, "device", "a text", file)) {
    row.device = canonical_device(*device, table.get("device"), file);
  }
  row.against_scene = value_of<std::string>(table, "against_scene", "a text", file).value_or("");
  row.against_path = value_of<std::string>(table, "against_path", "a text", file).value_or("");
  if (row.compares_places() && is_time(row.metric)) {
    throw InputError(place(file, table) +
                     ": times of two places are not from the same rounds; compare what is drawn, "
                     "metric = \"submitted_triangles\"");
  }
  row.compares = is_time(row.metric) || table.contains("against") || row.compares_places();
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
}

PublishedRow read_row(const toml::table& table, double tolerance, const Registry& registry,
                      const std::string& file) {
  refuse_unknown_keys(
      table,
      {"what", "table", "without_fps", "with_fps", "published", "accept", "metric", "scene", "path",
       "device", "culler", "against", "against_scene", "against_path", "cannot_be_told"},
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
    const bool has_figure = row.published.empty() && table.contains("scene");
    for (const std::string_view key : {"accept", "metric", "scene", "path", "device", "culler",
                                       "against", "against_scene", "against_path"}) {
      if (has_figure && (key == "scene" || key == "path" || key == "culler")) continue;
      if (table.contains(key)) {
        throw InputError(place(file, table) + ": a row that cannot be told has no " +
                         std::string(key));
      }
    }
    row.cannot_be_told = *why;
    if (has_figure) read_place(table, registry, file, row);
    return row;
  }
  read_place(table, registry, file, row);
  read_accept(table, tolerance, file, row);
  return row;
}

PublishedFigures read_figures(const fs::path& path, const Registry& registry) {
  const std::string file = path.string();
  const toml::table root = parse_file(path);
  refuse_unknown_keys(root, {"title", "source", "note", "tolerance", "stand_ins", "row"},
                      "published figures", file);
  PublishedFigures figures;
  figures.title = text_of(root, "title", file);
  figures.source = text_of(root, "source", file);
  figures.note = value_of<std::string>(root, "note", "a text", file).value_or("");
  const double tolerance = value_of<double>(root, "tolerance", "a factor", file).value_or(0.0);
  if (root.contains("tolerance") && !(tolerance >= 1.0)) {
    throw InputError(place(file, *root.get("tolerance")) + ": tolerance must be a factor from 1");
  }
  const toml::node* const stand_ins = root.get("stand_ins");
  if (stand_ins != nullptr && !stand_ins->is_table()) {
    throw InputError(place(file, *stand_ins) + ": write [stand_ins]");
  }
  const toml::array* const rows = tables(root, "row", file);
  if (rows == nullptr) throw InputError(file + ": there is no [[row]]");
  for (const toml::node& row : *rows) {
    figures.rows.push_back(read_row(*row.as_table(), tolerance, registry, file));
    if (stand_ins == nullptr) continue;
    const auto stand_in =
        value_of<std::string>(*stand_ins->as_table(), figures.rows.back().scene, "a text", file);
    figures.rows.back().stand_in = stand_in.value_or("");
  }
  return figures;
}

/// The figure that the row is about, of one method: ÷ none's for frame_ms, in µs for cull_us.
Estimate measure_of(const CellSummary& cell, const CellSummary& none, const PublishedRow& row) {
  const auto exact = [](double value) { return Estimate{value, value, value}; };
  switch (row.metric) {
    case PublishedRow::Metric::frame_ms:
      return cell.against_none;
    case PublishedRow::Metric::cull_us:
      return cell.cull_us.median;
    case PublishedRow::Metric::culled:
      return exact(1.0 - cell.submitted_triangles / none.submitted_triangles);
    case PublishedRow::Metric::decision_share: {
      const Estimate& update = cell.update_us.median;
      const Estimate& cull = cell.cull_us.median;
      const Estimate& frame = cell.frame_ms.median;
      return {(update.value + cull.value) / 1e3 / frame.value,
              (update.low + cull.low) / 1e3 / frame.high,
              (update.high + cull.high) / 1e3 / frame.low};
    }
    case PublishedRow::Metric::named:
      break;
  }
  if (row.metric_name == "frame_ms_deviation") return cell.frame_ms.deviation;
  return exact(cell.metric(row.metric_name));
}

const CellSummary* find_cell(const BlockSummary& block, const std::string& chain) {
  const auto found = std::ranges::find_if(block.cells, [&](const CellSummary& cell) {
    return cell.canonical == chain && cell.replicate == 0 &&
           cell.status == ResultCell::Status::done;
  });
  return found == block.cells.end() ? nullptr : &*found;
}

/// Errors of both are independent, and of ratios: they add up as squares of logarithms.
Estimate quotient(const Estimate& above, const Estimate& below) {
  const double value = above.value / below.value;
  if (!(above.low > 0.0) || !(below.low > 0.0)) return {value, value, value};
  const double down =
      std::hypot(std::log(above.value / above.low), std::log(below.high / below.value));
  const double up =
      std::hypot(std::log(above.high / above.value), std::log(below.value / below.low));
  return {value, value * std::exp(-down), value * std::exp(up)};
}

/// NaN if a part of it was not measured. `there` is the block of `against`.
Estimate figure_of(const BlockSummary& block, const CellSummary& cell, const BlockSummary& there,
                   const PublishedRow& row) {
  const CellSummary* const none = find_cell(block, "none");
  const CellSummary* const against = find_cell(there, row.against);
  const CellSummary* const none_there = find_cell(there, "none");
  if (none == nullptr || against == nullptr || none_there == nullptr) return Estimate::none();
  const Estimate own = measure_of(cell, *none, row);
  if (!row.compares || !own.measured()) return own;
  if (row.metric == PublishedRow::Metric::frame_ms && against == none) {
    // none's ratio to itself is 1, without an interval.
    return {1.0 / own.value, 1.0 / own.high, 1.0 / own.low};
  }
  const Estimate other = measure_of(*against, *none_there, row);
  return is_time(row.metric) ? quotient(other, own) : quotient(own, other);
}

/// What OwnFigure::reach is; `there` is the block of `against`.
double reach_of(const BlockSummary& block, const BlockSummary& there, const PublishedRow& row) {
  const bool is_share = row.metric == PublishedRow::Metric::culled && !row.compares;
  const bool is_frame = row.metric == PublishedRow::Metric::frame_ms;
  double best = std::numeric_limits<double>::quiet_NaN();
  if (!is_share && !is_frame) return best;
  for (const CellSummary& cell : block.cells) {
    if (!cell.anchor || !cell.canonical.starts_with("oracle")) continue;
    if (cell.status != ResultCell::Status::done) continue;
    const Estimate figure = figure_of(block, cell, there, row);
    if (figure.measured() && !(best >= figure.high)) best = figure.high;
  }
  return best;
}

/// Where `against` stands: in the block itself, or in another of the same resolution, device and
/// machine. Null if it was not measured.
const BlockSummary* place_of_other(const BlockSummary& block, const PublishedRow& row,
                                   const std::vector<BlockSummary>& blocks) {
  if (!row.compares_places()) return find_cell(block, row.against) == nullptr ? nullptr : &block;
  const std::string& scene = row.against_scene.empty() ? block.scene : row.against_scene;
  const std::string& path = row.against_path.empty() ? block.path : row.against_path;
  const BlockSummary* best = nullptr;
  for (const BlockSummary& other : blocks) {
    const bool is_like = other.viewport.width == block.viewport.width &&
                         other.viewport.height == block.viewport.height &&
                         other.device == block.device && other.machines == block.machines;
    if (other.scene != scene || other.path != path || !is_like) continue;
    if (find_cell(other, row.against) == nullptr) continue;
    if (best == nullptr || other.frames > best->frames) best = &other;
  }
  return best;
}

/// Orders the blocks that may stand for a row: the more the better.
auto weight_of(const BlockSummary& block) {
  return std::pair(block.frames, block.viewport.width * block.viewport.height);
}

/// Is the row's figure made of times that a clock measured? Those of a modelled device repeat.
bool is_wall_time(const PublishedRow& row, const BlockSummary& block) {
  using enum PublishedRow::Metric;
  const bool is_device_clock = !block.device_models.empty();
  switch (row.metric) {
    case frame_ms:
      return !is_device_clock;
    case cull_us:
    case decision_share:
      return true;
    case culled:
      return false;
    case named:
      break;
  }
  const std::string& name = row.metric_name;
  if (name == "build_ms" || name == "update_us") return true;
  return !is_device_clock && (name == "draw_ms" || name == "frame_ms_deviation");
}

/// The figure with an interval as wide as the noise of the block's times asks for.
Estimate with_noise(const PublishedRow& row, const OwnFigure& own) {
  if (own.block == nullptr || !is_wall_time(row, *own.block)) return own.ratio;
  const Estimate noise = noise_band(own.block->noise);
  return {own.ratio.value, own.ratio.low * noise.low, own.ratio.high * noise.high};
}

ClaimVerdict verdict_of(const PublishedRow& row, const OwnFigure& own, const Estimate& figure) {
  if (!row.cannot_be_told.empty()) return ClaimVerdict::cannot_be_told;
  if (own.cell == nullptr) return ClaimVerdict::not_run;
  if (figure.low >= row.accept.low && figure.high <= row.accept.high) {
    return ClaimVerdict::confirmed;
  }
  if (own.is_out_of_reach(row)) return ClaimVerdict::cannot_be_told;
  if (figure.high < row.accept.low || figure.low > row.accept.high) {
    return ClaimVerdict::not_confirmed;
  }
  return ClaimVerdict::cannot_be_told;
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
  if (row.scene.empty()) return own;
  for (const BlockSummary& block : blocks) {
    // The times of a modelled device are nobody's to compare with who does not ask for it.
    if (row.device.empty() ? !block.device_models.empty() : block.device != row.device) continue;
    if (block.scene != row.scene || (!row.path.empty() && block.path != row.path)) continue;
    const CellSummary* const cell = find_cell(block, row.culler);
    const BlockSummary* const there = place_of_other(block, row, blocks);
    if (cell == nullptr || there == nullptr) continue;
    if (own.block != nullptr && weight_of(block) <= weight_of(*own.block)) continue;
    const Estimate figure = figure_of(block, *cell, *there, row);
    // Times that were not taken are no figure; 0 against 0 is one that says nothing.
    if (is_time(row.metric) && !figure.measured()) continue;
    own = {&block, cell, there == &block ? nullptr : there, figure, reach_of(block, *there, row)};
  }
  return own;
}

std::string to_string(ClaimVerdict verdict) {
  switch (verdict) {
    case ClaimVerdict::confirmed:
      return "confirmed";
    case ClaimVerdict::not_confirmed:
      return "not confirmed";
    case ClaimVerdict::cannot_be_told:
      return "cannot be told";
    case ClaimVerdict::not_run:
      break;
  }
  return "not run";
}

ClaimVerdict verdict_of(const PublishedRow& row, const OwnFigure& own) {
  return verdict_of(row, own, with_noise(row, own));
}

bool noise_decides(const PublishedRow& row, const OwnFigure& own) {
  return verdict_of(row, own) != verdict_of(row, own, own.ratio);
}

}  // namespace vislab
