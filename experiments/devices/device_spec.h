// The devices that a run may draw with, by their text, written as cullers are:
//   osmesa                                    draws with OSMesa, in real time, on the run's threads
//   osmesa[synchronous=true]                  the same on the calling thread: answers of queries
//   are
//                                             there at once, so nothing depends on time
//   none                                      nothing is drawn
//   modelled[preset=gpu,latency_us=500]       a modelled graphics processor, in its own time
// The parameters of `modelled` are the preset and the dials of common/render/gpu_model.h; a dial
// that is not named has the preset's value. With preset=osmesa that value is measured: the dials
// that are not named are fitted to OSMesa on this machine (experiments/calibration/device_fit.h).
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/culler/parameters.h"
#include "common/render/device.h"
#include "common/render/gpu_model.h"

namespace vislab {

struct DeviceSpec {
  enum class Kind { osmesa, none, modelled };

  Kind kind = Kind::osmesa;
  std::string preset;                   // of a modelled device
  std::map<std::string, double> given;  // dials that are named, by name
  /// The same for texts that mean the same: of a modelled device the preset, then what differs from
  /// it in the order of the dials. Results are kept under it.
  std::string text = "osmesa";

  bool synchronous =
      false;  // Mesa draws on the calling thread, as do works that dials are fitted to

  /// Are the dials that are not named to be fitted to OSMesa?
  bool is_fitted() const { return kind == Kind::modelled && preset == "osmesa"; }
  /// A modelled device's dials: those of `preset_model` (the preset's own, or the fitted ones) but
  /// for those that are named.
  GpuModel model(const GpuModel& preset_model) const;
  /// How many threads Mesa is to draw with beside the calling one, in a run on so many threads.
  int drawing_threads(int threads) const { return synchronous ? 0 : threads; }
};

/// Throws InputError for an unknown name, dial or preset, or a value out of range, and says what is
/// allowed.
DeviceSpec parse_device(std::string_view text);

/// Null for `none`. `preset_model` counts for modelled devices only.
std::unique_ptr<RenderDevice> make_device(const DeviceSpec& spec, const GpuModel& preset_model);

/// What may stand in the device's brackets. Of a modelled device the preset, then every dial with
/// the default that the preset gives it.
std::vector<ParameterSpec> device_parameters(const DeviceSpec& spec);

/// Texts and meanings of what there is to choose from: the devices, and each preset.
std::vector<std::pair<std::string, std::string>> list_devices();

}  // namespace vislab
