// The last sink of a chain: draws what arrives and remembers it.
#pragma once

#include <vector>

#include "common/culler/visible_set.h"
#include "common/render/device.h"

namespace vislab {

/// Keeps the spans that a culler emits until flush() or draw_rest(), then draws them in order.
/// Recording for the judge happens where the spans end: at a flush within the culler's time, at the
/// end of the frame outside of it (record_rest).
class FrameSink : public DrawSink {
 public:
  /// `device` may be null: nothing is drawn then. Frame and scene outlive the frame.
  void start(const Scene& scene, const Frame& frame, RenderDevice* device) {
    recording_.start(scene, frame);
    frame_ = &frame;
    device_ = device;
    pending_.clear();
  }

  void everything() override { objects(frame_->objects.shown); }
  void objects(std::span<const ObjectId> ids) override { pending_.push_back({ids, {}}); }
  void ranges(std::span<const TriangleRange> ranges) override { pending_.push_back({{}, ranges}); }
  void flush() override {
    draw_rest();
    record_rest();
  }

  /// Hands what is pending to the device.
  void draw_rest() {
    if (device_ == nullptr) return;
    for (const Emission& emission : pending_) {
      if (!emission.objects.empty()) device_->draw(emission.objects);
      if (!emission.ranges.empty()) device_->draw(emission.ranges);
    }
  }
  /// Copies what is pending to the recording and forgets it.
  void record_rest() {
    for (const Emission& emission : pending_) {
      recording_.objects(emission.objects);
      recording_.ranges(emission.ranges);
    }
    pending_.clear();
  }

  const RecordingSink& recording() const { return recording_; }

 private:
  struct Emission {
    std::span<const ObjectId> objects;
    std::span<const TriangleRange> ranges;
  };

  RecordingSink recording_;
  const Frame* frame_ = nullptr;
  RenderDevice* device_ = nullptr;
  std::vector<Emission> pending_;
};

}  // namespace vislab
