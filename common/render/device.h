// What a culler or the harness may ask of a graphics device: draw objects, ask how many samples a
// box would add. One implementation draws with OSMesa, one models a graphics processor; decorators
// may time or record either.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/scene/frame.h"

namespace vislab {

/// A query of one frame. Devices tell an id of an earlier frame from those of this one, however
/// often the places behind them are used again: std::logic_error.
struct QueryId {
  std::uint32_t frame = 0;  // counted by the device
  std::uint32_t index = 0;  // within the frame
  friend bool operator==(const QueryId&, const QueryId&) = default;
};

class RenderDevice {
 public:
  virtual ~RenderDevice() = default;

  /// Uploads the meshes. The scene outlives the device's use of it.
  virtual void load(const Scene& scene) = 0;

  /// Starts a frame: takes camera, viewport and transforms, clears ids and depth (D32F, far = 1,
  /// nearer wins, the first drawn keeps a tie), forgets all queries of the frame before.
  virtual void begin_frame(const Frame& frame) = 0;

  /// Draws whole objects, or ranges of their triangles, in this order, both sides of every
  /// triangle (but see cull_back_faces). Returns before the drawing is done. The spans need not
  /// outlive the call. A device call of at most a few microseconds for each object (one draw per
  /// object, indirect); ranges of one object that follow each other are compacted into one draw.
  virtual void draw(std::span<const ObjectId> objects) = 0;
  virtual void draw(std::span<const TriangleRange> ranges) = 0;

  /// From now on in this frame the device itself leaves out the triangles of these objects that it
  /// sees from behind (OpenGL's culling of faces): it decides in the window, after vertices are
  /// rounded to its grid, and turns with mirroring transforms. All that is submitted is still
  /// transformed. Objects whose transforms are so flat that rounding may turn triangles over keep
  /// both sides. begin_frame forgets it; an object may be named twice.
  virtual void cull_back_faces(std::span<const ObjectId> objects) = 0;
  /// The objects whose backs are left out now, each once, in the order in which they were named.
  /// Valid until the next call of cull_back_faces, begin_frame or load.
  virtual std::span<const ObjectId> one_sided() const = 0;

  /// Asks how many samples of the image the front faces of these world boxes would add to what is
  /// drawn so far; writes neither ids nor depth. One box adds each of its pixels once; a pixel of
  /// several boxes counts for each. The boxes must not touch the near region (see
  /// touches_near_region). Valid until the next begin_frame.
  virtual QueryId query(std::span<const Aabb> boxes) = 0;

  /// Hands what was asked so far to the device, so that answers can arrive.
  virtual void flush() = 0;
  /// True if samples(query) would not wait.
  virtual bool ready(QueryId query) = 0;
  /// Waits for the answer.
  virtual std::uint64_t samples(QueryId query) = 0;

  /// Waits until everything is drawn.
  virtual void finish() = 0;

  /// Milliseconds since begin_frame by the device's own clock, if it keeps one: the time of a
  /// modelled device is no one else's. None if its calls take real time.
  virtual std::optional<double> clock_ms() const { return std::nullopt; }

  /// Name and version of the renderer, for the context of results.
  virtual std::string description() const = 0;
};

}  // namespace vislab
