// The two clocks of a modelled graphics processor, and what passed on them in a frame.
//
// Idea: the host's clock runs with its calls only. Commands gather until pipeline_depth of them
//   wait, or a flush, a wait for an answer or the end of the frame hands them over; from then on
//   the device works them off in order, beginning at the later of the hand-over and the end of what
//   it did before. An answer is there latency_us after its query is done.
// Guarantee: the same calls give the same times, bit for bit: sums of doubles in a fixed order, no
//   real clock.
// Not modelled: the host's work between calls (a culler's own time is measured, not modelled),
//   caches, contention for memory, drivers that hand over on their own by time, and devices that
//   work on several commands at once or out of order.
// Cost: O(1) a command. Does not allocate once it has seen a frame as large.
// Source: own; the stalls and starvation that it shows are Wimmer and Bittner's, Hardware Occlusion
//   Queries Made Useful, GPU Gems 2, 2005.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/render/gpu_model.h"

namespace vislab {

/// From begin to end, microseconds since the frame began.
struct GpuInterval {
  double begin_us = 0.0;
  double end_us = 0.0;

  friend bool operator==(const GpuInterval&, const GpuInterval&) = default;
};

enum class GpuCommandKind {
  draw,   // one call, of any number of objects; or a part of it, if the pipeline was full within
  query,  // one query, of any number of boxes
  flush,  // commands handed over: asked for, or since pipeline_depth of them waited
  poll,   // asking whether answers are there, as often as `count` says, with nothing in between
  wait    // the host stands still until an answer is there or everything is drawn
};

/// What passed, in the host's order.
struct GpuCommand {
  GpuCommandKind kind = GpuCommandKind::draw;
  /// Objects drawn, boxes asked about, commands handed over, or polls; 1 for a wait.
  std::uint32_t count = 0;
  /// Submitted with a draw (a query submits 12 a box).
  std::uint64_t triangles = 0;
  /// Covered by what was drawn or asked about, whether near enough or not.
  std::uint64_t samples = 0;
  /// Of a query: its index in the frame. Of a poll or wait: that of the query it asked for last;
  /// none_query for a wait until everything is drawn.
  std::uint32_t query = none_query;
  bool changes_state =
      false;  // draws where the command before asked, or the other way; a frame begins drawing
  GpuInterval host;
  /// From the beginning of its first work to the end of its last; of draws, queries and flushes
  /// only, and only once it was handed over.
  GpuInterval device;

  static constexpr std::uint32_t none_query = 0xFFFFFFFFU;
};

class GpuClock {
 public:
  /// Throws InputError for a dial out of its range.
  explicit GpuClock(const GpuModel& model);

  const GpuModel& model() const { return model_; }

  void begin_frame();

  /// What one object, or the boxes of one query, submit.
  struct Work {
    std::uint32_t triangles = 0;
    std::uint64_t samples = 0;
    std::uint64_t outline_px = 0;  // widths and heights of its triangles in sum
  };
  /// One call that draws so many objects. Nothing, for none.
  void draw(std::span<const Work> objects);
  /// Returns the query's index in the frame.
  std::uint32_t query(std::uint32_t boxes, std::uint64_t samples, std::uint64_t outline_px = 0);
  void flush();
  /// True if the answer is there; takes poll_us.
  bool poll(std::uint32_t query);
  void wait(std::uint32_t query);
  void finish();

  std::uint32_t query_count() const { return static_cast<std::uint32_t>(queries_.size()); }
  /// Since begin_frame, on the host's clock, microseconds.
  double host_us() const { return host_us_; }
  /// When the device will be done with what it was handed.
  double device_us() const { return device_us_; }
  /// Of this frame.
  const std::vector<GpuCommand>& log() const { return log_; }

 private:
  enum class State { drawing, asking };
  struct Pending {
    std::size_t command = 0;  // of the log
    double device_us = 0.0;   // what it takes
    std::uint32_t query = GpuCommand::none_query;
  };

  std::size_t begin(GpuCommandKind kind, State state, double& device_us);
  bool gather(const Pending& pending);
  void hand_over();
  void stand_still_until(double time_us, std::uint32_t query);

  GpuModel model_;
  double host_us_ = 0.0;
  double device_us_ = 0.0;
  State state_ = State::drawing;
  std::vector<GpuCommand> log_;
  std::vector<Pending> gathered_;
  std::vector<double> queries_;  // when the device is done with each; infinite before hand-over
};

}  // namespace vislab
