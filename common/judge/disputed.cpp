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

bool is_disputed(const Frame& frame, const Scene& scene, const glm::dvec2& window_px, TriangleId a,
                 TriangleId b) {
  if (a == none_id) std::swap(a, b);
  if (a == none_id) return false;
  const WindowTriangle first = window_triangle(frame, scene, a);
  if (first.edge_distance(window_px) < disputed_edge_px) return true;
  if (b == none_id) return false;
  const WindowTriangle second = window_triangle(frame, scene, b);
  if (second.edge_distance(window_px) < disputed_edge_px) return true;
  if (!first.contains(window_px) || !second.contains(window_px)) return false;
  const double depth_a = first.depth(window_px);
  const double depth_b = second.depth(window_px);
  return std::abs(depth_a - depth_b) <
         disputed_relative_depth * std::max(std::abs(depth_a), std::abs(depth_b));
}

}  // namespace vislab
