#include "experiments/analysis/break_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/judge/metrics.h"

namespace vislab {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double approximate_share = 0.01;  // of the pixels: what approximate methods may lose
constexpr double default_ratio = 2.0;

using State = SweepPoint::State;
using Agreement = SweepVerdict::Agreement;

SweepPoint point_of(const CellSummary* cell, const SweepLimit& limit) {
  SweepPoint point;
  point.figure = nan;
  if (cell == nullptr) return point;
  if (cell->status == ResultCell::Status::failed) {
    point.state = State::failed;
    point.reason = cell->reason;
    return point;
  }
  if (cell->status != ResultCell::Status::done || !cell->judged) return point;
  point.state = State::measured;
  point.figure = cell->metric(limit.metric);
  point.guarantee = cell->guarantee;
  point.breaks_promise = breaks_its_promise(*cell);
  return point;
}

double worst_allowed(const SweepLimit& limit, Guarantee guarantee, double first,
                     std::uint64_t pixels) {
  if (limit.at_least) return *limit.at_least;
  if (limit.at_most) return *limit.at_most;
  if (limit.at_most_ratio) return *limit.at_most_ratio * first;
  if (may_double(limit.metric)) return default_ratio * first;
  if (limit.metric == "false_px" && guarantee == Guarantee::approximate) {
    return approximate_share * static_cast<double>(pixels);
  }
  return 0.0;
}

/// What to say of a measured cell without the counter that the sweep asks for.
std::string without_counter(const CellSummary& cell, const std::string& counter) {
  std::string known;
  for (const auto& [name, value] : cell.counters) known += (known.empty() ? "" : ", ") + name;
  return cell.culler + " has no counter '" + counter + "'; it has " +
         (known.empty() ? "none" : known);
}

Agreement agreement_of(const SweepVerdict& verdict, const SweepDial& dial) {
  if (!verdict.expectation) return Agreement::nothing_expected;
  const SweepExpectation& expected = *verdict.expectation;
  if (!verdict.is_complete) return Agreement::unknown;
  if (!verdict.break_point) return expected.never ? Agreement::agrees : Agreement::differs;
  const double value = dial.values[*verdict.break_point];
  const bool within = !expected.never && value >= expected.low && value <= expected.high;
  return within ? Agreement::agrees : Agreement::differs;
}

/// A method's point at a value of the dial: its own figure, or its share of another method's.
SweepPoint point_at(const Sweep& sweep, const SweepMethod& method, std::size_t value,
                    const CellAtValue& cell_at) {
  SweepPoint point = point_of(cell_at(value, method.chains[value]), sweep.limit);
  if (!sweep.limit.against) return point;
  const SweepMethod& other = sweep.methods[*sweep.limit.against];
  point.figure /= point_of(cell_at(value, other.chains[value]), sweep.limit).figure;
  return point;
}

SweepVerdict verdict_on(const Sweep& sweep, const SweepMethod& method, const CellAtValue& cell_at) {
  SweepVerdict verdict;
  verdict.culler = method.culler;
  verdict.expectation = method.expectation;
  std::uint64_t pixels = 0;
  for (std::size_t i = 0; i < method.chains.size(); ++i) {
    const CellSummary* const cell = cell_at(i, method.chains[i]);
    verdict.points.push_back(point_at(sweep, method, i, cell_at));
    if (cell == nullptr) continue;
    verdict.guarantee = std::max(verdict.guarantee, cell->guarantee);
    if (pixels == 0) pixels = cell->pixels;
    const bool measured = verdict.points.back().state == State::measured;
    if (measured && sweep.limit.is_counter && !cell->counters.contains(sweep.limit.metric)) {
      verdict.missing_counter = without_counter(*cell, sweep.limit.metric);
    }
  }
  const std::vector<SweepPoint>& points = verdict.points;
  const auto is_worse = [&](double figure, double than) {
    return sweep.limit.at_least ? figure < than : figure > than;
  };
  // What others are held against has nothing to hold to itself.
  const bool is_yardstick = sweep.limit.against && &sweep.methods[*sweep.limit.against] == &method;
  verdict.limit = worst_allowed(sweep.limit, verdict.guarantee, points.front().figure, pixels);
  verdict.is_complete = true;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SweepPoint& point = points[i];
    const bool measured = point.state == State::measured && !std::isnan(point.figure);
    if (!verdict.break_point) {
      if (point.state == State::failed ||
          (measured && !is_yardstick && is_worse(point.figure, verdict.limit))) {
        verdict.break_point = i;
      } else if (!measured) {
        verdict.is_complete = false;
      }
    }
    if (!verdict.broken_promise && point.breaks_promise) verdict.broken_promise = i;
    if (!measured) continue;
    if (!verdict.worst || is_worse(point.figure, points[*verdict.worst].figure)) verdict.worst = i;
    if (!verdict.best || is_worse(points[*verdict.best].figure, point.figure)) verdict.best = i;
  }
  if (std::isnan(verdict.limit) && !verdict.break_point) verdict.is_complete = false;
  verdict.agreement = agreement_of(verdict, sweep.dial);
  return verdict;
}

}  // namespace

bool breaks_its_promise(const CellSummary& cell) {
  if (!cell.judged) return false;
  if (cell.guarantee == Guarantee::conservative) return !is_free_of_errors(cell);
  if (cell.guarantee != Guarantee::image_exact) return false;
  return (cell.drawn && !cell.paints ? cell.image_px : cell.wrong_px()) > 0;
}

bool SweepVerdict::was_measured() const {
  return std::ranges::any_of(points,
                             [](const SweepPoint& point) { return point.state != State::missing; });
}

bool SweepResult::was_measured() const {
  return std::ranges::any_of(verdicts, &SweepVerdict::was_measured);
}

SweepResult find_break_points(const Sweep& sweep, const CellAtValue& cell) {
  SweepResult result{sweep, {}};
  for (const SweepMethod& method : sweep.methods) {
    result.verdicts.push_back(verdict_on(sweep, method, cell));
  }
  return result;
}

bool may_double(const std::string& metric) {
  if (metric == "over" || metric == "over_objects") return true;
  const auto known = std::ranges::find(metrics(), metric, &Metric::name);
  return known != metrics().end() && (known->unit == "us" || known->unit == "ms");
}

std::string missing_counter(const SweepResult& result) {
  const bool all = std::ranges::none_of(
      result.verdicts, [](const SweepVerdict& verdict) { return verdict.missing_counter.empty(); });
  if (!all || result.verdicts.empty()) return "";
  return "sweep " + result.sweep.name + ": " + result.verdicts.front().missing_counter;
}

std::string to_string(SweepVerdict::Agreement agreement) {
  switch (agreement) {
    case Agreement::agrees:
      return "agrees";
    case Agreement::differs:
      return "differs";
    case Agreement::unknown:
      return "unknown";
    case Agreement::nothing_expected:
      break;
  }
  return "";
}

}  // namespace vislab
