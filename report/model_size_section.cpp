#include "report/model_size_section.h"

#include <algorithm>
#include <cmath>

#include "report/format.h"
#include "report/model_size_chart.h"

namespace vislab {
namespace {

std::string chart_file(std::size_t sweep, std::size_t method) {
  return "model-size-" + std::to_string(sweep + 1) + "-" + std::to_string(method + 1) + ".svg";
}

std::string place_of(const SizeCurve& scene) {
  return scene.scene + (scene.path.empty() ? "" : ", " + scene.path);
}

std::string setting(const SizeSweep& sweep, const std::optional<std::size_t>& value) {
  return value ? markdown_text(sweep.values[*value]) : "–";
}

/// "8 · 8 · 16", in the order of the scenes.
template <typename Text>
std::string by_scene(const SizeVerdict& verdict, const Text& text) {
  std::string joined;
  for (const SizeCurve& scene : verdict.scenes) {
    joined += (joined.empty() ? "" : " · ") + text(scene);
  }
  return joined;
}

/// "6", or "6 or 8" where intervals leave several.
std::string common_knee(const SizeSweep& sweep, const SizeCurve& common) {
  if (common.may_be_knee.empty()) return setting(sweep, common.knee);
  std::string joined;
  for (const std::size_t value : common.may_be_knee) {
    joined += (joined.empty() ? "" : " or ") + setting(sweep, value);
  }
  return joined;
}

std::string share(double relative) { return std::isnan(relative) ? "–" : format_percent(relative); }

/// What the measured knee says of the default.
std::string verdict_text(const SizeSweep& sweep, const SizeVerdict& verdict) {
  if (!verdict.was_measured()) return "was not measured";
  if (!verdict.common.knee) return "cannot be told, as no two values are there on all scenes";
  if (verdict.default_is_knee()) {
    return verdict.common.may_be_knee.size() == 1 ? "is the knee" : "may be the knee";
  }
  const SizePoint& by_default = verdict.common.points[verdict.method.default_value];
  std::string text = "has " + share(by_default.relative) + " of the best, with the **knee at " +
                     common_knee(sweep, verdict.common) + "**";
  if (verdict.method.off_knee.empty()) return text;
  std::string_view reason = verdict.method.off_knee;
  if (reason.ends_with('.')) reason.remove_suffix(1);
  return text + " (" + markdown_text(reason) + ")";
}

Fields value_row(const SizeSweep& sweep, const SizeVerdict& verdict, std::size_t value) {
  const SizePoint& point = verdict.common.points[value];
  Fields row;
  std::string name = markdown_text(sweep.values[value]);
  if (std::ranges::count(verdict.common.may_be_knee, value) > 0) {
    const bool is_told = verdict.common.may_be_knee.size() == 1;
    name = "**" + name + "** " + (is_told ? "(knee)" : "(may be the knee)");
  }
  if (verdict.method.default_value == value) name += " (default)";
  row.values["value"] = name;
  row.values["by_scene"] = by_scene(verdict, [&](const SizeCurve& scene) {
    const SizePoint& own = scene.points[value];
    return own.was_measured() ? share(own.relative) : markdown_text(own.gap);
  });
  const bool measured = point.was_measured();
  row.values["bytes"] = measured ? format_bytes(point.bytes) : "–";
  row.values["build"] = measured ? format_number(point.build_ms) : "–";
  row.values["of_best"] = measured ? share(point.relative) : markdown_text(point.gap);
  row.values["over"] = measured ? format_number(point.over) : "–";
  row.values["wrong"] = measured ? format_count(point.wrong_pixels) : "–";
  return row;
}

Fields method_fields(const SizeSweep& sweep, const SizeVerdict& verdict, const std::string& file) {
  Fields entry;
  entry.values["method"] = markdown_code(verdict.method.culler);
  entry.values["parameter"] = markdown_code(verdict.method.parameter);
  entry.values["file"] = file;
  entry.values["note"] = markdown_text(verdict.method.note);
  entry.values["verdict"] = verdict_text(sweep, verdict);
  entry.flag("has_note", !verdict.method.note.empty());
  entry.flag("mixed_rounds", !verdict.common.same_rounds);
  for (std::size_t value = 0; value < sweep.values.size(); ++value) {
    entry.lists["values"].push_back(value_row(sweep, verdict, value));
  }
  return entry;
}

Fields summary_row(const SizeSweep& sweep, const SizeVerdict& verdict) {
  const SizePoint& by_default = verdict.common.points[verdict.method.default_value];
  const bool measured = by_default.was_measured();
  Fields row;
  row.values["dial"] = markdown_text(sweep.dial);
  row.values["method"] = markdown_code(verdict.method.culler);
  row.values["knees"] =
      by_scene(verdict, [&](const SizeCurve& scene) { return setting(sweep, scene.knee); });
  row.values["knee"] = common_knee(sweep, verdict.common);
  row.values["default"] = markdown_text(sweep.values[verdict.method.default_value]);
  row.values["of_best"] = measured ? share(by_default.relative) : markdown_text(by_default.gap);
  row.values["bytes"] = measured ? format_bytes(by_default.bytes) : "–";
  row.values["build"] = measured ? format_number(by_default.build_ms) : "–";
  row.values["verdict"] = verdict_text(sweep, verdict);
  return row;
}

}  // namespace

void add_model_size_fields(const std::vector<SizeResult>& sizes, Fields& fields) {
  std::vector<Fields> dials;
  std::vector<Fields> summary;
  std::string not_run;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const SizeSweep& sweep = sizes[i].sweep;
    if (!sizes[i].was_measured()) {
      not_run += (not_run.empty() ? "" : ", ") + markdown_code(sweep.name);
      continue;
    }
    Fields entry;
    entry.values["title"] = markdown_text(sweep.dial);
    entry.values["sweep"] = markdown_code(sweep.name);
    entry.values["unit"] = markdown_text(sweep.unit.empty() ? "" : " (" + sweep.unit + ")");
    entry.values["description"] = markdown_text(sweep.description);
    entry.values["cost"] = markdown_code(to_string(sweep.cost));
    entry.values["because"] = markdown_text(sweep.because);
    std::string scenes;
    for (const SizeCurve& scene : sizes[i].verdicts.front().scenes) {
      scenes += (scenes.empty() ? "" : " · ") + markdown_text(place_of(scene));
    }
    entry.values["places"] = scenes;
    entry.lists["methods"];
    for (std::size_t m = 0; m < sizes[i].verdicts.size(); ++m) {
      const SizeVerdict& verdict = sizes[i].verdicts[m];
      if (verdict.was_measured()) {
        entry.lists["methods"].push_back(method_fields(sweep, verdict, chart_file(i, m)));
      }
      summary.push_back(summary_row(sweep, verdict));
    }
    dials.push_back(std::move(entry));
  }
  fields.flag("has_model_size", !dials.empty());
  fields.flag("has_sizes_not_run", !dials.empty() && !not_run.empty());
  fields.values["sizes_not_run"] = not_run;
  fields.lists["size_dials"] = std::move(dials);
  fields.lists["size_summary"] = std::move(summary);
}

std::string size_charts_script(const std::vector<SizeResult>& sizes) {
  std::string script;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    for (std::size_t m = 0; m < sizes[i].verdicts.size(); ++m) {
      const SizeVerdict& verdict = sizes[i].verdicts[m];
      if (!verdict.was_measured()) continue;
      script += size_chart_script(sizes[i].sweep, verdict, chart_file(i, m));
    }
  }
  return script;
}

}  // namespace vislab
