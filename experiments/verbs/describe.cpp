#include <algorithm>
#include <iostream>

#include "common/judge/metrics.h"
#include "common/scene/error.h"
#include "common/scene/quake_world.h"
#include "experiments/devices/device_spec.h"
#include "experiments/matrix/matrix.h"
#include "experiments/matrix/size_sweep.h"
#include "experiments/matrix/sweep.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

/// Facts of one thing: lines of "key: value", or one JSON object.
class Facts {
 public:
  void add(const std::string& key, TableValue value) {
    keys_.push_back(key);
    values_.push_back(std::move(value));
  }
  void print(std::ostream& out, bool json) const {
    if (json) {
      Table table(keys_);
      table.add(values_);
      table.print_json(out);
      return;
    }
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      out << keys_[i] << ": " << to_text(values_[i]) << '\n';
    }
  }

 private:
  std::vector<std::string> keys_;
  std::vector<TableValue> values_;
};

std::string joined(const std::vector<std::string>& parts, const std::string& separator) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : separator) + part;
  return text;
}

void add_parameter(const ParameterSpec& parameter, const std::string& stage, Facts& facts) {
  facts.add("parameter " + parameter.name,
            "default " + parameter.default_value +
                (parameter.unit.empty() ? "" : " " + parameter.unit) + "; " + parameter.allowed() +
                "; " + stage + parameter.meaning);
}

void describe_culler(const Registry& cullers, const std::string& chain, bool json) {
  const std::unique_ptr<ICuller> culler = cullers.make(chain);
  const CullerInfo& info = culler->info();
  Facts facts;
  facts.add("name", cullers.short_name(chain));
  facts.add("family", info.family);
  facts.add("summary", info.summary);
  facts.add("guarantee", std::string(to_string(info.guarantee)));
  facts.add("repeatability", std::string(to_string(info.repeatability)));
  facts.add("granularity", std::string(to_string(info.granularity)));
  facts.add("culls", std::string(to_string(info.culls)));
  facts.add("space", std::string(to_string(info.space)));
  facts.add("stage", std::string(to_string(info.stage)));
  facts.add("needs_device", std::string(info.needs_device ? "yes" : "no"));
  facts.add("cost", info.cost);
  facts.add("limits", info.limits);
  facts.add("sources", joined(info.sources, "; "));
  for (const ParameterSpec& parameter : info.parameters) {
    add_parameter(parameter, parameter.stage == ParameterSpec::Stage::build ? "build; " : "query; ",
                  facts);
  }
  facts.print(std::cout, json);
}

void add_quake_report(const QuakeReport& report, Facts& facts) {
  facts.add("leaves_open_to_outside", std::uint64_t{report.leaves_open_to_outside});
  facts.add("solid_leaves_bare_on_several_sides", std::uint64_t{report.see_through_leaves});
  facts.add("blind_clusters", std::uint64_t{report.blind_clusters});
  facts.add("unseen_neighbours", std::uint64_t{report.unseen_neighbours});
}

void describe_scene(const Lab& lab, const std::string& name, bool json) {
  const LoadedScene loaded = load_scene(name, lab.data);
  const Scene& scene = loaded.scene;
  Facts facts;
  facts.add("name", scene.name);
  facts.add("description", loaded.description);
  facts.add("default_path", loaded.default_path);
  facts.add("objects", std::uint64_t{scene.object_count()});
  facts.add("meshes", std::uint64_t{scene.meshes.size()});
  facts.add("triangles", std::uint64_t{scene.triangle_count()});
  facts.add("cells", std::uint64_t{scene.cells.size()});
  facts.add("portals", std::uint64_t{scene.portals.size()});
  facts.add("open_meshes", std::uint64_t{scene.report.open_meshes});
  facts.add("self_intersecting_meshes", std::uint64_t{scene.report.self_intersecting_meshes});
  facts.add("zero_area_triangles", std::uint64_t{scene.report.zero_area_triangles});
  facts.add("unused_bad_vertices", std::uint64_t{scene.report.unused_bad_vertices});
  if (scene.quake) add_quake_report(scene.quake->report, facts);
  const glm::dvec3 size = scene.bounds().half_size() * 2.0;
  facts.add("width_m", size.x);
  facts.add("height_m", size.y);
  facts.add("depth_m", size.z);
  facts.add("content_hash", scene.content_hash());
  facts.print(std::cout, json);
}

/// Expectations, one a culler.
void describe_sweep(const Lab& lab, const std::string& name, bool json) {
  const Sweep sweep = load_sweep(name, lab.sweeps, "out/results", lab.cullers);
  Facts facts;
  facts.add("name", sweep.name);
  facts.add("description", sweep.description);
  facts.add("failure", sweep.failure);
  facts.add("dial", sweep.dial.name);
  facts.add("unit", sweep.dial.unit);
  facts.add("values", joined(sweep.dial.texts, ", "));
  facts.add(sweep.limit.is_counter ? "counter" : "metric", sweep.limit.metric);
  if (sweep.limit.at_most) facts.add("at_most", *sweep.limit.at_most);
  if (sweep.limit.at_least) facts.add("at_least", *sweep.limit.at_least);
  if (sweep.limit.against) facts.add("against", sweep.methods[*sweep.limit.against].culler);
  if (sweep.limit.at_most_ratio) facts.add("at_most_ratio", *sweep.limit.at_most_ratio);
  for (const SweepMethod& method : sweep.methods) {
    std::string expected = "nothing expected";
    if (const auto& expectation = method.expectation) {
      expected = (expectation->never ? "never breaks"
                                     : "breaks within " + to_text(expectation->low) + " to " +
                                           to_text(expectation->high)) +
                 std::string("; ") + expectation->because + " (" + expectation->source + ")";
    }
    facts.add("culler " + method.culler, expected);
  }
  facts.print(std::cout, json);
}

void describe_size_sweep(const Lab& lab, const std::string& name, bool json) {
  const SizeSweep sweep = load_size_sweep(name, lab.size_sweeps, lab.cullers);
  Facts facts;
  facts.add("name", sweep.name);
  facts.add("description", sweep.description);
  facts.add("dial", sweep.dial);
  facts.add("unit", sweep.unit);
  facts.add("values", joined(sweep.values, ", "));
  facts.add("cost", to_string(sweep.cost) + ": " + sweep.because);
  for (const SizeMethod& method : sweep.methods) {
    facts.add("culler " + method.culler, method.parameter + ", default " +
                                             sweep.values[method.default_value] +
                                             (method.note.empty() ? "" : "; " + method.note));
  }
  for (const Block& block : sweep.blocks) facts.add("block", block.title());
  facts.print(std::cout, json);
}

/// The dials of a modelled device stand with the defaults of its preset.
void describe_device(const std::string& text, bool json) {
  const DeviceSpec device = parse_device(text);
  Facts facts;
  facts.add("name", device.text);
  for (const auto& [name, meaning] : list_devices()) {
    if (name == device.text) facts.add("meaning", meaning);
  }
  if (device.kind == DeviceSpec::Kind::modelled) {
    facts.add("preset " + device.preset, std::string(gpu_preset(device.preset).meaning));
  }
  for (const ParameterSpec& parameter : device_parameters(device)) {
    add_parameter(parameter, "", facts);
  }
  facts.print(std::cout, json);
}

bool describe_metric(const std::string& name, bool json) {
  const auto metric = std::ranges::find(metrics(), name, &Metric::name);
  if (metric == metrics().end()) return false;
  Facts facts;
  facts.add("name", name);
  facts.add("unit", std::string(metric->unit));
  facts.add("meaning", std::string(metric->meaning));
  facts.print(std::cout, json);
  return true;
}

}  // namespace

int describe(const Lab& lab, const std::string& name, bool json) {
  const std::string first = name.substr(0, name.find_first_of("[> "));
  if (lab.cullers.entries().contains(first)) {
    describe_culler(lab.cullers, name, json);
    return 0;
  }
  if (first == "osmesa" || first == "modelled") {
    describe_device(name, json);
    return 0;
  }
  const auto scenes = list_scenes(lab.data);
  if (std::ranges::find(scenes, name, &SceneSummary::name) != scenes.end() ||
      std::filesystem::exists(name)) {
    describe_scene(lab, name, json);
    return 0;
  }
  for (const auto& [matrix, description] : list_matrices(lab.matrices)) {
    if (matrix != name) continue;
    Facts facts;
    facts.add("name", name);
    facts.add("description", description);
    facts.add("blocks", std::uint64_t{load_matrix(name, lab.matrices, lab.cullers).blocks.size()});
    facts.print(std::cout, json);
    return 0;
  }
  for (const auto& [sweep, description] : list_sweeps(lab.sweeps)) {
    if (sweep != name) continue;
    describe_sweep(lab, name, json);
    return 0;
  }
  if (std::filesystem::is_regular_file(lab.size_sweeps / (name + ".toml"))) {
    describe_size_sweep(lab, name, json);
    return 0;
  }
  if (describe_metric(name, json)) return 0;
  throw InputError(
      "nothing is called '" + name +
      "'; see 'vislab list cullers', 'list scenes', 'list matrices', 'list metrics' and 'list "
      "devices'");
}

}  // namespace vislab
