#include "experiments/analysis/knees.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace vislab {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double same_bytes = 0.99;
constexpr int fewest_rounds = 3;  // of fewer, intervals tell how frames differ, not how runs do

/// Update and cull, µs, with the widest interval that the two allow.
Estimate decision_us(const CellSummary& cell) {
  const Estimate& update = cell.update_us.median;
  const Estimate& cull = cell.cull_us.median;
  return {update.value + cull.value, update.low + cull.low, update.high + cull.high};
}

const CellSummary* oracle_like(const BlockSummary& block, const CellSummary& cell) {
  const std::string level = cell.granularity == Granularity::triangle ? "triangle" : "object";
  const auto found = std::ranges::find_if(block.cells, [&](const CellSummary& anchor) {
    return anchor.replicate == 0 && anchor.canonical.starts_with("oracle[level=" + level);
  });
  return found == block.cells.end() ? nullptr : &*found;
}

std::uint64_t wrong_pixels_of(const CellSummary& cell) {
  std::uint64_t wrong = cell.false_px + (cell.drawn ? cell.image_px : 0);
  if (cell.guarantee == Guarantee::conservative) wrong += cell.false_jittered;
  return wrong;
}

/// The modelled frame with the interval of what is measured of it.
Estimate modelled_frame_ms(const CellSummary& cell) {
  const double all = cell.modelled_frame_ms;
  if (cell.asks_device) {
    const Estimate& ratio = cell.against_none;
    return {all, all * ratio.low / ratio.value, all * ratio.high / ratio.value};
  }
  const Estimate decision = decision_us(cell);
  const double drawing = all - decision.value / 1e3;
  return {all, drawing + decision.low / 1e3, drawing + decision.high / 1e3};
}

/// Decisions are compared with the soonest of the curve, which is not known yet: until then their
/// efficiency is the reciprocal of what they take.
void measure_cost(const SizeCell& found, SizeCost cost, SizePoint& point) {
  const CellSummary& cell = *found.cell;
  if (cost == SizeCost::frame_ms) {
    point.cost = cell.frame_ms.median.value;
    point.efficiency = cell.efficiency;
  } else if (cost == SizeCost::modelled_frame_ms) {
    const CellSummary* const oracle = oracle_like(*found.block, cell);
    const double least = oracle == nullptr ? nan : oracle->modelled_frame_ms;
    const Estimate frame = modelled_frame_ms(cell);
    point.cost = frame.value;
    point.efficiency = {least / frame.value, least / frame.high, least / frame.low};
  } else {
    const Estimate decision = decision_us(cell);
    point.cost = decision.value;
    point.efficiency = {1.0 / decision.value, 1.0 / decision.high, 1.0 / decision.low};
  }
  if (cell.rounds < fewest_rounds) {
    point.efficiency.low = point.efficiency.high = point.efficiency.value;
  }
}

SizePoint point_of(const SizeCell& found, SizeCost cost) {
  SizePoint point;
  point.cost = point.relative = point.over = point.recall = nan;
  if (found.cell == nullptr) {
    point.gap = "not run";
    return point;
  }
  const CellSummary& cell = *found.cell;
  if (cell.status == ResultCell::Status::failed) {
    point.gap = "failed: " + cell.reason;
    return point;
  }
  if (cell.status != ResultCell::Status::done) {
    point.gap = "not finished";
    return point;
  }
  if (!cell.judged) {
    point.gap = "not judged";
    return point;
  }
  measure_cost(found, cost, point);
  if (!(point.efficiency.value > 0.0) || !std::isfinite(point.efficiency.value)) {
    point.gap = "without " + to_string(cost);
    return point;
  }
  point.bytes = cell.bytes;
  point.build_ms = cell.build_ms;
  point.wrong_pixels = wrong_pixels_of(cell);
  point.over = cell.over;
  point.recall = cell.recall;
  return point;
}

void divide(Estimate& estimate, double by) {
  estimate.value /= by;
  estimate.low /= by;
  estimate.high /= by;
}

/// By more than what the places of allocations make of the same model.
bool is_smaller(const SizePoint& point, const SizePoint& than) {
  return static_cast<double>(point.bytes) < same_bytes * static_cast<double>(than.bytes);
}

/// Of the values the one of the smallest model.
std::optional<std::size_t> smallest(const std::vector<SizePoint>& points,
                                    const std::vector<std::size_t>& values) {
  std::optional<std::size_t> found;
  for (const std::size_t value : values) {
    if (!found || is_smaller(points[value], points[*found])) found = value;
  }
  return found;
}

/// Fills in what depends on the other points: best, relative, knee. The best of several that are
/// equally efficient is the first. One point alone has nothing to be the knee of.
void find_knee(SizeCurve& curve) {
  std::vector<SizePoint>& points = curve.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].was_measured()) continue;
    if (!curve.best || points[i].efficiency.value > points[*curve.best].efficiency.value) {
      curve.best = i;
    }
  }
  if (!curve.best) return;
  const SizePoint& best = points[*curve.best];
  const double most = best.efficiency.value;
  std::vector<std::size_t> certain{*curve.best};
  for (std::size_t i = 0; i < points.size(); ++i) {
    SizePoint& point = points[i];
    if (!point.was_measured()) continue;
    point.relative = point.efficiency.value / most;
    if (point.wrong_pixels > best.wrong_pixels) continue;
    if (point.efficiency.high >= knee_efficiency * most) curve.may_be_knee.push_back(i);
    if (point.efficiency.low >= knee_efficiency * most) certain.push_back(i);
  }
  std::ranges::sort(certain);
  const std::size_t largest = *smallest(points, certain);
  std::erase_if(curve.may_be_knee, [&](std::size_t value) {
    return is_smaller(points[largest], points[value]) ||
           (value > largest && !is_smaller(points[value], points[largest]));
  });
  if (curve.measured() < 2) {
    curve.may_be_knee.clear();
  } else {
    curve.knee = smallest(points, curve.may_be_knee);
  }
}

SizeCurve curve_of(const SizeSweep& sweep, const SizeMethod& method, std::size_t block,
                   const SizeCellOf& cell_of) {
  SizeCurve curve;
  curve.scene = sweep.blocks[block].scene;
  curve.path = sweep.blocks[block].path;
  const std::set<std::string>* sessions = nullptr;
  for (const std::string& chain : method.chains) {
    const SizeCell found = cell_of(block, chain);
    curve.points.push_back(point_of(found, sweep.cost));
    if (!curve.points.back().was_measured() || sweep.cost == SizeCost::frame_ms) continue;
    if (sessions == nullptr) sessions = &found.cell->sessions;
    curve.same_rounds = curve.same_rounds && *sessions == found.cell->sessions;
  }
  find_knee(curve);
  if (sweep.cost == SizeCost::decision_us && curve.best) {
    const double most = curve.points[*curve.best].efficiency.value;
    for (SizePoint& point : curve.points) divide(point.efficiency, most);
  }
  return curve;
}

/// A value is measured if it is on every scene.
SizePoint common_point(const std::vector<SizeCurve>& scenes, std::size_t value) {
  SizePoint common;
  common.cost = common.relative = nan;
  const auto count = static_cast<double>(scenes.size());
  double logarithm = 0.0;
  double below = 0.0;  // squares add up: scenes are measured independently of each other
  double above = 0.0;
  for (const SizeCurve& scene : scenes) {
    const SizePoint& point = scene.points[value];
    if (!point.was_measured()) {
      common.gap = scene.scene + ": " + point.gap;
      return common;
    }
    logarithm += std::log(point.efficiency.value) / count;
    const Estimate& own = point.efficiency;
    below += std::pow(std::log(own.value / own.low) / count, 2.0);
    above += std::pow(std::log(own.high / own.value) / count, 2.0);
    common.bytes += point.bytes;
    common.build_ms += point.build_ms;
    common.wrong_pixels += point.wrong_pixels;
    common.over += point.over / count;
    common.recall += point.recall / count;
  }
  common.efficiency = {std::exp(logarithm), std::exp(logarithm - std::sqrt(below)),
                       std::exp(logarithm + std::sqrt(above))};
  return common;
}

using Facts = std::map<std::string, std::set<std::string>>;

/// What the cells of a block say of one fact.
std::set<std::string> facts_of(const BlockSummary& block, const std::string& name) {
  std::set<std::string> texts;
  if (const auto one = block.context.find(name); one != block.context.end()) {
    texts.insert(one->second);
  }
  if (const auto mixed = block.mixed_context.find(name); mixed != block.mixed_context.end()) {
    texts.insert(mixed->second.begin(), mixed->second.end());
  }
  return texts;
}

void add_facts(const SizeCell& found, Facts& facts) {
  for (const char* const name : {"cpu", "compiler", "date", "revision"}) {
    const bool changed =
        name == std::string("revision") && facts_of(*found.block, "dirty").contains("yes");
    for (const std::string& text : facts_of(*found.block, name)) {
      facts[name].insert(text + (changed ? "+" : ""));
    }
  }
  facts["rounds"].insert(std::to_string(found.cell->rounds));
  facts["threads"].insert(std::to_string(found.block->threads));
}

std::string joined(const std::set<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : ", ") + text;
  return all;
}

}  // namespace

std::size_t SizeCurve::measured() const {
  return static_cast<std::size_t>(std::ranges::count_if(points, &SizePoint::was_measured));
}

bool SizeVerdict::was_measured() const {
  return std::ranges::any_of(scenes, [](const SizeCurve& scene) { return scene.measured() > 1; });
}

bool SizeResult::was_measured() const {
  return std::ranges::any_of(verdicts, &SizeVerdict::was_measured);
}

bool SizeResult::is_complete() const {
  return std::ranges::all_of(verdicts, [&](const SizeVerdict& verdict) {
    return verdict.common.measured() == sweep.values.size();
  });
}

bool SizeVerdict::default_is_knee() const {
  return std::ranges::count(common.may_be_knee, method.default_value) > 0;
}

SizeResult find_knees(const SizeSweep& sweep, const SizeCellOf& cell_of) {
  SizeResult result;
  result.sweep = sweep;
  Facts facts;
  for (const SizeMethod& method : sweep.methods) {
    SizeVerdict verdict;
    verdict.method = method;
    for (std::size_t block = 0; block < sweep.blocks.size(); ++block) {
      verdict.scenes.push_back(curve_of(sweep, method, block, cell_of));
      for (const std::string& chain : method.chains) {
        const SizeCell found = cell_of(block, chain);
        if (found.cell != nullptr) add_facts(found, facts);
      }
    }
    for (std::size_t value = 0; value < sweep.values.size(); ++value) {
      verdict.common.points.push_back(common_point(verdict.scenes, value));
    }
    verdict.common.same_rounds = std::ranges::all_of(verdict.scenes, &SizeCurve::same_rounds);
    find_knee(verdict.common);
    result.verdicts.push_back(std::move(verdict));
  }
  for (const auto& [name, texts] : facts) result.provenance[name] = joined(texts);
  return result;
}

}  // namespace vislab
