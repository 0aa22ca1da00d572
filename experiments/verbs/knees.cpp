#include <algorithm>
#include <iostream>

#include "common/scene/error.h"
#include "experiments/analysis/knees_file.h"
#include "experiments/matrix/size_coverage.h"
#include "experiments/results/files.h"
#include "experiments/verbs/present_results.h"
#include "experiments/verbs/size_results.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

constexpr const char* all_scenes = "all scenes";

TableValue at(const SizeSweep& sweep, const std::optional<std::size_t>& value) {
  return value ? TableValue(sweep.values[*value]) : TableValue();
}

/// "4 8", all values that may be the knee.
std::string may_be(const SizeSweep& sweep, const SizeCurve& curve) {
  std::string all;
  for (const std::size_t value : curve.may_be_knee) {
    all += (all.empty() ? "" : " ") + sweep.values[value];
  }
  return all;
}

/// Why figures are missing, or hard to compare.
std::string note_of(const SizeSweep& sweep, const SizeCurve& curve) {
  const std::string apart = curve.same_rounds ? "" : "values of different runs";
  const std::size_t missing = sweep.values.size() - curve.measured();
  if (missing == 0) return apart;
  const auto gap = std::ranges::find_if(
      curve.points, [](const SizePoint& point) { return !point.was_measured(); });
  return (apart.empty() ? "" : apart + "; ") + std::to_string(missing) + " of " +
         std::to_string(sweep.values.size()) + " values are missing: " + gap->gap;
}

void add_curve(const SizeSweep& sweep, const SizeVerdict& verdict, const SizeCurve& curve,
               const std::string& place, Table& table) {
  const SizePoint* const knee = curve.knee ? &curve.points[*curve.knee] : nullptr;
  const SizePoint& by_default = curve.points[verdict.method.default_value];
  const auto of_knee = [&](auto SizePoint::*figure) {
    return knee == nullptr ? TableValue() : TableValue(knee->*figure);
  };
  table.add({sweep.name, sweep.dial, verdict.method.culler, verdict.method.parameter, place,
             to_string(sweep.cost), at(sweep, curve.best), at(sweep, curve.knee),
             may_be(sweep, curve), sweep.values[verdict.method.default_value],
             knee == nullptr ? TableValue() : TableValue(knee->efficiency.value),
             of_knee(&SizePoint::relative), by_default.relative, of_knee(&SizePoint::wrong_pixels),
             of_knee(&SizePoint::over), of_knee(&SizePoint::bytes), of_knee(&SizePoint::build_ms),
             note_of(sweep, curve)});
}

}  // namespace

int knees(const Lab& lab, const std::filesystem::path& results,
          const std::filesystem::path& written, bool json) {
  const std::vector<JudgedCell> cells = require_present_cells(results, lab.cullers);
  const std::vector<SizeResult> found = size_results(lab, cells, summarise(cells));
  if (!written.empty()) write_file(written, knees_text(found));
  Table table({"sweep", "dial", "culler", "parameter", "scene", "cost", "best", "knee",
               "may_be_knee", "default", "efficiency", "of_best", "default_of_best", "wrong_pixels",
               "over", "bytes", "build_ms", "note"});
  std::string not_run;
  bool any = false;
  for (const SizeResult& result : found) {
    if (!result.was_measured()) {
      not_run += (not_run.empty() ? "" : ", ") + result.sweep.name;
      continue;
    }
    any = true;
    for (const SizeVerdict& verdict : result.verdicts) {
      for (const SizeCurve& scene : verdict.scenes) {
        add_curve(result.sweep, verdict, scene,
                  scene.scene + (scene.path.empty() ? "" : ", " + scene.path), table);
      }
      add_curve(result.sweep, verdict, verdict.common, all_scenes, table);
    }
  }
  if (!any) {
    throw InputError("no size sweep was run into " + results.string() +
                     "; run some with 'vislab run model_size'");
  }
  table.print(std::cout, json);
  const std::filesystem::path reasons = lab.size_sweeps / "coverage" / "entries.toml";
  if (std::filesystem::exists(reasons)) {
    std::vector<SizeSweep> sweeps;
    for (const SizeResult& result : found) sweeps.push_back(result.sweep);
    std::cerr << size_coverage(sweeps, lab.cullers, reasons).text() << '\n';
  }
  if (!not_run.empty()) std::cerr << "not run: " << not_run << '\n';
  return 0;
}

}  // namespace vislab
