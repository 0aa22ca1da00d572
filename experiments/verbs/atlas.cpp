#include <iostream>

#include "common/scene/error.h"
#include "experiments/verbs/present_results.h"
#include "experiments/verbs/sweep_results.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

/// The dial's value with that index.
TableValue at(const Sweep& sweep, const std::optional<std::size_t>& value) {
  return value ? TableValue(sweep.dial.values[*value]) : TableValue();
}

TableValue figure(const SweepVerdict& verdict, const std::optional<std::size_t>& value) {
  return value ? TableValue(verdict.points[*value].figure) : TableValue();
}

/// Why there is no figure at the break point, or that values are missing.
std::string note_of(const SweepVerdict& verdict) {
  if (verdict.break_point) {
    const SweepPoint& point = verdict.points[*verdict.break_point];
    if (point.state == SweepPoint::State::failed) return "failed: " + point.reason;
  }
  if (!verdict.missing_counter.empty()) return verdict.missing_counter;
  if (verdict.is_complete) return "";
  return verdict.was_measured() ? "not all values were measured" : "not run";
}

std::string expected_of(const SweepVerdict& verdict) {
  if (!verdict.expectation) return "";
  if (verdict.expectation->never) return "never";
  return to_text(verdict.expectation->low) + " to " + to_text(verdict.expectation->high);
}

}  // namespace

int atlas(const Lab& lab, const std::filesystem::path& results, bool json) {
  const std::vector<SweepResult> found =
      sweep_results(lab, results, require_present_cells(results, lab.cullers));
  Table table({"sweep", "failure", "dial", "unit", "culler", "guarantee", "metric", "limit",
               "breaks_at", "worst", "worst_at", "best", "best_at", "broken_promise_at", "expected",
               "verdict", "note"});
  std::string not_run;
  bool any = false;
  bool alarming = false;
  for (const SweepResult& result : found) {
    const Sweep& sweep = result.sweep;
    if (!result.was_measured()) {
      not_run += (not_run.empty() ? "" : ", ") + sweep.name;
      continue;
    }
    any = true;
    for (const SweepVerdict& verdict : result.verdicts) {
      alarming |= verdict.is_alarming();
      table.add({sweep.name, sweep.failure, sweep.dial.name, sweep.dial.unit, verdict.culler,
                 verdict.was_measured() ? std::string(to_string(verdict.guarantee)) : "",
                 sweep.figure_name(), verdict.limit, at(sweep, verdict.break_point),
                 figure(verdict, verdict.worst), at(sweep, verdict.worst),
                 figure(verdict, verdict.best), at(sweep, verdict.best),
                 at(sweep, verdict.broken_promise), expected_of(verdict),
                 to_string(verdict.agreement), note_of(verdict)});
    }
  }
  if (!any) {
    throw InputError("no stress sweep was run into " + results.string() +
                     "; run some with 'vislab run stress'");
  }
  table.print(std::cout, json);
  if (!not_run.empty()) std::cerr << "not run: " << not_run << '\n';
  return alarming ? 1 : 0;
}

}  // namespace vislab
