// The graphics device: Mesa's software rasteriser through OSMesa, OpenGL 4.5 core, no window.
#pragma once

#include <memory>
#include <vector>

#include "common/render/device.h"

namespace vislab {

/// Draws object ids (32-bit integers) and depth (32-bit float, near -> 0, far -> 1) into its own
/// framebuffer, which takes each frame's viewport size. One context a device; devices do not
/// share anything, and each may live in its own thread. One device is used by one thread at a time.
///
/// World positions are rounded to float after Scene::origin() is subtracted, and the eye is
/// subtracted from them before the camera's rotation, so that depth agrees with rays at the same
/// float vertices to a relative 1e-4 as long as depth is below about 500 near distances (beyond
/// that the float depth buffer itself is the limit: its step at distance z is z * z * 6e-8 / near).
///
/// Errors: InputError for a viewport that is empty or larger than the device's limit;
/// std::logic_error for calls in a wrong order; std::runtime_error if OpenGL reports an error
/// (looked for after every batch of draws, query, flush and answer), the context is lost, or has no
/// queries.
class OsMesaDevice : public RenderDevice {
 public:
  OsMesaDevice();
  ~OsMesaDevice() override;

  /// Also forgets the scene before. O(vertices + indices + objects) memory on the device.
  void load(const Scene& scene) override;
  /// Compares the transforms with those of the frame before and uploads what lies between the first
  /// and the last that differ.
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
  std::string description() const override;

  /// As draw(ranges), cull_back_faces included, but writes the id of each triangle (TriangleId)
  /// where draw writes the object's. Depths are bit for bit those of draw. One device draw a range.
  void draw_ids(std::span<const TriangleRange> ranges);

  /// The ids drawn so far in this frame, none_id where nothing is. width * height values, row by
  /// row from the lower left pixel. Waits for the drawing.
  std::vector<std::uint32_t> read_ids();
  /// The depth buffer, in the same order; 1 where nothing is.
  std::vector<float> read_depth();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace vislab
