// The convex solids that a mesh consists of, and the rectangles that they cover of an image.
//
// Idea: a closed part all of whose vertices lie behind each of its faces covers the convex hull of
//   its vertices in the image, and what is seen of it at any pixel lies on the farthest of the
//   planes that face the eye. In the image, both are found from few points: a rectangle lies in the
//   hull if its four corners do, and its farthest point is at one of them.
// Guarantee: a graphics device covers every pixel of the rectangle with the part's surface, at
//   least as near as said: the hull is made smaller and the nearness lower than what a device's
//   snapping and rounding can do.
// Limits: parts that are open, not convex or have more than max_part_triangles triangles cover
//   nothing; of a mesh the max_parts largest parts count.
// Cost: O(points^2) a part and frame, with at most 26 points; building is O(n log n), and O(n^2)
//   for parts that are convex.
// Source: own; rectangles inside of occluders instead of around them against Zachmann slide 46.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "common/geometry/bounds.h"
#include "common/raster/box_window.h"
#include "common/scene/scene.h"

namespace vislab::depth_culling {

inline constexpr std::size_t max_parts = 32;
inline constexpr std::size_t max_part_triangles = 4096;

/// Mesh frame.
struct ConvexPart {
  std::vector<glm::dvec3> points;  // their hull lies in the part, or is the part if all_points
  std::vector<Plane> planes;       // of its faces, outward; empty if they are too many
  bool all_points = true;
};

/// Largest first.
std::vector<ConvexPart> convex_parts(const Mesh& mesh);

std::size_t bytes_of(std::span<const ConvexPart> parts);

/// A large rectangle of pixels that the part, placed by `transform`, surely covers, and the least
/// nearness of what covers it. False if there is none: the part is small or off the image, or the
/// near plane cuts it in the image.
bool covered_rectangle(const WindowTransform& window, const glm::dmat4x3& transform,
                       const ConvexPart& part, BoxWindow& out);

}  // namespace vislab::depth_culling
