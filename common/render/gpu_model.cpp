#include "common/render/gpu_model.h"

#include <array>
#include <charconv>
#include <cmath>

#include "common/scene/error.h"

namespace vislab {
namespace {

constexpr double greatest_us = 1e6;
constexpr double greatest_ns = 1e6;

constexpr std::array<GpuDial, 20> dials = {{
    {"frame_us", &GpuModel::frame_us, 0.0, greatest_us,
     "Host time of beginning a frame, in µs: clearing, and what else is set up anew."},
    {"draw_us", &GpuModel::draw_us, 0.0, greatest_us,
     "Host time of one object's draw call, in µs."},
    {"host_triangle_ns", &GpuModel::host_triangle_ns, 0.0, greatest_ns,
     "Host time of a triangle that is drawn, in ns: what a renderer in software does to vertices "
     "on the calling thread; 0 for a real graphics processor."},
    {"host_shown_triangle_ns", &GpuModel::host_shown_triangle_ns, 0.0, greatest_ns,
     "Host time of a triangle of an object that covers samples, beside host_triangle_ns, in ns: "
     "what "
     "a renderer in software does to sort it into tiles; 0 for a real graphics processor."},
    {"state_change_us", &GpuModel::state_change_us, 0.0, greatest_us,
     "Host time of going from drawing to asking or back, in µs."},
    {"query_us", &GpuModel::query_us, 0.0, greatest_us,
     "Host time of issuing a query and of reading its answer, in µs."},
    {"box_us", &GpuModel::box_us, 0.0, greatest_us, "Host time of each box of a query, in µs."},
    {"flush_us", &GpuModel::flush_us, 0.0, greatest_us,
     "Host time of handing over what gathered, in µs, whoever causes it."},
    {"poll_us", &GpuModel::poll_us, 1e-3, greatest_us,
     "Host time of asking whether an answer is there, in µs; never 0, so that loops that poll "
     "end."},
    {"device_draw_us", &GpuModel::device_draw_us, 0.0, greatest_us,
     "Device time of one object's draw, in µs, beside its triangles and samples."},
    {"triangle_ns", &GpuModel::triangle_ns, 0.0, greatest_ns,
     "Device time of a triangle that is drawn or of a box's twelve, in ns."},
    {"shown_triangle_ns", &GpuModel::shown_triangle_ns, 0.0, greatest_ns,
     "Device time of a triangle of an object that covers samples, beside triangle_ns, in ns."},
    {"outline_ns", &GpuModel::outline_ns, 0.0, greatest_ns,
     "Device time of a pixel of a triangle's width and height, in ns: blocks of samples that it "
     "covers in part are worked on as a whole."},
    {"pixel_ns", &GpuModel::pixel_ns, 0.0, greatest_ns,
     "Device time of a sample that is covered, near enough or not, in ns: the reciprocal of the "
     "fill rate."},
    {"device_query_us", &GpuModel::device_query_us, 0.0, greatest_us,
     "Device time of a query, in µs, beside its triangles and samples."},
    {"device_state_change_us", &GpuModel::device_state_change_us, 0.0, greatest_us,
     "Device time of going from drawing to asking or back, in µs: the pipeline runs empty."},
    {"device_batch_us", &GpuModel::device_batch_us, 0.0, greatest_us,
     "Device time of beginning with what was handed over, in µs."},
    {"latency_us", &GpuModel::latency_us, 0.0, greatest_us,
     "From the device's being done with a query to the host's seeing the answer, in µs."},
    {"pipeline_depth", &GpuModel::pipeline_depth, 1.0, 1e9,
     "Commands (objects and queries) that gather before they are handed over without a flush."},
    {"serial", &GpuModel::serial, 0.0, 1.0,
     "1: the host stands still while the device works, as with a renderer in software on the "
     "calling thread."},
}};

// Wloka's figure is for 2003: 25,000 batches a second for each GHz of the processor, under Direct3D
// 9. The GeForce GTX 280's data sheet says 602 MHz, a triangle a clock, 32 samples a clock; half of
// that is a usual yield. The rest is estimated.
constexpr GpuModel gpu_2008{.draw_us = 10.0,
                            .state_change_us = 8.0,
                            .query_us = 6.0,
                            .box_us = 0.5,
                            .flush_us = 5.0,
                            .poll_us = 0.5,
                            .device_draw_us = 0.5,
                            .triangle_ns = 3.3,
                            .pixel_ns = 0.1,
                            .device_query_us = 0.5,
                            .device_state_change_us = 2.0,
                            .device_batch_us = 5.0,
                            .latency_us = 50.0,
                            .pipeline_depth = 64};

// The GeForce RTX 3080's data sheet: 1.71 GHz, 6 triangles and 96 samples a clock; half of that.
constexpr GpuModel modern_gpu{.draw_us = 1.0,
                              .state_change_us = 1.0,
                              .query_us = 1.0,
                              .box_us = 0.05,
                              .flush_us = 20.0,
                              .poll_us = 0.1,
                              .device_draw_us = 0.2,
                              .triangle_ns = 0.2,
                              .pixel_ns = 0.012,
                              .device_query_us = 0.3,
                              .device_state_change_us = 2.0,
                              .device_batch_us = 10.0,
                              .latency_us = 500.0,
                              .pipeline_depth = 1024};

constexpr GpuModel typical_osmesa{.draw_us = 3.6,
                                  .host_triangle_ns = 170.0,
                                  .state_change_us = 5.0,
                                  .query_us = 8.0,
                                  .box_us = 2.0,
                                  .flush_us = 15.0,
                                  .poll_us = 0.2,
                                  .device_draw_us = 0.2,
                                  .triangle_ns = 20.0,
                                  .pixel_ns = 1.5,
                                  .device_query_us = 2.0,
                                  .device_batch_us = 20.0,
                                  .latency_us = 5.0,
                                  .pipeline_depth = 100'000};

constexpr std::array<GpuPreset, 3> presets = {{
    {"gpu", gpu_2008,
     "A discrete graphics processor of 2008: draws after Wloka (Batch, Batch, Batch, 2003) on 3 "
     "GHz, rates after the data sheet of the GeForce GTX 280, halved; the rest is estimated."},
    {"modern", modern_gpu,
     "A discrete graphics processor of 2020: rates after the data sheet of the GeForce RTX 3080, "
     "halved; cheap draws and a long way back, estimated."},
    {"osmesa", typical_osmesa,
     "OSMesa (llvmpipe) with two threads, typical figures; is fitted to this machine where it is "
     "compared with OSMesa."},
}};

std::string names(auto&& named) {
  std::string list;
  for (const auto& one : named) list += (list.empty() ? "" : ", ") + std::string(one.name);
  return list;
}

/// The shortest that reads back as the same, without an exponent.
std::string number(double value) {
  std::array<char, 400> text;
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  return {text.data(), end};
}

}  // namespace

double GpuDial::value(const GpuModel& model) const {
  return std::visit([&](auto which) { return static_cast<double>(model.*which); }, member);
}

void GpuDial::set(GpuModel& model, double value) const {
  const bool whole = !std::holds_alternative<double GpuModel::*>(member);
  // Written so that NaN is refused.
  if (!(value >= least && value <= greatest) || (whole && value != std::floor(value))) {
    throw InputError("the dial " + std::string(name) + " is " + number(value) + ": it must be " +
                     (whole ? "a whole number " : "") + "from " + number(least) + " to " +
                     number(greatest));
  }
  std::visit(
      [&](auto which) {
        auto& place = model.*which;
        place = static_cast<std::remove_reference_t<decltype(place)>>(value);
      },
      member);
}

std::span<const GpuDial> gpu_dials() { return dials; }

const GpuDial& gpu_dial(std::string_view name) {
  for (const GpuDial& dial : dials) {
    if (dial.name == name) return dial;
  }
  throw InputError("a modelled GPU has no dial '" + std::string(name) +
                   "'; there are: " + names(dials));
}

void check(const GpuModel& model) {
  GpuModel copy;
  for (const GpuDial& dial : dials) dial.set(copy, dial.value(model));
}

std::span<const GpuPreset> gpu_presets() { return presets; }

const GpuPreset& gpu_preset(std::string_view name) {
  for (const GpuPreset& preset : presets) {
    if (preset.name == name) return preset;
  }
  throw InputError("there is no preset '" + std::string(name) +
                   "' of a modelled GPU; there are: " + names(presets));
}

std::string to_text(const GpuModel& model) {
  std::string text;
  for (const GpuDial& dial : dials) {
    text += (text.empty() ? "" : ", ") + std::string(dial.name) + "=" + number(dial.value(model));
  }
  return text;
}

}  // namespace vislab
