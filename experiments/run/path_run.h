// One culler over one path, once: times, sets and counters of every frame.
#pragma once

#include <vector>

#include "common/culler/culler.h"
#include "common/culler/visible_set.h"
#include "common/scene/path.h"
#include "experiments/results/cell.h"
#include "experiments/run/frame_sink.h"
#include "experiments/run/timed_device.h"

namespace vislab {

/// Calls visit(index, frame, changes) for every frame of a path, with the scene's state moved
/// along.
template <typename Function>
void for_each_frame(const Path& path, SceneState& state, const Viewport& viewport,
                    Function&& visit) {
  state.reset();
  for (std::size_t i = 0; i < path.frames.size(); ++i) {
    state.apply(path.frames[i].changes);
    Frame frame;
    frame.index = i;
    frame.camera = path.frames[i].camera;
    frame.viewport = viewport;
    frame.objects = state.view();
    visit(i, frame, path.frames[i].changes);
  }
}

/// What a pass over a path gives.
struct PathRun {
  Round round;                        // session and number left empty
  std::vector<VisibleSet> sets;       // by frame
  std::vector<VisibleSet> one_sided;  // by frame: triangles of objects drawn one-sided
  /// By frame: the images that hidden-surface algorithms painted, empty for other methods.
  std::vector<std::vector<TriangleId>> surfaces;
  std::vector<CellFrame> frames;  // hashes, sizes and counters; truth left empty
};

/// Resets the culler and runs it over the path. `device` may be null: nothing is drawn.
/// frame_ms is wall time from update to the device's finish; draw_ms the time inside device calls;
/// cull_us that of cull() without them. On a device that keeps a clock (RenderDevice::clock_ms)
/// frame_ms and draw_ms are its clock after finish(), and nothing else is in them; update_us and
/// cull_us are real time there, too, which is in neither. What cullers that need a device ask of it
/// (DeviceCounts) stands among their counters, in place of what they count themselves by the same
/// names.
PathRun run_path(ICuller& culler, const Scene& scene, const Path& path, const Viewport& viewport,
                 std::uint64_t seed, SceneState& state, TimedDevice* device);

}  // namespace vislab
