// A device that passes every call on and keeps the commands of the present frame, for pictures.
#pragma once

#include <optional>
#include <vector>

#include "common/render/device.h"

namespace vislab {

/// A query, and what was learnt of it.
struct RecordedQuery {
  std::vector<Aabb> boxes;
  std::optional<std::uint64_t> samples;  // none: nobody looked
};

/// Commands between two changes from drawing to asking or back. A frame begins with drawing.
struct RecordedState {
  bool asks = false;
  std::vector<ObjectId> drawn;         // in order, once a draw
  std::vector<RecordedQuery> queries;  // in order

  std::size_t commands() const { return asks ? queries.size() : drawn.size(); }
};

class RecordedDevice : public RenderDevice {
 public:
  /// `device` outlives this.
  explicit RecordedDevice(RenderDevice& device) : device_(&device) {}

  /// Of the frame that was begun last. The first is of drawing, and may be empty.
  const std::vector<RecordedState>& states() const { return states_; }
  std::uint64_t flushes() const { return flushes_; }

  void load(const Scene& scene) override { device_->load(scene); }
  void begin_frame(const Frame& frame) override;
  void draw(std::span<const ObjectId> objects) override;
  void draw(std::span<const TriangleRange> ranges) override;
  void cull_back_faces(std::span<const ObjectId> objects) override {
    device_->cull_back_faces(objects);
  }
  std::span<const ObjectId> one_sided() const override { return device_->one_sided(); }
  QueryId query(std::span<const Aabb> boxes) override;
  void flush() override;
  bool ready(QueryId query) override { return device_->ready(query); }
  std::uint64_t samples(QueryId query) override;
  void finish() override { device_->finish(); }
  std::optional<double> clock_ms() const override { return device_->clock_ms(); }
  std::string description() const override { return device_->description(); }

 private:
  struct Place {
    QueryId query;
    std::size_t state = 0, index = 0;
  };
  RecordedState& state(bool asks);

  RenderDevice* device_;
  std::vector<RecordedState> states_;
  std::vector<Place> places_;  // of the frame's queries, as they were asked
  std::uint64_t flushes_ = 0;
};

}  // namespace vislab
