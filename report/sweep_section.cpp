#include "report/sweep_section.h"

#include <algorithm>

#include "report/format.h"
#include "report/sweep_chart.h"

namespace vislab {
namespace {

/// "at 4 m", "none from 0.5 to 64 m", or why it cannot be told.
std::string break_text(const Sweep& sweep, const SweepVerdict& verdict) {
  const SweepDial& dial = sweep.dial;
  if (verdict.break_point) {
    const SweepPoint& point = verdict.points[*verdict.break_point];
    const std::string at = "**at " + dial_text(dial, *verdict.break_point) + "**";
    if (point.state != SweepPoint::State::failed) return at;
    return at + ", where it failed: " + markdown_text(point.reason);
  }
  if (!verdict.was_measured()) return "not run";
  if (!verdict.missing_counter.empty()) return markdown_text(verdict.missing_counter);
  if (!verdict.is_complete) return "not all values were measured";
  return "none within " + dial_text(dial, 0) + " to " + dial_text(dial, dial.texts.size() - 1);
}

/// "12 at 4 m"
std::string figure_text(const Sweep& sweep, const SweepVerdict& verdict,
                        const std::optional<std::size_t>& value) {
  if (!value) return "–";
  return format_number(verdict.points[*value].figure) + " at " + dial_text(sweep.dial, *value);
}

/// As the dial has it, if it is one of its values: a dial may be turned to 1e-8.
std::string bound_text(const SweepDial& dial, double bound) {
  const auto found = std::ranges::find(dial.values, bound);
  if (found == dial.values.end()) return format_number(bound);
  return markdown_text(
      format_written(dial.texts[static_cast<std::size_t>(found - dial.values.begin())]));
}

std::string expectation_text(const SweepDial& dial, const SweepVerdict& verdict) {
  if (!verdict.expectation) return "–";
  const SweepExpectation& expected = *verdict.expectation;
  const std::string low = bound_text(dial, expected.low);
  const std::string high = bound_text(dial, expected.high);
  const std::string range = expected.never ? "never breaks"
                            : low == high  ? "breaks at " + low
                                           : "breaks from " + low + " to " + high;
  std::string text =
      range + ": " + markdown_text(expected.because) + " (" + markdown_text(expected.source) + ")";
  if (verdict.agreement == SweepVerdict::Agreement::differs && !expected.hindsight.empty()) {
    text += ". In hindsight: " + markdown_text(expected.hindsight);
  }
  return text;
}

std::string agreement_text(const SweepVerdict& verdict) {
  std::string text = to_string(verdict.agreement);
  if (verdict.agreement == SweepVerdict::Agreement::differs) text = "**" + text + "**";
  if (verdict.broken_promise) {
    text += std::string(text.empty() ? "" : "; ") + "**breaks its promise**";
  }
  return text.empty() ? "–" : text;
}

std::string limit_text(const Sweep& sweep) {
  const SweepLimit& limit = sweep.limit;
  std::string metric = markdown_code(limit.metric) + (limit.is_counter ? " a frame" : "");
  if (limit.against) {
    metric += " ÷ that of " + markdown_code(sweep.methods[*limit.against].culler);
  }
  if (limit.at_most) return metric + " of at most " + format_number(*limit.at_most);
  if (limit.at_least) return metric + " of at least " + format_number(*limit.at_least);
  if (limit.at_most_ratio) {
    return metric + " of at most " + format_number(*limit.at_most_ratio) +
           " times that at the first value";
  }
  if (limit.metric == "false_px") {
    return metric + " of 0, for approximate methods 1 % of the pixels";
  }
  if (may_double(limit.metric)) return metric + " of at most twice that at the first value";
  return metric + " of 0";
}

Fields method_row(const Sweep& sweep, const SweepVerdict& verdict) {
  Fields row;
  row.values["method"] = markdown_code(verdict.culler);
  row.values["guarantee"] =
      verdict.was_measured() ? markdown_text(to_string(verdict.guarantee)) : "–";
  row.values["breaks"] = break_text(sweep, verdict);
  row.values["worst"] = figure_text(sweep, verdict, verdict.worst);
  row.values["best"] = figure_text(sweep, verdict, verdict.best);
  row.values["expected"] = expectation_text(sweep.dial, verdict);
  row.values["agreement"] = agreement_text(verdict);
  return row;
}

/// Did anything break, come out unlike predicted, or is something missing?
bool has_news(const SweepResult& result) {
  return std::ranges::any_of(result.verdicts, [](const SweepVerdict& verdict) {
    return verdict.break_point || verdict.broken_promise || !verdict.is_complete ||
           !verdict.missing_counter.empty() ||
           verdict.agreement == SweepVerdict::Agreement::differs;
  });
}

Fields quiet_row(const SweepResult& result) {
  Fields row;
  row.values["failure"] = markdown_text(result.sweep.failure);
  row.values["sweep"] = markdown_text(result.sweep.name);
  row.values["description"] = markdown_text(result.sweep.description);
  const SweepDial& dial = result.sweep.dial;
  row.values["dial"] = markdown_text(dial.name) + " from " + dial_text(dial, 0) + " to " +
                       dial_text(dial, dial.texts.size() - 1);
  row.values["limit"] = limit_text(result.sweep);
  std::string methods;
  for (const SweepVerdict& verdict : result.verdicts) {
    methods += (methods.empty() ? "" : "; ") + markdown_code(verdict.culler);
  }
  row.values["methods"] = methods;
  return row;
}

}  // namespace

std::string dial_text(const SweepDial& dial, std::size_t value) {
  const std::string no_break = "\u00A0";  // a number's unit stays beside it
  return markdown_text(format_written(dial.texts[value]) +
                       (dial.unit.empty() ? "" : no_break + dial.unit));
}

std::string sweep_chart_file_name(std::size_t sweep) {
  return "sweep-" + std::to_string(sweep + 1) + ".svg";
}

bool is_shown(const SweepResult& sweep) { return sweep.was_measured() && has_news(sweep); }

void add_sweep_fields(const std::vector<SweepResult>& sweeps, Fields& fields) {
  auto& entries = fields.lists["sweeps"];
  auto& quiet = fields.lists["quiet_sweeps"];
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    const SweepResult& result = sweeps[i];
    if (!result.was_measured()) continue;
    if (!is_shown(result)) {
      quiet.push_back(quiet_row(result));
      continue;
    }
    Fields entry;
    entry.values["failure"] = markdown_text(result.sweep.failure);
    entry.values["sweep"] = markdown_text(result.sweep.name);
    entry.values["description"] = markdown_text(result.sweep.description);
    entry.values["dial"] = markdown_text(result.sweep.dial.name);
    entry.values["limit"] = limit_text(result.sweep);
    entry.values["file"] = sweep_chart_file_name(i);
    entry.flag("chart", has_sweep_chart(result));
    entry.values["size"] = has_many_lines(result) ? "" : " .low";
    for (const SweepVerdict& verdict : result.verdicts) {
      entry.lists["rows"].push_back(method_row(result.sweep, verdict));
    }
    entries.push_back(std::move(entry));
  }
  fields.flag("has_sweeps", !entries.empty() || !quiet.empty());
  fields.flag("has_quiet_sweeps", !quiet.empty());
}

}  // namespace vislab
