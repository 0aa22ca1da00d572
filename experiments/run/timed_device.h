// A device that passes every call on and adds up the time spent in them.
#pragma once

#include <chrono>

#include "common/render/device.h"

namespace vislab {

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

  /// Time inside device calls since the last reset.
  double milliseconds() const { return elapsed_.count(); }
  void reset_clock() { elapsed_ = {}; }

  void load(const Scene& scene) override {
    timed([&] { device_->load(scene); });
  }
  void begin_frame(const Frame& frame) override {
    timed([&] { device_->begin_frame(frame); });
  }
  void draw(std::span<const ObjectId> objects) override {
    timed([&] { device_->draw(objects); });
  }
  void draw(std::span<const TriangleRange> ranges) override {
    timed([&] { device_->draw(ranges); });
  }
  void cull_back_faces(std::span<const ObjectId> objects) override {
    timed([&] { device_->cull_back_faces(objects); });
  }
  std::span<const ObjectId> one_sided() const override { return device_->one_sided(); }
  QueryId query(std::span<const Aabb> boxes) override {
    return timed([&] { return device_->query(boxes); });
  }
  void flush() override {
    timed([&] { device_->flush(); });
  }
  bool ready(QueryId query) override {
    return timed([&] { return device_->ready(query); });
  }
  std::uint64_t samples(QueryId query) override {
    return timed([&] { return device_->samples(query); });
  }
  void finish() override {
    timed([&] { device_->finish(); });
  }
  std::string description() const override { return device_->description(); }

 private:
  RenderDevice* device_;
  std::chrono::duration<double, std::milli> elapsed_{};
};

}  // namespace vislab
