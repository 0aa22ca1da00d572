// What a modelled graphics processor costs: the dials of ModelledGpu.
//
// Idea: two clocks, one of the host (the thread that calls the device) and one of the graphics
// device, which works off commands in their order. What a call costs the host and what its command
// costs the device are dials; what waits for what follows from them (gpu_clock.h).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace vislab {

/// Microseconds (_us) and nanoseconds (_ns); meanings and ranges stand in gpu_dials().
struct GpuModel {
  // Of the host.
  double frame_us = 0.0;
  double draw_us = 0.0;
  double host_triangle_ns = 0.0;
  double host_shown_triangle_ns = 0.0;
  double state_change_us = 0.0;
  double query_us = 0.0;
  double box_us = 0.0;
  double flush_us = 0.0;
  double poll_us = 0.1;
  // Of the device.
  double device_draw_us = 0.0;
  double triangle_ns = 0.0;
  double shown_triangle_ns = 0.0;
  double outline_ns = 0.0;
  double pixel_ns = 0.0;
  double device_query_us = 0.0;
  double device_state_change_us = 0.0;
  double device_batch_us = 0.0;
  // Between the two.
  double latency_us = 0.0;
  int pipeline_depth = 256;
  bool serial = false;

  friend bool operator==(const GpuModel&, const GpuModel&) = default;
};

/// A dial by name. A value of `serial` is 0 or 1.
struct GpuDial {
  std::string_view name;
  std::variant<double GpuModel::*, int GpuModel::*, bool GpuModel::*> member;
  double least = 0.0, greatest = 0.0;
  std::string_view meaning;  // a sentence

  double value(const GpuModel& model) const;
  /// Throws InputError for a value out of range, or not whole where only whole numbers make sense.
  void set(GpuModel& model, double value) const;
};

/// All dials, in the order of GpuModel.
std::span<const GpuDial> gpu_dials();
/// Throws InputError for a name that there is not, with those that there are.
const GpuDial& gpu_dial(std::string_view name);
/// Throws InputError for the first dial that is out of its range.
void check(const GpuModel& model);

/// A named setting of all dials.
struct GpuPreset {
  std::string_view name;
  GpuModel model;
  std::string_view meaning;  // what it stands for, and where its figures come from
};

/// "gpu": a discrete graphics processor of about 2008, the first. "modern": cheap draws, a long
/// way back. "osmesa": typical of OSMesa on two cores; what is compared with OSMesa is fitted to it
/// first.
std::span<const GpuPreset> gpu_presets();
/// Throws InputError for a name that there is not, with those that there are.
const GpuPreset& gpu_preset(std::string_view name);

/// All dials and their values, separated by commas: "draw_us=5, host_triangle_ns=0, ...".
std::string to_text(const GpuModel& model);

}  // namespace vislab
