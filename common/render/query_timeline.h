// One frame on a modelled graphics processor as a time line: what processor and device do when.
#pragma once

#include <string>
#include <vector>

#include "common/render/gpu_clock.h"
#include "common/render/png.h"

namespace vislab {

struct TimelineRow {
  std::string name;  // of the culler
  std::vector<GpuCommand> commands;
};

struct TimelineInput {
  std::string title;  // with the device
  std::vector<TimelineRow> rows;
};

/// How long each clock ran for what, microseconds.
struct TimelineFigures {
  double frame_us = 0.0;   // until the last command's end on either clock
  double waits_us = 0.0;   // of the host: waits and polls
  double device_us = 0.0;  // the device was busy
  std::uint64_t draws = 0, queries = 0, boxes = 0, state_changes = 0;
};
TimelineFigures figures_of(const std::vector<GpuCommand>& commands);

/// Two lanes a row, processor above device, each row over its own milliseconds. Throws
/// std::logic_error without a row. O(commands).
Image render_query_timeline(const TimelineInput& input);

}  // namespace vislab
