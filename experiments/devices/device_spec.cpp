#include "experiments/devices/device_spec.h"

#include "common/culler/registry.h"
#include "common/render/modelled_gpu.h"
#include "common/render/osmesa_device.h"
#include "common/scene/error.h"

namespace vislab {
namespace {

constexpr const char* modelled = "modelled";
constexpr const char* preset_parameter = "preset";
constexpr const char* synchronous_parameter = "synchronous";

ParameterSpec parameter_of(const GpuDial& dial, const GpuModel& model) {
  const std::string name(dial.name);
  const std::string meaning(dial.meaning);
  const double value = dial.value(model);
  constexpr auto stage = ParameterSpec::Stage::query;
  if (std::holds_alternative<bool GpuModel::*>(dial.member)) {
    return ParameterSpec::boolean(name, value != 0.0, stage, meaning);
  }
  if (std::holds_alternative<int GpuModel::*>(dial.member)) {
    return ParameterSpec::integer(name, static_cast<long long>(value),
                                  static_cast<long long>(dial.least),
                                  static_cast<long long>(dial.greatest), "", stage, meaning);
  }
  const auto unit = name.ends_with("_ns") ? "ns" : name.ends_with("_us") ? "us" : "";
  return ParameterSpec::real(name, value, dial.least, dial.greatest, unit, stage, meaning);
}

double number_of(const ParameterSpec& spec, const ParameterValues& values) {
  switch (spec.type) {
    case ParameterSpec::Type::boolean:
      return values.boolean(spec.name) ? 1.0 : 0.0;
    case ParameterSpec::Type::integer:
      return static_cast<double>(values.integer(spec.name));
    default:
      return values.real(spec.name);
  }
}

std::vector<ParameterSpec> osmesa_parameters() {
  return {ParameterSpec::boolean(synchronous_parameter, false, ParameterSpec::Stage::query,
                                 "Mesa draws on the calling thread, so that answers do not depend "
                                 "on time and latency is gone")};
}

CullerSpec parse_one(std::string_view text) {
  std::vector<CullerSpec> stages;
  std::string wrong;
  try {
    stages = parse_chain(text);
  } catch (const InputError& error) {
    wrong = std::string(" (") + error.what() + ")";
  }
  if (stages.size() != 1) {
    throw InputError("device '" + std::string(text) + "'" + wrong +
                     ": a device is written name or name[parameter=value,...], such as "
                     "modelled[preset=gpu,latency_us=500]");
  }
  return stages.front();
}

std::vector<ParameterSpec> modelled_parameters(std::string_view preset) {
  const GpuModel& model = gpu_preset(preset).model;
  std::vector<std::string> names;
  for (const GpuPreset& known : gpu_presets()) names.emplace_back(known.name);
  std::vector<ParameterSpec> parameters{ParameterSpec::choice(
      preset_parameter, names.front(), names, ParameterSpec::Stage::query,
      "whose dials are taken where none are named; those of osmesa are fitted to OSMesa on this "
      "machine when the run starts")};
  for (const GpuDial& dial : gpu_dials()) parameters.push_back(parameter_of(dial, model));
  return parameters;
}

DeviceSpec modelled_spec(const std::map<std::string, std::string>& given) {
  const auto named = given.find(preset_parameter);
  DeviceSpec spec;
  spec.kind = DeviceSpec::Kind::modelled;
  spec.preset = named != given.end() ? named->second : std::string(gpu_presets().front().name);
  const std::vector<ParameterSpec> parameters = modelled_parameters(spec.preset);
  const ParameterValues values(modelled, parameters, given);
  spec.text = std::string(modelled) + "[" + preset_parameter + "=" + spec.preset;
  for (const ParameterSpec& parameter : parameters) {
    if (parameter.name == preset_parameter || !given.contains(parameter.name)) continue;
    const std::string& value = values.all().at(parameter.name);
    // A fitted dial is seldom what the preset has: one that is named is not fitted.
    if (value == parameter.default_value && !spec.is_fitted()) continue;
    spec.given[parameter.name] = number_of(parameter, values);
    spec.text += "," + parameter.name + "=" + value;
  }
  spec.text += "]";
  spec.synchronous = spec.is_fitted() && values.boolean("serial");
  check(spec.model(gpu_preset(spec.preset).model));
  return spec;
}

}  // namespace

GpuModel DeviceSpec::model(const GpuModel& preset_model) const {
  GpuModel model = preset_model;
  for (const auto& [name, value] : given) gpu_dial(name).set(model, value);
  return model;
}

std::vector<ParameterSpec> device_parameters(const DeviceSpec& spec) {
  switch (spec.kind) {
    case DeviceSpec::Kind::osmesa:
      return osmesa_parameters();
    case DeviceSpec::Kind::none:
      return {};
    case DeviceSpec::Kind::modelled:
      break;
  }
  return modelled_parameters(spec.preset);
}

DeviceSpec parse_device(std::string_view text) {
  const CullerSpec written = parse_one(text);
  if (written.name == modelled) return modelled_spec(written.parameters);
  DeviceSpec spec;
  if (written.name == "osmesa") {
    const ParameterValues values("osmesa", osmesa_parameters(), written.parameters);
    spec.synchronous = values.boolean(synchronous_parameter);
    if (spec.synchronous) spec.text += "[" + std::string(synchronous_parameter) + "=true]";
    return spec;
  }
  if (written.name != "none") {
    throw unknown_name("device", written.name, {"osmesa", "none", modelled});
  }
  if (!written.parameters.empty()) throw InputError("device none has no parameters");
  spec.kind = DeviceSpec::Kind::none;
  spec.text = "none";
  return spec;
}

std::unique_ptr<RenderDevice> make_device(const DeviceSpec& spec, const GpuModel& preset_model) {
  switch (spec.kind) {
    case DeviceSpec::Kind::none:
      return nullptr;
    case DeviceSpec::Kind::osmesa:
      return std::make_unique<OsMesaDevice>();
    case DeviceSpec::Kind::modelled:
      break;
  }
  return std::make_unique<ModelledGpu>(spec.model(preset_model));
}

std::vector<std::pair<std::string, std::string>> list_devices() {
  std::vector<std::pair<std::string, std::string>> devices{
      {"osmesa", "draws with OSMesa; times are real"},
      {"none", "nothing is drawn; only the method is timed"}};
  for (const GpuPreset& preset : gpu_presets()) {
    devices.emplace_back(parse_device(std::string(modelled) + "[" + preset_parameter + "=" +
                                      std::string(preset.name) + "]")
                             .text,
                         std::string(preset.meaning));
  }
  return devices;
}

}  // namespace vislab
