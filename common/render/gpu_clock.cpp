#include "common/render/gpu_clock.h"

#include <algorithm>
#include <limits>

namespace vislab {
namespace {

constexpr double us_of_ns = 1e-3;
constexpr double triangles_of_a_box = 12.0;

}  // namespace

GpuClock::GpuClock(const GpuModel& model) : model_(model) { check(model); }

void GpuClock::begin_frame() {
  host_us_ = model_.frame_us;
  device_us_ = 0.0;
  state_ = State::drawing;
  log_.clear();
  gathered_.clear();
  queries_.clear();
}

/// Begins a command of the log; `device_us` gets what a change of state costs the device.
std::size_t GpuClock::begin(GpuCommandKind kind, State state, double& device_us) {
  GpuCommand& command = log_.emplace_back();
  command.kind = kind;
  command.host.begin_us = host_us_;
  device_us = 0.0;
  if (state != state_) {
    command.changes_state = true;
    host_us_ += model_.state_change_us;
    device_us = model_.device_state_change_us;
    state_ = state;
  }
  return log_.size() - 1;
}

/// True if that made the pipeline full, so that everything was handed over.
bool GpuClock::gather(const Pending& pending) {
  gathered_.push_back(pending);
  if (gathered_.size() < static_cast<std::size_t>(model_.pipeline_depth)) return false;
  hand_over();
  return true;
}

void GpuClock::hand_over() {
  if (gathered_.empty()) return;
  GpuCommand flush;
  flush.kind = GpuCommandKind::flush;
  flush.count = static_cast<std::uint32_t>(gathered_.size());
  flush.host.begin_us = host_us_;
  host_us_ += model_.flush_us;
  flush.device.begin_us = std::max(device_us_, host_us_);
  device_us_ = flush.device.begin_us + model_.device_batch_us;
  flush.device.end_us = device_us_;
  std::size_t last = log_.size();
  for (const Pending& pending : gathered_) {
    GpuCommand& command = log_[pending.command];
    // A command of the log is handed over as a whole.
    if (pending.command != last) command.device.begin_us = device_us_;
    last = pending.command;
    device_us_ += pending.device_us;
    command.device.end_us = device_us_;
    if (pending.query != GpuCommand::none_query) queries_[pending.query] = device_us_;
  }
  gathered_.clear();
  if (model_.serial) host_us_ = std::max(host_us_, device_us_);
  flush.host.end_us = host_us_;
  log_.push_back(flush);
}

void GpuClock::draw(std::span<const Work> objects) {
  bool begun = false;
  std::size_t place = 0;
  for (const Work& work : objects) {
    double device_us = 0.0;
    if (!begun) place = begin(GpuCommandKind::draw, State::drawing, device_us);
    begun = true;
    const double shown = work.samples > 0 ? work.triangles : 0.0;
    host_us_ += model_.draw_us + work.triangles * (model_.host_triangle_ns * us_of_ns) +
                shown * (model_.host_shown_triangle_ns * us_of_ns);
    GpuCommand& command = log_[place];
    ++command.count;
    command.triangles += work.triangles;
    command.samples += work.samples;
    command.host.end_us = host_us_;
    device_us += model_.device_draw_us + work.triangles * (model_.triangle_ns * us_of_ns) +
                 shown * (model_.shown_triangle_ns * us_of_ns) +
                 static_cast<double>(work.outline_px) * (model_.outline_ns * us_of_ns) +
                 static_cast<double>(work.samples) * (model_.pixel_ns * us_of_ns);
    begun = !gather({place, device_us, GpuCommand::none_query});
  }
}

std::uint32_t GpuClock::query(std::uint32_t boxes, std::uint64_t samples,
                              std::uint64_t outline_px) {
  double device_us = 0.0;
  const std::size_t place = begin(GpuCommandKind::query, State::asking, device_us);
  const std::uint32_t index = query_count();
  queries_.push_back(std::numeric_limits<double>::infinity());
  host_us_ += model_.query_us + boxes * model_.box_us;
  GpuCommand& command = log_[place];
  command.count = boxes;
  command.triangles = std::uint64_t{boxes} * 12U;
  command.samples = samples;
  command.query = index;
  command.host.end_us = host_us_;
  device_us += model_.device_query_us +
               triangles_of_a_box * boxes * (model_.triangle_ns * us_of_ns) +
               static_cast<double>(outline_px) * (model_.outline_ns * us_of_ns) +
               static_cast<double>(samples) * (model_.pixel_ns * us_of_ns);
  gather({place, device_us, index});
  return index;
}

void GpuClock::flush() { hand_over(); }

bool GpuClock::poll(std::uint32_t query) {
  if (log_.empty() || log_.back().kind != GpuCommandKind::poll) {
    GpuCommand& command = log_.emplace_back();
    command.kind = GpuCommandKind::poll;
    command.host.begin_us = host_us_;
  }
  host_us_ += model_.poll_us;
  GpuCommand& command = log_.back();
  ++command.count;
  command.query = query;
  command.host.end_us = host_us_;
  return queries_[query] + model_.latency_us <= host_us_;
}

void GpuClock::wait(std::uint32_t query) {
  // What gathered behind the query stays: only a query that gathers itself has to be handed over.
  if (queries_[query] == std::numeric_limits<double>::infinity()) hand_over();
  stand_still_until(queries_[query] + model_.latency_us, query);
}

void GpuClock::finish() {
  hand_over();
  stand_still_until(device_us_, GpuCommand::none_query);
}

void GpuClock::stand_still_until(double time_us, std::uint32_t query) {
  if (time_us <= host_us_) return;
  GpuCommand& command = log_.emplace_back();
  command.kind = GpuCommandKind::wait;
  command.count = 1;
  command.query = query;
  command.host = {host_us_, time_us};
  host_us_ = time_us;
}

}  // namespace vislab
