// Which single samples are excused: where rays and rasteriser, or two triangles of one surface, may
// rightly differ.
#pragma once

#include <optional>
#include <vector>

#include "common/judge/window_triangle.h"
#include "common/scene/frame.h"

namespace vislab {

/// A sample nearer than this to an edge of a triangle may fall on either side of it, pixels.
inline constexpr double disputed_edge_px = 1.0 / 128.0;
/// Two depths that differ by less than this, relative to the larger, may come in either order.
inline constexpr double disputed_relative_depth = 1e-4;

/// Whether one of the two answers comes from the device, whose depth buffer of 32-bit floats has
/// steps: each of two depths may be off by one, which beyond 839 near distances is more than
/// disputed_relative_depth.
enum class DepthSteps { none, device };

/// The step of the device's depth buffer at a planar depth, metres: of a value between 1/2 and 1,
/// as all are beyond two near distances.
double depth_step_m(const Lens& lens, double depth_m);

/// Decides about samples of one frame, one after another; keeps the triangles seen last, because
/// neighbouring samples ask for the same ones. Frame and scene outlive it.
class Disputes {
 public:
  Disputes(const Frame& frame, const Scene& scene, DepthSteps steps = DepthSteps::none);

  /// As is_disputed(); with a device, depths may differ by two steps of its buffer more.
  bool operator()(const glm::dvec2& window_px, TriangleId a, TriangleId b);

  /// Is a pixel excused that shows `drawn` where the full image shows `full` and a ray hits `seen`?
  /// It is if the two images' triangles are disputed; or, where the full image itself differs from
  /// the ray, if the ray's triangle is disputed with both of them: at its edge the rasteriser may
  /// see what lies behind it.
  bool excuse_pixel(const glm::dvec2& window_px, TriangleId full, TriangleId drawn,
                    TriangleId seen);

 private:
  static constexpr std::size_t slot_count = 256;

  struct Slot {
    TriangleId triangle = none_id;
    std::optional<WindowTriangle> window;
  };
  const WindowTriangle& find(TriangleId triangle, std::vector<Slot>& slots);

  const Frame* frame_;
  const Scene* scene_;
  DepthSteps steps_;
  std::vector<Slot> slots_a_, slots_b_;  // two, so that finding b does not overwrite a
};

/// Why a differing sample is excused: it lies within 1/128 pixel of an edge of either triangle
/// (edges that the near or the far plane cuts included), or both triangles cover it at depths that
/// differ by less than 1e-4 relative. `a` and `b` are triangles (none_id for background: only the
/// other's edges count then). O(log objects).
bool is_disputed(const Frame& frame, const Scene& scene, const glm::dvec2& window_px, TriangleId a,
                 TriangleId b);

/// A triangle of the scene as the frame shows it.
WindowTriangle window_triangle(const Frame& frame, const Scene& scene, TriangleId triangle);

}  // namespace vislab
