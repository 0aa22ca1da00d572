#include <iostream>

#include "common/scene/error.h"
#include "experiments/analysis/coverage.h"
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

/// "edge = 4 m", or "-".
std::string setting(const Sweep& sweep, const std::optional<std::size_t>& value) {
  return value ? sweep.dial.setting(*value) : "-";
}

/// "false_px > 0", "recall < 0.5"
std::string beyond(const Sweep& sweep, const SweepVerdict& verdict) {
  return sweep.figure_name() + (sweep.limit.at_least ? " < " : " > ") + to_text(verdict.limit);
}

std::string text_note(const SweepVerdict& verdict) {
  const std::string note = note_of(verdict);
  if (!verdict.broken_promise) return note;
  return "BREAKS ITS PROMISE" + (note.empty() ? "" : "; " + note);
}

/// All there is of each verdict.
Table full_table(const std::vector<SweepResult>& results) {
  Table table({"sweep", "failure", "dial", "unit", "culler", "guarantee", "metric", "limit",
               "breaks_at", "worst", "worst_at", "best", "best_at", "broken_promise_at", "expected",
               "verdict", "note"});
  for (const SweepResult& result : results) {
    const Sweep& sweep = result.sweep;
    for (const SweepVerdict& verdict : result.verdicts) {
      table.add({sweep.name, sweep.failure, sweep.dial.name, sweep.dial.unit, verdict.culler,
                 verdict.was_measured() ? std::string(to_string(verdict.guarantee)) : "",
                 sweep.figure_name(), verdict.limit, at(sweep, verdict.break_point),
                 figure(verdict, verdict.worst), at(sweep, verdict.worst),
                 figure(verdict, verdict.best), at(sweep, verdict.best),
                 at(sweep, verdict.broken_promise), expected_of(verdict),
                 to_string(verdict.agreement), note_of(verdict)});
    }
  }
  return table;
}

/// What a reader asks first: what breaks where, and was that expected.
Table short_table(const std::vector<SweepResult>& results) {
  Table table(
      {"failure", "sweep", "culler", "breaks when", "at", "expected", "verdict", "worst", "note"});
  for (const SweepResult& result : results) {
    for (const SweepVerdict& verdict : result.verdicts) {
      const bool never = !verdict.break_point && verdict.is_complete;
      table.add({result.sweep.failure, result.sweep.name, verdict.culler,
                 beyond(result.sweep, verdict),
                 never ? "never" : setting(result.sweep, verdict.break_point), expected_of(verdict),
                 to_string(verdict.agreement), figure(verdict, verdict.worst), text_note(verdict)});
    }
  }
  return table;
}

/// "300 verdicts in 90 sweeps: 250 agree with what was expected, 30 differ, 20 …"
std::string summary_of(const std::vector<SweepResult>& results) {
  using Agreement = SweepVerdict::Agreement;
  std::size_t agree = 0, differ = 0, unknown = 0, free = 0, broken = 0;
  for (const SweepResult& result : results) {
    for (const SweepVerdict& verdict : result.verdicts) {
      agree += verdict.agreement == Agreement::agrees ? 1 : 0;
      differ += verdict.agreement == Agreement::differs ? 1 : 0;
      unknown += verdict.agreement == Agreement::unknown ? 1 : 0;
      free += verdict.agreement == Agreement::nothing_expected ? 1 : 0;
      broken += verdict.broken_promise ? 1 : 0;
    }
  }
  return std::to_string(agree + differ + unknown + free) + " verdicts in " +
         std::to_string(results.size()) + " sweeps: " + std::to_string(agree) +
         " agree with what was expected, " + std::to_string(differ) + " differ, " +
         std::to_string(unknown) + " are not measured whole, of " + std::to_string(free) +
         " nothing was expected; promises broken: " + std::to_string(broken);
}

}  // namespace

int atlas(const Lab& lab, const std::filesystem::path& results, bool json) {
  const std::vector<SweepResult> found =
      sweep_results(lab, results, require_present_cells(results, lab.cullers));
  std::vector<SweepResult> measured;
  std::vector<Sweep> sweeps;
  std::string not_run;
  bool alarming = false;
  for (const SweepResult& result : found) {
    sweeps.push_back(result.sweep);
    if (!result.was_measured()) {
      not_run += (not_run.empty() ? "" : ", ") + result.sweep.name;
      continue;
    }
    measured.push_back(result);
    for (const SweepVerdict& verdict : result.verdicts) alarming |= verdict.is_alarming();
  }
  if (measured.empty()) {
    throw InputError("no stress sweep was run into " + results.string() +
                     "; run some with 'vislab run stress'");
  }
  const std::string coverage =
      atlas_coverage(sweeps, lab.sweeps / "coverage" / "entries.toml").text();
  if (json) {
    full_table(measured).print_json(std::cout);
    std::cerr << coverage << '\n';
  } else {
    short_table(measured).print_text(std::cout);
    std::cout << '\n' << summary_of(measured) << '\n' << coverage << '\n';
  }
  if (!not_run.empty()) std::cerr << "not run: " << not_run << '\n';
  return alarming ? 1 : 0;
}

}  // namespace vislab
