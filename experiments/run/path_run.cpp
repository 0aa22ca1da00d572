#include "experiments/run/path_run.h"

#include <chrono>
#include <optional>

#include "experiments/results/store.h"

namespace vislab {
namespace {

/// As a device draws them: ranges of one object that follow each other are one draw.
void count_draws(const std::vector<TriangleRange>& emitted, CellFrame& answer) {
  ObjectId object = none_id;
  std::uint32_t next = 0;
  for (const TriangleRange& range : emitted) {
    if (range.count == 0) continue;
    answer.draws += range.object != object ? 1 : 0;
    answer.pieces += range.object != object || range.first != next ? 1 : 0;
    object = range.object;
    next = range.first + range.count;
  }
}

VisibleSet triangles_of(std::span<const ObjectId> objects, const Scene& scene) {
  std::vector<VisibleSet::Run> runs;
  for (const ObjectId object : objects) {
    runs.push_back({scene.first_triangle(object), scene.triangle_count(object)});
  }
  return VisibleSet(std::move(runs));
}

}  // namespace

PathRun run_path(ICuller& culler, const Scene& scene, const Path& path, const Viewport& viewport,
                 std::uint64_t seed, SceneState& state, TimedDevice* device) {
  using Clock = std::chrono::steady_clock;
  using Milliseconds = std::chrono::duration<double, std::milli>;
  PathRun run;
  FrameSink sink;
  Counters before = culler.counters();
  double last_frame_ms = 0.0;
  culler.reset(seed);
  for_each_frame(path, state, viewport, [&](std::size_t, Frame& frame, const Changes& changes) {
    frame.last_frame_ms = last_frame_ms;
    sink.start(scene, frame, device);
    if (device != nullptr) device->reset_clock();

    const auto start = Clock::now();
    if (device != nullptr) device->begin_frame(frame);
    const auto begun = Clock::now();
    culler.update(frame, changes);
    const auto updated = Clock::now();
    const double device_before_ms = device != nullptr ? device->milliseconds() : 0.0;
    culler.cull(frame, Candidates::everything(), sink);
    const auto culled = Clock::now();
    const double device_after_ms = device != nullptr ? device->milliseconds() : 0.0;
    sink.draw_rest();
    if (device != nullptr) device->finish();
    const auto end = Clock::now();
    sink.record_rest();

    const std::optional<double> clock_ms = device != nullptr ? device->clock_ms() : std::nullopt;
    last_frame_ms = clock_ms.value_or(Milliseconds(end - start).count());
    run.round.frame_ms.push_back(last_frame_ms);
    run.round.update_us.push_back(1e3 * Milliseconds(updated - begun).count());
    run.round.cull_us.push_back(
        1e3 * (Milliseconds(culled - updated).count() - (device_after_ms - device_before_ms)));
    run.round.draw_ms.push_back(
        clock_ms.value_or(device != nullptr ? device->milliseconds() : 0.0));

    VisibleSet set = sink.recording().set();
    CellFrame answer;
    answer.set = set.hash();
    answer.submitted_triangles = set.triangle_count();
    count_draws(sink.recording().emitted(), answer);
    VisibleSet one_sided;
    if (device != nullptr && !device->one_sided().empty()) {
      one_sided = triangles_of(device->one_sided(), scene);
      answer.one_sided = one_sided.hash();
    }
    const std::span<const TriangleId> surface = culler.surface_image();
    if (!surface.empty()) answer.surface = surface_hash(surface);
    Counters after = culler.counters();
    for (std::size_t k = 0; k < after.size(); ++k) {
      const std::uint64_t old = k < before.size() ? before[k].second : 0;
      answer.counters[std::string(after[k].first)] = after[k].second - old;
    }
    if (device != nullptr && culler.info().needs_device) {
      for (const auto& [name, count] : device->counts().named()) {
        answer.counters[std::string(name)] = count;
      }
    }
    before = std::move(after);
    run.frames.push_back(std::move(answer));
    run.sets.push_back(std::move(set));
    run.one_sided.push_back(std::move(one_sided));
    run.surfaces.emplace_back(surface.begin(), surface.end());
  });
  return run;
}

}  // namespace vislab
