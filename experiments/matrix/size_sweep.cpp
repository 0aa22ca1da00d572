#include "experiments/matrix/size_sweep.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "experiments/matrix/resolution.h"
#include "experiments/matrix/toml_keys.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;
using namespace toml_keys;

constexpr std::string_view gap = "${dial}";
constexpr std::size_t fewest_values = 3, fewest_scenes = 2;

std::string required_text(const toml::table& table, std::string_view key, const std::string& what,
                          const std::string& file) {
  const auto text = value_of<std::string>(table, key, "a text", file);
  if (!text) throw InputError(file + ": " + std::string(key) + " of " + what + " is missing");
  return *text;
}

SizeCost read_cost(const toml::table& root, const std::string& file) {
  const std::string text = required_text(root, "cost", "a size sweep", file);
  std::vector<std::string> known;
  for (const SizeCost cost :
       {SizeCost::frame_ms, SizeCost::modelled_frame_ms, SizeCost::decision_us}) {
    if (text == to_string(cost)) return cost;
    known.push_back(to_string(cost));
  }
  throw InputError(place(file, *root.get("cost")) + ": " +
                   unknown_name("cost", text, known).what());
}

std::vector<std::string> read_values(const toml::table& root, const std::string& file) {
  const toml::node* const node = root.get("values");
  const toml::array* const list = node == nullptr ? nullptr : node->as_array();
  const auto wrong = [&] {
    return InputError((node == nullptr ? file : place(file, *node)) +
                      ": values must be a list of at least " + std::to_string(fewest_values) +
                      " numbers or texts, each once, from the smallest model to the largest");
  };
  if (list == nullptr || list->size() < fewest_values) throw wrong();
  std::vector<std::string> values;
  for (const toml::node& entry : *list) {
    if (const auto whole = entry.value_exact<std::int64_t>()) {
      values.push_back(std::to_string(*whole));
    } else if (const auto number = entry.value_exact<double>(); number && std::isfinite(*number)) {
      char digits[32];
      values.emplace_back(digits, std::to_chars(digits, digits + sizeof digits, *number).ptr);
    } else if (const auto text = entry.value_exact<std::string>()) {
      values.push_back(*text);
    } else {
      throw wrong();
    }
    if (std::ranges::count(values, values.back()) > 1) throw wrong();
  }
  return values;
}

/// The parameter that stands as "${dial}" in the one culler that `text` is.
SizeMethod read_method(const std::string& text, const std::vector<std::string>& values,
                       const Registry& registry) {
  const std::vector<CullerSpec> stages = parse_chain(text);
  SizeMethod method;
  for (const CullerSpec& stage : stages) {
    for (const auto& [parameter, value] : stage.parameters) {
      if (value != gap) continue;
      if (!method.culler.empty()) throw InputError("'" + text + "' has ${dial} twice");
      method.culler = stage.name;
      method.parameter = parameter;
    }
  }
  if (stages.size() != 1 || method.culler.empty()) {
    throw InputError("'" + text + "' must be one culler with ${dial} as one of its parameters");
  }
  for (const std::string& value : values) {
    std::string chain = text;
    chain.replace(chain.find(gap), gap.size(), value);
    method.chains.push_back(registry.canonical(chain));
    if (std::ranges::count(method.chains, method.chains.back()) > 1) {
      throw InputError("two of the values are the same to '" + text + "'");
    }
  }
  const std::vector<ParameterSpec>& parameters = registry.entry(method.culler).info.parameters;
  const auto spec = std::ranges::find(parameters, method.parameter, &ParameterSpec::name);
  std::string chain = text;
  chain.replace(chain.find(gap), gap.size(), spec->default_value);
  const auto found = std::ranges::find(method.chains, registry.canonical(chain));
  if (found == method.chains.end()) {
    throw InputError("values must hold " + spec->default_value + ", which is the default of " +
                     method.parameter + " of " + method.culler);
  }
  method.default_value = static_cast<std::size_t>(found - method.chains.begin());
  return method;
}

/// Reads one file.
class SizeSweepReader {
 public:
  SizeSweepReader(const fs::path& path, const Registry& registry)
      : file_(path.string()), root_(parse_file(path)), registry_(registry) {
    sweep_.name = path.stem().string();
  }

  SizeSweep read() {
    std::vector<std::string> known{"description", "dial",   "unit",    "cullers",
                                   "values",      "cost",   "because", "resolution",
                                   "frames",      "scenes", "notes",   "off_knee"};
    known.insert(known.end(), pass_keys.begin(), pass_keys.end());
    refuse_unknown_keys(root_, known, "a size sweep", file_);
    sweep_.description = required_text(root_, "description", "a size sweep", file_);
    sweep_.dial = required_text(root_, "dial", "a size sweep", file_);
    sweep_.unit = value_of<std::string>(root_, "unit", "a text", file_).value_or("");
    sweep_.because = required_text(root_, "because", "a size sweep", file_);
    sweep_.cost = read_cost(root_, file_);
    sweep_.values = read_values(root_, file_);
    read_methods();
    read_texts("notes", "text", &SizeMethod::note);
    read_texts("off_knee", "because", &SizeMethod::off_knee);
    read_blocks();
    return std::move(sweep_);
  }

 private:
  void read_methods() {
    const toml::node* const list = root_.get("cullers");
    if (list == nullptr) throw InputError(file_ + ": cullers, a list of texts, is missing");
    for (const std::string& text : text_list(*list, "cullers", file_)) {
      try {
        sweep_.methods.push_back(read_method(text, sweep_.values, registry_));
      } catch (const InputError& error) {
        throw InputError(place(file_, *list) + ": " + error.what());
      }
    }
  }

  /// Tables `list`, each with a culler and a text for it under `key`.
  void read_texts(const std::string& list, const std::string& key, std::string SizeMethod::*text) {
    const toml::array* const entries = tables(root_, list, file_);
    if (entries == nullptr) return;
    const std::string what = "[[" + list + "]]";
    for (const toml::node& node : *entries) {
      const toml::table& table = *node.as_table();
      refuse_unknown_keys(table, {"culler", key}, what, file_);
      const std::string culler = required_text(table, "culler", what, file_);
      const auto method = std::ranges::find(sweep_.methods, culler, &SizeMethod::culler);
      if (method == sweep_.methods.end()) {
        throw InputError(place(file_, node) + ": cullers has no " + culler);
      }
      (*method).*text = required_text(table, key, what, file_);
    }
  }

  int frames_of(const toml::table& table, int otherwise) const {
    const toml::node* const node = table.get("frames");
    return node == nullptr ? otherwise : whole_number(*node, "frames", 1, 100000, file_);
  }

  void read_blocks() {
    PassSettings pass;
    read_pass_settings(root_, pass, file_);
    Block settings;
    settings.rounds = pass.rounds;
    settings.seed = pass.seed;
    settings.threads = pass.threads;
    settings.timeout_s = pass.timeout_s;
    settings.device = canonical_device(pass.draw, root_.get("draw"), file_);
    settings.frames = frames_of(root_, settings.frames);
    if (const auto text = value_of<std::string>(root_, "resolution", "a text", file_)) {
      try {
        settings.viewport = parse_resolution(*text);
      } catch (const InputError& error) {
        throw InputError(place(file_, *root_.get("resolution")) + ": " + error.what());
      }
    }
    std::vector<std::string> chains;
    for (const SizeMethod& method : sweep_.methods) {
      chains.insert(chains.end(), method.chains.begin(), method.chains.end());
    }
    const toml::array* const scenes = tables(root_, "scenes", file_);
    if (scenes == nullptr || scenes->size() < fewest_scenes) {
      throw InputError((scenes == nullptr ? file_ : place(file_, *scenes)) + ": write at least " +
                       std::to_string(fewest_scenes) + " [[scenes]]");
    }
    for (const toml::node& node : *scenes) {
      const toml::table& table = *node.as_table();
      refuse_unknown_keys(table, {"scene", "path", "frames"}, "[[scenes]]", file_);
      Block block = settings;
      block.scene = required_text(table, "scene", "[[scenes]]", file_);
      block.path = value_of<std::string>(table, "path", "a text", file_).value_or("");
      block.frames = frames_of(table, settings.frames);
      block.cullers = with_anchors(chains, registry_);
      sweep_.blocks.push_back(std::move(block));
    }
  }

  std::string file_;
  toml::table root_;
  const Registry& registry_;
  SizeSweep sweep_;
};

}  // namespace

std::string to_string(SizeCost cost) {
  switch (cost) {
    case SizeCost::frame_ms:
      return "frame_ms";
    case SizeCost::modelled_frame_ms:
      return "modelled_frame_ms";
    case SizeCost::decision_us:
      break;
  }
  return "decision_us";
}

std::string SizeSweep::setting(std::size_t value) const {
  return values[value] + (unit.empty() ? "" : " " + unit);
}

SizeSweep load_size_sweep(const std::string& name_or_file, const fs::path& folder,
                          const Registry& registry) {
  const fs::path named = folder / (name_or_file + ".toml");
  if (fs::is_regular_file(named)) return SizeSweepReader(named, registry).read();
  if (fs::is_regular_file(name_or_file)) return SizeSweepReader(name_or_file, registry).read();
  std::vector<std::string> known;
  for (const auto& [name, text] : list_matrices(folder)) known.push_back(name);
  throw unknown_name("size sweep (or file)", name_or_file, known);
}

std::vector<SizeSweep> load_size_sweeps(const fs::path& folder, const Registry& registry) {
  std::vector<SizeSweep> sweeps;
  for (const auto& [name, text] : list_matrices(folder)) {  // both are TOML with a description
    sweeps.push_back(load_size_sweep(name, folder, registry));
  }
  return sweeps;
}

}  // namespace vislab
