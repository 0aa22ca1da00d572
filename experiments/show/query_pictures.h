// Pictures of what cullers ask a device in one frame.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/culler/registry.h"
#include "common/render/gpu_clock.h"
#include "common/scene/path.h"
#include "experiments/show/recorded_device.h"

namespace vislab {

enum class QueryPicture {
  strip,    // changes between drawing and asking, each in another colour (query_strip.h)
  boxes,    // the boxes of every query (query_boxes.h)
  timeline  // what processor and device do when (query_timeline.h)
};
inline constexpr std::array query_pictures = {QueryPicture::strip, QueryPicture::boxes,
                                              QueryPicture::timeline};
std::string_view to_string(QueryPicture picture);

/// What a culler had a device do in a frame.
struct RecordedFrame {
  std::string culler;
  std::vector<RecordedState> states;
  std::uint64_t flushes = 0;
  std::vector<GpuCommand> commands;  // of a modelled device; else empty
};

/// Runs a culler over a whole path, for it may live on what it saw before, and keeps what it had
/// the device do in the last frame. The device is loaded with the scene first. `name` is how
/// pictures call the culler. Throws InputError for a culler that never asks a device.
RecordedFrame record_last_frame(const Registry& cullers, const std::string& chain,
                                const std::string& name, const Scene& scene, const Path& path,
                                const Viewport& viewport, RenderDevice& device, SceneState& state);

/// Writes a PNG with a row a culler. Throws InputError if a culler asked nothing, if a time line is
/// wanted of a device that keeps no log, or if the file cannot be written.
void write_query_picture(QueryPicture picture, const Scene& scene, const Frame& frame,
                         const std::string& title, const std::string& device,
                         const std::vector<RecordedFrame>& rows, const std::filesystem::path& file);

}  // namespace vislab
