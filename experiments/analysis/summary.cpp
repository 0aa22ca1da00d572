#include "experiments/analysis/summary.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "experiments/analysis/errors.h"
#include "experiments/analysis/modelled_time.h"

namespace vislab {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* none_chain = "none";
constexpr const char* no_device = "none";  // nothing is drawn

bool is_none(const CellKey& key) { return key.chain == none_chain; }

bool is_oracle(const std::string& chain) {
  return chain.starts_with("oracle") && chain.find('>') == std::string::npos;
}

/// nan where there is nothing to compare with.
double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? nan : static_cast<double>(part) / static_cast<double>(whole);
}

TimeSummary summarise_time(const std::vector<Round>& rounds, std::vector<double> Round::*samples) {
  SampleGrid grid;
  std::vector<double> all;
  SampleGrid later;
  for (const Round& round : rounds) {
    grid.push_back(round.*samples);
    const RoundSamples& last = grid.back();
    all.insert(all.end(), last.begin(), last.end());
    if (last.size() > 1) later.emplace_back(last.begin() + 1, last.end());
  }
  TimeSummary time;
  time.median = median_of_frames(grid);
  time.worst = all.empty() ? nan : *std::ranges::max_element(all);
  time.deviation = standard_deviation(later);
  time.p95 = quantile(all, 0.95);
  time.p99 = quantile(std::move(all), 0.99);
  return time;
}

/// Frame times of an anchor in the same rounds as the cell's, by session and number.
using RoundTimes = std::map<std::pair<std::string, int>, RoundSamples>;

RoundTimes times_of(const std::vector<AnchorRound>& rounds) {
  RoundTimes times;
  for (const AnchorRound& round : rounds) times[{round.session, round.number}] = round.frame_ms;
  return times;
}

/// The cell's frame times and the anchor's where both measured the same round.
struct Pairs {
  SampleGrid cell, anchor;
};

Pairs pair_rounds(const ResultCell& cell, const RoundTimes& anchor) {
  Pairs pairs;
  for (const Round& round : cell.rounds) {
    const auto found = anchor.find({round.session, round.number});
    if (found == anchor.end() || found->second.size() != round.frame_ms.size()) continue;
    pairs.cell.push_back(round.frame_ms);
    pairs.anchor.push_back(found->second);
  }
  return pairs;
}

/// Times of the anchor that was measured beside the cell; empty if there was none.
RoundTimes anchor_times(const ResultCell& cell, const std::string& chain) {
  const auto found = cell.anchors.find(chain);
  return found == cell.anchors.end() ? RoundTimes{} : times_of(found->second);
}

/// The chain of the oracle of that level that was measured beside the cell, or that the cell is of;
/// "" if none was. It may have further parameters.
std::string oracle_of(const ResultCell& cell) {
  const std::string level = "oracle[level=" + std::string(to_string(cell.granularity));
  const auto fits = [&](const std::string& chain) {
    return is_oracle(chain) && (chain.starts_with(level + "]") || chain.starts_with(level + ","));
  };
  if (fits(cell.key.chain)) return cell.key.chain;
  for (const auto& [chain, rounds] : cell.anchors) {
    if (fits(chain)) return chain;
  }
  return {};
}

/// A cell as its own anchor pairs with itself, whether or not the harness wrote it down twice.
RoundTimes own_times(const ResultCell& cell) {
  RoundTimes times;
  for (const Round& round : cell.rounds) times[{round.session, round.number}] = round.frame_ms;
  return times;
}

RoundTimes anchor_or_own(const ResultCell& cell, const std::string& chain) {
  const bool own = cell.key.chain == chain && cell.key.replicate == 0;
  return own ? own_times(cell) : anchor_times(cell, chain);
}

/// Triangles culled and cullable by a perfect method of the kind.
const CulledOf& culled_of(Culls culls, const CellVerdicts& verdicts, const CulledOf& hidden) {
  switch (culls) {
    case Culls::back_faces:
      return verdicts.back_facing;
    case Culls::outside_frustum:
      return verdicts.outside;
    case Culls::hidden:
      break;
  }
  return hidden;
}

void find_worst_frame(const CellVerdicts& verdicts, CellSummary& summary) {
  const std::size_t frames = summary.paints ? verdicts.surfaces.size() : verdicts.frames.size();
  for (std::size_t i = 0; i < frames; ++i) {
    const std::uint64_t wrong =
        summary.paints ? verdicts.surfaces[i].surface_px : verdicts.frames[i].false_px;
    if (wrong <= summary.worst_frame_px) continue;
    summary.worst_frame = i;
    summary.worst_frame_px = wrong;
  }
}

void summarise_accuracy(const CellVerdicts& verdicts, Culls culls, CellSummary& summary) {
  std::uint64_t visible_triangles = 0, visible_objects = 0, kept_objects = 0;
  std::uint64_t over_triangles = 0, over_objects = 0, under_triangles = 0, hidden_triangles = 0;
  for (const Verdict& v : verdicts.frames) {
    summary.pixels += v.pixels;
    summary.false_px += v.false_px;
    summary.max_false_px = std::max(summary.max_false_px, v.max_false_px);
    summary.false_objects += v.false_objects;
    summary.false_triangles += v.false_triangles;
    summary.false_jittered += v.false_jittered;
    summary.jittered += v.jittered;
    summary.excused_px += v.disputed_lost_px;
    visible_triangles += v.visible_triangles;
    visible_objects += v.visible_objects;
    kept_objects += v.kept_objects;
    over_triangles += v.over_triangles_count;
    over_objects += v.over_objects_count;
    under_triangles += v.under_triangles_count;
    hidden_triangles += v.scene_triangles - std::min(v.scene_triangles, v.visible_triangles);
  }
  for (const ImageVerdict& image : verdicts.images) {
    summary.image_px += image.image_px;
    summary.disputed_image_px += image.disputed_image_px;
  }
  summary.paints = !verdicts.surfaces.empty();
  for (const SurfaceVerdict& surface : verdicts.surfaces) {
    summary.surface_px += surface.surface_px;
    summary.disputed_surface_px += surface.disputed_surface_px;
  }
  find_worst_frame(verdicts, summary);
  summary.disputed_px = verdicts.floor_disputed_px;
  summary.drawn = !verdicts.images.empty();
  summary.judged = !verdicts.frames.empty();
  summary.over = ratio(over_triangles, visible_triangles);
  summary.over_objects = ratio(over_objects, visible_objects);
  summary.under = ratio(under_triangles, visible_triangles);
  const CulledOf hidden{hidden_triangles,
                        hidden_triangles - std::min(hidden_triangles, over_triangles)};
  const CulledOf& kind = culled_of(culls, verdicts, hidden);
  summary.recall = ratio(kind.culled, kind.cullable);
  summary.flicker = verdicts.frames.size() < 2
                        ? 0.0
                        : ratio(verdicts.stability.toggles, verdicts.frames.size() - 1);
  summary.pop_px_frames = verdicts.stability.pop_px_frames;
  summary.latency_frames = verdicts.stability.latency_frames;
  summary.visible_triangles = ratio(visible_triangles, verdicts.frames.size());
  summary.kept_objects = ratio(kept_objects, verdicts.frames.size());
}

std::string machine_of(const ResultCell& cell) {
  const auto found = cell.context.find("machine");
  return found == cell.context.end() ? std::string() : found->second;
}

CellSummary summarise_cell(const JudgedCell& judged) {
  const ResultCell& cell = judged.cell;
  CellSummary summary;
  summary.id = cell.key.id();
  summary.culler = cell.culler;
  summary.replicate = cell.key.replicate;
  if (summary.replicate > 0 && !summary.culler.ends_with("(again)")) summary.culler += " (again)";
  summary.canonical = cell.key.chain;
  summary.asks_device = cell.asks_device;
  summary.anchor = is_none(cell.key) || is_oracle(cell.key.chain);
  summary.status = cell.status;
  summary.reason = cell.reason;
  summary.guarantee = cell.guarantee;
  summary.repeatability = cell.repeatability;
  summary.granularity = cell.granularity;
  summary.culls = cell.culls;
  summary.rounds = static_cast<int>(cell.rounds.size());
  for (const Round& round : cell.rounds) summary.sessions.insert(round.session);
  summary.machine = machine_of(cell);
  summary.calibrated = cell.costs.has_value();
  summary.build_ms = cell.build_ms;
  summary.bytes = cell.bytes;
  summary.regions = cell.regions;

  std::uint64_t submitted = 0, draws = 0, pieces = 0;
  std::map<std::string, std::uint64_t> counters;
  for (const CellFrame& frame : cell.frames) {
    submitted += frame.submitted_triangles;
    draws += frame.draws;
    pieces += frame.pieces;
    for (const auto& [name, value] : frame.counters) counters[name] += value;
  }
  summary.submitted_triangles = ratio(submitted, cell.frames.size());
  summary.draws = ratio(draws, cell.frames.size());
  summary.pieces = ratio(pieces, cell.frames.size());
  for (const auto& [name, value] : counters) {
    summary.counters[name] = ratio(value, cell.frames.size());
  }
  summary.over = summary.over_objects = summary.under = summary.recall = nan;
  summary.visible_triangles = summary.kept_objects = nan;
  if (judged.verdicts) summarise_accuracy(*judged.verdicts, cell.culls, summary);

  summary.update_us = summarise_time(cell.rounds, &Round::update_us);
  summary.cull_us = summarise_time(cell.rounds, &Round::cull_us);
  summary.draw_ms = summarise_time(cell.rounds, &Round::draw_ms);
  summary.frame_ms = summarise_time(cell.rounds, &Round::frame_ms);
  summary.against_none = summary.efficiency = Estimate::none();
  if (cell.key.device == no_device) return summary;
  const Pairs none = pair_rounds(cell, anchor_or_own(cell, none_chain));
  summary.against_none = paired_ratio(none.cell, none.anchor);
  const Pairs oracle = pair_rounds(cell, anchor_or_own(cell, oracle_of(cell)));
  summary.efficiency = paired_ratio(oracle.anchor, oracle.cell);
  return summary;
}

/// Sorts names as people do, hares_56 before hares_252: numbers count by their value.
std::string sortable(const std::string& name) {
  constexpr std::size_t digits = 12;
  std::string key;
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t end = std::min(name.find_first_not_of("0123456789", at), name.size());
    if (end > at) key.append(digits - std::min(digits, end - at), '0');
    key.append(name, at, std::max<std::size_t>(end - at, 1));
    at = std::max(end, at + 1);
  }
  return key;
}

/// What a block is: equal for all cells that may be compared.
auto block_key(const ResultCell& cell) {
  return std::tuple(sortable(cell.scene), sortable(cell.path), cell.scene, cell.path,
                    cell.key.scene_hash, cell.key.path_hash, cell.key.viewport.width,
                    cell.key.viewport.height, cell.key.device, cell.key.threads, cell.key.seed);
}

/// none, its control, the oracles from coarse to fine, then all others by name.
auto cell_order(const CellSummary& cell) {
  const int group = cell.canonical == none_chain ? 0 : cell.anchor ? 1 : 2;
  return std::tuple(group, group == 0 ? std::string() : cell.culler, cell.replicate, cell.id);
}

std::map<std::string, CostTable> costs_by_machine(const std::vector<const JudgedCell*>& cells) {
  std::map<std::string, std::vector<CostTable>> tables;
  for (const JudgedCell* judged : cells) {
    if (judged->cell.costs) tables[machine_of(judged->cell)].push_back(*judged->cell.costs);
  }
  std::map<std::string, CostTable> costs;
  for (const auto& [machine, list] : tables) costs[machine] = median_table(list);
  return costs;
}

/// The facts that not all cells agree on; a cell without the fact does not differ.
std::map<std::string, std::vector<std::string>> mixed_context(
    const std::vector<const JudgedCell*>& cells) {
  std::map<std::string, std::set<std::string>> facts;
  for (const JudgedCell* judged : cells) {
    for (const auto& [name, text] : judged->cell.context) facts[name].insert(text);
  }
  std::map<std::string, std::vector<std::string>> mixed;
  for (const auto& [name, texts] : facts) {
    if (texts.size() > 1) mixed[name].assign(texts.begin(), texts.end());
  }
  return mixed;
}

BlockSummary summarise_block(const std::vector<const JudgedCell*>& cells) {
  const ResultCell& first = cells.front()->cell;
  BlockSummary block;
  block.scene = first.scene;
  block.scene_description = first.scene_description;
  block.path = first.path;
  block.scene_hash = first.key.scene_hash;
  block.path_hash = first.key.path_hash;
  block.viewport = first.key.viewport;
  block.device = first.key.device;
  block.drawn = block.device != no_device;
  block.threads = first.key.threads;
  block.seed = first.key.seed;
  block.objects = first.scene_objects;
  block.triangles = first.scene_triangles;
  block.moving_objects = first.moving_objects;
  block.context = first.context;
  block.mixed_context = mixed_context(cells);
  block.noise = Estimate::none();
  block.costs = costs_by_machine(cells);
  for (const JudgedCell* cell : cells) {
    block.frames = std::max(block.frames, static_cast<int>(cell->cell.frames.size()));
    block.cells.push_back(summarise_cell(*cell));
    CellSummary& summary = block.cells.back();
    if (const auto& model = cell->cell.device_model) {
      const auto known = std::ranges::find(block.device_models, *model);
      summary.device_model = static_cast<std::size_t>(known - block.device_models.begin());
      if (known == block.device_models.end()) block.device_models.push_back(*model);
    }
    if (is_none(cell->cell.key) && summary.replicate > 0) block.noise = summary.against_none;
    // The floor belongs to the frames, not to the culler: every drawn cell has the same.
    if (block.floor_pixels == 0 && summary.drawn) {
      block.floor_pixels = summary.pixels;
      block.floor_disputed_px = cell->verdicts->floor_disputed_px;
      block.floor_undisputed_px = cell->verdicts->floor_undisputed_px;
    }
    if (!summary.machine.empty() && !std::ranges::count(block.machines, summary.machine)) {
      block.machines.push_back(summary.machine);
    }
  }
  std::ranges::sort(block.machines);
  std::ranges::sort(block.cells, {}, cell_order);
  model_frame_times(block);
  return block;
}

}  // namespace

double CellSummary::metric(const std::string& name) const {
  const auto if_judged = [&](std::uint64_t count) {
    return judged ? static_cast<double>(count) : nan;
  };
  if (name == "false_px") return if_judged(false_px);
  if (name == "max_false_px") return if_judged(max_false_px);
  if (name == "false_objects") return if_judged(false_objects);
  if (name == "false_triangles") return if_judged(false_triangles);
  if (name == "false_jittered") return if_judged(false_jittered);
  if (name == "image_px") return drawn ? static_cast<double>(image_px) : nan;
  if (name == "disputed_image_px") return drawn ? static_cast<double>(disputed_image_px) : nan;
  if (name == "surface_px") return paints ? static_cast<double>(surface_px) : nan;
  if (name == "disputed_surface_px") {
    return paints ? static_cast<double>(disputed_surface_px) : nan;
  }
  if (name == "excused_px") return if_judged(excused_px);
  if (name == "disputed_px") return drawn ? static_cast<double>(disputed_px) : nan;
  if (name == "over") return over;
  if (name == "over_objects") return over_objects;
  if (name == "under") return under;
  if (name == "region_misses") return regions ? static_cast<double>(regions->misses) : nan;
  if (name == "region_over") return regions ? regions->over() : nan;
  if (name == "region_over_points") return regions ? regions->over_points() : nan;
  if (name == "recall") return recall;
  if (name == "flicker") return judged ? flicker : nan;
  if (name == "pop") return if_judged(pop_px_frames);
  if (name == "latency") return if_judged(latency_frames);
  if (name == "build_ms") return build_ms;
  if (name == "update_us") return update_us.median.value;
  if (name == "cull_us") return cull_us.median.value;
  if (name == "draw_ms") return draw_ms.median.value;
  if (name == "frame_ms") return frame_ms.median.value;
  if (name == "frame_ms_deviation") return frame_ms.deviation.value;
  if (name == "modelled_frame_ms") return modelled_frame_ms;
  if (name == "bytes") return static_cast<double>(bytes);
  if (name == "submitted_triangles") return submitted_triangles;
  if (name == "efficiency") return efficiency.value;
  if (const auto found = counters.find(name); found != counters.end()) return found->second;
  return nan;
}

bool is_free_of_errors(const CellSummary& cell) {
  if (!cell.judged) return false;
  const bool between_pixels = counts_between_pixels({&cell.guarantee, 1});
  const ErrorCounts counts = error_counts(cell);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > 0 && (between_pixels || !error_kinds[i].between_pixels)) return false;
  }
  return true;
}

bool is_of_one_machine(const BlockSummary& block) { return block.machines.size() <= 1; }

Estimate noise_band(const Estimate& noise) {
  if (!noise.measured()) return {1.0, 0.0, std::numeric_limits<double>::infinity()};
  return {noise.value, std::min(1.0, noise.low), std::max(1.0, noise.high)};
}

AgainstNone told_against_none(const BlockSummary& block, const Estimate& ratio) {
  const Estimate band = noise_band(block.noise);
  if (ratio.high < band.low) return AgainstNone::faster;
  if (ratio.low > band.high) return AgainstNone::slower;
  return AgainstNone::alike;
}

bool is_sooner(const BlockSummary& block, const Estimate& a, const Estimate& b) {
  const auto rank = [&](const Estimate& ratio) {
    return std::pair(told_against_none(block, ratio) != AgainstNone::faster, ratio.value);
  };
  return rank(a) < rank(b);
}

std::vector<BlockSummary> summarise(const std::vector<JudgedCell>& cells) {
  std::map<decltype(block_key(cells.front().cell)), std::vector<const JudgedCell*>> blocks;
  for (const JudgedCell& cell : cells) blocks[block_key(cell.cell)].push_back(&cell);
  std::vector<const std::vector<const JudgedCell*>*> members_of;
  for (const auto& [key, members] : blocks) members_of.push_back(&members);
  std::vector<BlockSummary> summaries(members_of.size());
  // Summing up thousands of cells takes seconds; blocks have nothing to do with each other.
  tbb::parallel_for(std::size_t{0}, members_of.size(),
                    [&](std::size_t i) { summaries[i] = summarise_block(*members_of[i]); });
  return summaries;
}

}  // namespace vislab
