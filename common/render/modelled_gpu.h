// A graphics processor that is not there: answers by the software rasteriser, times by a model.
//
// Idea: what is drawn goes into a depth buffer of the frame's size (common/raster); queries count
//   the samples at which the front faces of their boxes are as near as the buffer or nearer. Beside
//   it runs a clock that is moved by the calls alone (gpu_clock.h), at prices that are dials
//   (gpu_model.h).
// Guarantee: answers and times are the same bit for bit whenever the same calls are made in the
//   same order, on every instruction set and in every build. An object that OSMesa would show has
//   samples in its enlarged box (query_bounds.h), as on OSMesa: the two differ only by rounding,
//   which the enlargement covers.
// Limits: a device for one thread. Time of the processor between calls is not modelled, so polling
//   loops move the clock by their polls only.
// Cost: about what the software rasteriser takes for the frame; a microsecond or two a box.
// Source: own.
#pragma once

#include <memory>

#include "common/render/device.h"
#include "common/render/gpu_clock.h"

namespace vislab {

class ModelledGpu : public RenderDevice {
 public:
  /// Throws InputError for a dial out of its range.
  explicit ModelledGpu(const GpuModel& model);
  ~ModelledGpu() override;
  ModelledGpu(const ModelledGpu&) = delete;
  ModelledGpu& operator=(const ModelledGpu&) = delete;

  /// Builds the software rasteriser's form of every mesh. O(triangles of the meshes).
  void load(const Scene& scene) override;
  /// Throws InputError for sizes that the software rasteriser does not take.
  void begin_frame(const Frame& frame) override;
  void draw(std::span<const ObjectId> objects) override;
  void draw(std::span<const TriangleRange> ranges) override;
  void cull_back_faces(std::span<const ObjectId> objects) override;
  std::span<const ObjectId> one_sided() const override;
  QueryId query(std::span<const Aabb> boxes) override;
  void flush() override;
  bool ready(QueryId query) override;
  std::uint64_t samples(QueryId query) override;
  void finish() override;
  /// The host's clock: what was called, and what was waited for.
  std::optional<double> clock_ms() const override;
  std::string description() const override;

  const GpuModel& model() const;
  /// What passed in this frame, for pictures and fits. Valid until the next call.
  const std::vector<GpuCommand>& log() const;
  /// The boxes of a query of this frame. Valid until the next query or begin_frame.
  std::span<const Aabb> boxes(std::uint32_t query) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace vislab
