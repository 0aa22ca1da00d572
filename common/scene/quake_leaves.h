// The shapes of a Quake III world's leaves: the convex regions of its BSP tree, and the polygons in
// which they touch.
//
// Idea: from the root down, each node's plane is cut to the node's region, which is a new face
//   between its two children; the faces that bounded the node are divided by the plane and handed
//   to the children. What lies between two leaves at the end is where they touch.
// Cost: O(faces log nodes).
// Source: the common way of BSP compilers; Fuchs, Kedem, Naylor 1980 for the tree.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/convex_polygon.h"
#include "common/scene/quake_world.h"

namespace vislab {

/// Where two leaves touch.
struct LeafFace {
  ConvexPolygon polygon;                          // counter-clockwise seen from `front`
  Plane plane;                                    // inside is towards `front`
  std::uint32_t front = none_id, back = none_id;  // none_id: outside of the world's box
};

struct LeafShapes {
  std::vector<LeafFace> faces;
  std::vector<std::vector<std::uint32_t>> faces_of_leaf;  // by leaf: indices of `faces`
};

/// Corners nearer to a plane than this lie on it.
inline constexpr double leaf_tolerance_m = 1e-6;

/// Shapes within `bounds`, which is made a little larger; leaves and faces that are thinner than
/// the tolerance have no shape.
LeafShapes shapes_of_leaves(const QuakeWorld& world, const Aabb& bounds);

}  // namespace vislab
