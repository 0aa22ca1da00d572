// A device that passes every call on, adds up the time spent in them and counts what is asked.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "common/render/device.h"

namespace vislab {

/// What was asked of a device in a frame.
struct DeviceCounts {
  std::uint64_t queries = 0;
  std::uint64_t query_boxes = 0;    // boxes of all queries
  std::uint64_t state_changes = 0;  // from drawing to asking or back; a frame begins with drawing
  std::uint64_t flushes = 0;
  std::uint64_t waits = 0;  // answers that were fetched without knowing that they were there

  /// By the names of the counters in results.
  std::array<std::pair<std::string_view, std::uint64_t>, 5> named() const {
    return {{{"queries", queries},
             {"query_boxes", query_boxes},
             {"state_changes", state_changes},
             {"flushes", flushes},
             {"waits", waits}}};
  }
};

class TimedDevice : public RenderDevice {
 private:
  using Clock = std::chrono::steady_clock;

  template <typename Function>
  auto timed(Function&& call) {
    struct Watch {
      TimedDevice& device;
      Clock::time_point start = Clock::now();
      ~Watch() { device.elapsed_ += Clock::now() - start; }
    } watch{*this};
    return call();
  }

 public:
  explicit TimedDevice(RenderDevice& device) : device_(&device) {}

  /// Time inside device calls since the last reset: real time, even of a device that keeps a clock.
  double milliseconds() const { return elapsed_.count(); }
  void reset_clock() { elapsed_ = {}; }
  /// Since begin_frame.
  const DeviceCounts& counts() const { return counts_; }

  void load(const Scene& scene) override {
    timed([&] { device_->load(scene); });
  }
  void begin_frame(const Frame& frame) override {
    counts_ = {};
    asks_ = false;
    answered_.clear();
    timed([&] { device_->begin_frame(frame); });
  }
  void draw(std::span<const ObjectId> objects) override {
    if (!objects.empty()) enter(false);
    timed([&] { device_->draw(objects); });
  }
  void draw(std::span<const TriangleRange> ranges) override {
    if (!ranges.empty()) enter(false);
    timed([&] { device_->draw(ranges); });
  }
  void cull_back_faces(std::span<const ObjectId> objects) override {
    timed([&] { device_->cull_back_faces(objects); });
  }
  std::span<const ObjectId> one_sided() const override { return device_->one_sided(); }
  QueryId query(std::span<const Aabb> boxes) override {
    enter(true);
    ++counts_.queries;
    counts_.query_boxes += boxes.size();
    return timed([&] { return device_->query(boxes); });
  }
  void flush() override {
    ++counts_.flushes;
    timed([&] { device_->flush(); });
  }
  bool ready(QueryId query) override {
    const bool there = timed([&] { return device_->ready(query); });
    if (there) note_answer(query);
    return there;
  }
  std::uint64_t samples(QueryId query) override {
    const std::uint64_t count = timed([&] { return device_->samples(query); });
    counts_.waits += note_answer(query) ? 1 : 0;
    return count;
  }
  void finish() override {
    timed([&] { device_->finish(); });
  }
  std::optional<double> clock_ms() const override { return device_->clock_ms(); }
  std::string description() const override { return device_->description(); }

 private:
  void enter(bool asking) {
    counts_.state_changes += asks_ != asking ? 1 : 0;
    asks_ = asking;
  }
  /// Was it not known yet that the answer is there?
  bool note_answer(QueryId query) {
    if (answered_.size() <= query.index) answered_.resize(query.index + 1, false);
    const bool known = answered_[query.index];
    answered_[query.index] = true;
    return !known;
  }

  RenderDevice* device_;
  std::chrono::duration<double, std::milli> elapsed_{};
  DeviceCounts counts_;
  bool asks_ = false;  // what was last done in this frame, not drawn
  std::vector<bool>
      answered_;  // by the query's place in the frame: is its answer known to be there
};

}  // namespace vislab
