// Runs a method that asks a device through a short play, and holds what was kept to the device's
// image. Test-only.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/judge/image_judge.h"
#include "experiments/run/timed_device.h"
#include "tests/algorithms/depth_damage.h"

namespace vislab {

/// Draws on a device what is emitted, when the culler asks for it and at the end.
class DrawingSink : public RecordingSink {
 public:
  explicit DrawingSink(RenderDevice& device) : device_(&device) {}

  void begin(const Scene& scene, const Frame& frame) {
    start(scene, frame);
    drawn_ = 0;
    device_->begin_frame(frame);
  }
  void flush() override {
    RecordingSink::flush();
    device_->draw(std::span<const TriangleRange>(emitted()).subspan(drawn_));
    drawn_ = emitted().size();
  }

 private:
  RenderDevice* device_;
  std::size_t drawn_ = 0;
};

/// What a method did in each frame of a play.
struct QueryFrame {
  std::vector<ObjectId> kept;  // in the order of drawing
  DeviceCounts counts;
  Counters counters;           // of the method, in all frames so far
  std::uint64_t image_px = 0;  // undisputed pixels of the image that changed
  std::uint64_t disputed_image_px = 0;
};

/// A play, and the truth of its frames, which is traced once.
class QueryPlay {
 public:
  QueryPlay(Play play, const Viewport& viewport) : play_(std::move(play)), viewport_(viewport) {
    TruthSettings settings;
    settings.jitter_per_pixel = 1;
    RayCaster caster(play_.scene, settings);
    SceneState state(play_.scene);
    for (std::size_t i = 0; i < play_.steps.size(); ++i) {
      state.apply(play_.steps[i].changes);
      truth_.push_back(caster.trace(frame(i, state)));
    }
    judge_.emplace(play_.scene);
  }

  const Scene& scene() const { return play_.scene; }

  /// Through all frames; the device's scene is loaded first.
  std::vector<QueryFrame> run(const std::string& spec, RenderDevice& plain_device) {
    return passes(spec, plain_device, 1).front();
  }

  /// The same method through all frames, and once more after a reset.
  std::array<std::vector<QueryFrame>, 2> run_twice(const std::string& spec,
                                                   RenderDevice& plain_device) {
    auto frames = passes(spec, plain_device, 2);
    return {std::move(frames[0]), std::move(frames[1])};
  }

  /// Undisputed pixels that change in all frames together.
  std::uint64_t image_px(const std::string& spec, RenderDevice& device) {
    std::uint64_t sum = 0;
    for (const QueryFrame& now : run(spec, device)) sum += now.image_px;
    return sum;
  }

 private:
  std::vector<std::vector<QueryFrame>> passes(const std::string& spec, RenderDevice& plain_device,
                                              int count) {
    TimedDevice device(plain_device);
    device.load(play_.scene);
    BuildContext context;
    context.device = &device;
    CullerRun run(spec, play_.scene, context);
    std::vector<std::vector<QueryFrame>> all;
    for (int i = 0; i < count; ++i) {
      if (i > 0) run.culler().reset(1);
      all.push_back(pass(run.culler(), device));
    }
    return all;
  }

  std::vector<QueryFrame> pass(ICuller& culler, TimedDevice& device) {
    SceneState state(play_.scene);
    DrawingSink sink(device);
    std::vector<QueryFrame> frames;
    for (std::size_t i = 0; i < play_.steps.size(); ++i) {
      state.apply(play_.steps[i].changes);
      const Frame now = frame(i, state);
      culler.update(now, play_.steps[i].changes);
      sink.begin(play_.scene, now);
      culler.cull(now, Candidates::everything(), sink);
      QueryFrame result;
      for (const TriangleRange& range : sink.emitted()) result.kept.push_back(range.object);
      result.counts = device.counts();
      result.counters = culler.counters();
      judge_->start(now, truth_[i]);
      const auto verdict = judge_->judge(now, sink.set());
      result.image_px = verdict.image_px;
      result.disputed_image_px = verdict.disputed_image_px;
      frames.push_back(std::move(result));
    }
    return frames;
  }

  Frame frame(std::size_t index, const SceneState& state) const {
    return {index, play_.steps[index].camera, viewport_, state.view(), 0.0};
  }

  Play play_;
  Viewport viewport_;
  std::vector<FrameTruth> truth_;
  std::optional<ImageJudge> judge_;
};

}  // namespace vislab
