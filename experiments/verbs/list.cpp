#include <iostream>

#include "common/judge/metrics.h"
#include "common/scene/error.h"
#include "experiments/devices/device_spec.h"
#include "experiments/matrix/matrix.h"
#include "experiments/matrix/sweep.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

std::string text(std::string_view view) { return std::string(view); }

void list_cullers(const Lab& lab, bool json) {
  Table table({"name", "guarantee", "repeatability", "granularity", "space", "summary"});
  for (const auto& [name, entry] : lab.cullers.entries()) {
    const CullerInfo& info = entry.info;
    table.add({name, text(to_string(info.guarantee)), text(to_string(info.repeatability)),
               text(to_string(info.granularity)), text(to_string(info.space)), info.summary});
  }
  table.print(std::cout, json);
}

void list_scenes_of(const Lab& lab, bool json) {
  Table table({"name", "default_path", "description"});
  for (const SceneSummary& scene : list_scenes(lab.data)) {
    table.add({scene.name, scene.default_path, scene.description});
  }
  table.print(std::cout, json);
}

void list_matrices_of(const Lab& lab, bool json) {
  Table table({"name", "kind", "description"});
  for (const auto& [name, description] : list_matrices(lab.matrices)) {
    table.add({name, std::string("matrix"), description});
  }
  for (const auto& [name, description] : list_sweeps(lab.sweeps)) {
    table.add({name, std::string("stress sweep"), description});
  }
  for (const auto& [name, description] : list_matrices(lab.size_sweeps)) {
    table.add({name, std::string("size sweep"), description});
  }
  table.print(std::cout, json);
}

void list_metrics(bool json) {
  Table table({"name", "unit", "better", "meaning"});
  for (const Metric& metric : metrics()) {
    const char* better = metric.better == Metric::Better::lower    ? "lower"
                         : metric.better == Metric::Better::higher ? "higher"
                                                                   : "neither";
    table.add({text(metric.name), text(metric.unit), std::string(better), text(metric.meaning)});
  }
  table.print(std::cout, json);
}

void list_devices_of(bool json) {
  Table table({"name", "meaning"});
  for (const auto& [name, meaning] : list_devices()) table.add({name, meaning});
  table.print(std::cout, json);
}

}  // namespace

int list(const Lab& lab, const std::string& what, bool json) {
  if (what == "cullers") {
    list_cullers(lab, json);
  } else if (what == "scenes") {
    list_scenes_of(lab, json);
  } else if (what == "matrices") {
    list_matrices_of(lab, json);
  } else if (what == "metrics") {
    list_metrics(json);
  } else if (what == "devices") {
    list_devices_of(json);
  } else {
    throw unknown_name("list", what, {"cullers", "scenes", "matrices", "metrics", "devices"});
  }
  return 0;
}

}  // namespace vislab
