// A sink that holds a culler to the rules of emission, and a device that keeps the harness's own
// allocations out of the count.
#pragma once

#include <string>
#include <thread>
#include <vector>

#include "common/culler/visible_set.h"
#include "common/render/device.h"
#include "experiments/contract/allocation_counter.h"

namespace vislab {

/// Keeps spans as a link of a chain does: it reads them only at flush() and at the end, so a culler
/// that overwrites what it emitted is found out. Draws on a device if there is one.
class ContractSink : public DrawSink {
 public:
  /// `device` may be null. `candidates` are what the culler is offered.
  void start(const Scene& scene, const Frame& frame, const Candidates& candidates,
             RenderDevice* device);

  void everything() override;
  void objects(std::span<const ObjectId> ids) override;
  void ranges(std::span<const TriangleRange> ranges) override;
  void flush() override;

  /// To be called when cull() has returned. What was emitted, as one range an object or more.
  const std::vector<TriangleRange>& finish();
  /// What the culler did against the rules; empty if nothing.
  const std::string& fault() const { return fault_; }

 private:
  struct Emission {
    std::span<const ObjectId> objects;
    std::span<const TriangleRange> ranges;
  };

  void blame(const std::string& fault);
  void emission();
  void read();

  const Scene* scene_ = nullptr;
  const Frame* frame_ = nullptr;
  RenderDevice* device_ = nullptr;
  bool offered_everything_ = false;
  bool everything_ = false;
  std::thread::id thread_;
  std::size_t emissions_ = 0;
  std::vector<Emission> pending_;
  std::vector<TriangleRange> emitted_;
  std::string fault_;
};

/// Passes every call on and counts no allocation inside of it.
class UncountedDevice : public RenderDevice {
 public:
  explicit UncountedDevice(RenderDevice& device) : device_(&device) {}

  void load(const Scene& scene) override;
  void begin_frame(const Frame& frame) override;
  void draw(std::span<const ObjectId> objects) override;
  void draw(std::span<const TriangleRange> ranges) override;
  void cull_back_faces(std::span<const ObjectId> objects) override;
  std::span<const ObjectId> one_sided() const override { return device_->one_sided(); }
  QueryId query(std::span<const Aabb> boxes) override;
  void flush() override;
  bool ready(QueryId query) override;
  std::uint64_t samples(QueryId query) override;
  void finish() override;
  std::string description() const override;

 private:
  RenderDevice* device_;
};

}  // namespace vislab
