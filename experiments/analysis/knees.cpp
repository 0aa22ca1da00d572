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

/// Decisions are compared with the soonest of the curve, which is not known yet: until then their
/// efficiency is the reciprocal of what they take.
void measure_cost(const SizeCell& found, SizeCost cost, SizePoint& point) {
  const CellSummary& cell = *found.cell;
  if (cost == SizeCost::frame_ms) {
    point.cost = cell.frame_ms.median.value;
    point.efficiency = cell.efficiency;
  } else if (cost == SizeCost::modelled_frame_ms) {
    point.cost = cell.modelled_frame_ms;
    const CellSummary* const oracle = oracle_like(*found.block, cell);
    const double ratio = oracle == nullptr ? nan : oracle->modelled_frame_ms / point.cost;
    point.efficiency = {ratio, ratio, ratio};
  } else {
    const Estimate decision = decision_us(cell);
    point.cost = decision.value;
    point.efficiency = {1.0 / decision.value, 1.0 / decision.high, 1.0 / decision.low};
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

/// Fills in what depends on the other points: best, relative, knee. The best of several that are
/// equally efficient is the first.
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
  for (std::size_t i = 0; i < points.size(); ++i) {
    SizePoint& point = points[i];
    if (!point.was_measured()) continue;
    point.relative = point.efficiency.value / most;
    if (point.relative < knee_efficiency || point.wrong_pixels > best.wrong_pixels) continue;
    if (!curve.knee || is_smaller(point, points[*curve.knee])) curve.knee = i;
  }
}

SizeCurve curve_of(const SizeSweep& sweep, const SizeMethod& method, std::size_t block,
                   const SizeCellOf& cell_of) {
  SizeCurve curve;
  curve.scene = sweep.blocks[block].scene;
  curve.path = sweep.blocks[block].path;
  for (const std::string& chain : method.chains) {
    curve.points.push_back(point_of(cell_of(block, chain), sweep.cost));
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
  double low = 0.0;
  double high = 0.0;
  for (const SizeCurve& scene : scenes) {
    const SizePoint& point = scene.points[value];
    if (!point.was_measured()) {
      common.gap = scene.scene + ": " + point.gap;
      return common;
    }
    logarithm += std::log(point.efficiency.value) / count;
    low += std::log(point.efficiency.low) / count;
    high += std::log(point.efficiency.high) / count;
    common.bytes += point.bytes;
    common.build_ms += point.build_ms;
    common.wrong_pixels += point.wrong_pixels;
    common.over += point.over / count;
    common.recall += point.recall / count;
  }
  common.efficiency = {std::exp(logarithm), std::exp(low), std::exp(high)};
  return common;
}

using Facts = std::map<std::string, std::set<std::string>>;

/// What the cells of a block say of the facts that are there by name.
void add_facts(const BlockSummary& block, Facts& facts) {
  for (auto& [name, texts] : facts) {
    if (const auto one = block.context.find(name); one != block.context.end()) {
      texts.insert(one->second);
    }
    if (const auto mixed = block.mixed_context.find(name); mixed != block.mixed_context.end()) {
      texts.insert(mixed->second.begin(), mixed->second.end());
    }
  }
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

bool SizeResult::was_measured() const {
  return std::ranges::any_of(verdicts, [](const SizeVerdict& verdict) {
    return std::ranges::any_of(verdict.scenes,
                               [](const SizeCurve& scene) { return scene.measured() > 0; });
  });
}

bool SizeResult::is_complete() const {
  return std::ranges::all_of(verdicts, [&](const SizeVerdict& verdict) {
    return verdict.common.measured() == sweep.values.size();
  });
}

SizeResult find_knees(const SizeSweep& sweep, const SizeCellOf& cell_of) {
  SizeResult result;
  result.sweep = sweep;
  Facts facts{{"cpu", {}}, {"date", {}}};
  for (const SizeMethod& method : sweep.methods) {
    SizeVerdict verdict;
    verdict.method = method;
    for (std::size_t block = 0; block < sweep.blocks.size(); ++block) {
      verdict.scenes.push_back(curve_of(sweep, method, block, cell_of));
      const SizeCell first = cell_of(block, method.chains.front());
      if (first.block != nullptr) add_facts(*first.block, facts);
    }
    for (std::size_t value = 0; value < sweep.values.size(); ++value) {
      verdict.common.points.push_back(common_point(verdict.scenes, value));
    }
    find_knee(verdict.common);
    result.verdicts.push_back(std::move(verdict));
  }
  result.machine = joined(facts["cpu"]);
  result.date = joined(facts["date"]);
  return result;
}

}  // namespace vislab
