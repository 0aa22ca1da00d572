#include "common/judge/disputed.h"

#include <algorithm>
#include <cmath>

namespace vislab {

WindowTriangle window_triangle(const Frame& frame, const Scene& scene, TriangleId triangle) {
  const ObjectId object = scene.object_of(triangle);
  return {frame.camera, frame.viewport,
          world_triangle(scene.mesh_of(object), frame.objects.transforms[object],
                         triangle - scene.first_triangle(object))};
}

double depth_step_m(const Lens& lens, double depth_m) {
  constexpr double step = 0x1p-24;
  // The inverse of how fast the buffer's value grows, between the near plane (0) and the far (1).
  if (lens.projection == Projection::orthographic) return step * (lens.far_m - lens.near_m);
  return step * depth_m * depth_m * (1.0 / lens.near_m - 1.0 / lens.far_m);
}

Disputes::Disputes(const Frame& frame, const Scene& scene, DepthSteps steps)
    : frame_(&frame), scene_(&scene), steps_(steps), slots_a_(slot_count), slots_b_(slot_count) {}

const WindowTriangle& Disputes::find(TriangleId triangle, std::vector<Slot>& slots) {
  Slot& slot = slots[triangle % slot_count];
  if (slot.triangle != triangle) {
    slot.triangle = triangle;
    slot.window = window_triangle(*frame_, *scene_, triangle);
  }
  return *slot.window;
}

bool Disputes::operator()(const glm::dvec2& window_px, TriangleId a, TriangleId b) {
  if (a == none_id) std::swap(a, b);
  if (a == none_id) return false;
  const WindowTriangle& first = find(a, slots_a_);
  if (first.edge_distance(window_px) < disputed_edge_px) return true;
  if (b == none_id) return false;
  const WindowTriangle& second = find(b, slots_b_);
  if (second.edge_distance(window_px) < disputed_edge_px) return true;
  if (!first.contains(window_px) || !second.contains(window_px)) return false;
  const double depth_a = first.depth(window_px);
  const double depth_b = second.depth(window_px);
  const double larger = std::max(std::abs(depth_a), std::abs(depth_b));
  const double steps =
      steps_ == DepthSteps::device ? 2.0 * depth_step_m(frame_->camera.lens, larger) : 0.0;
  return std::abs(depth_a - depth_b) < disputed_relative_depth * larger + steps;
}

bool Disputes::excuse_pixel(const glm::dvec2& window_px, TriangleId full, TriangleId drawn,
                            TriangleId seen) {
  if ((*this)(window_px, full, drawn)) return true;
  return seen != full && (*this)(window_px, full, seen) && (*this)(window_px, seen, drawn);
}

bool is_disputed(const Frame& frame, const Scene& scene, const glm::dvec2& window_px, TriangleId a,
                 TriangleId b) {
  return Disputes(frame, scene)(window_px, a, b);
}

}  // namespace vislab
