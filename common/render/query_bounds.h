// Boxes that are safe to ask the device about.
//
// Idea: what lies in a box may come out of the rasteriser a little outside of it. Window positions
// are snapped to 1/256 pixel, so each vertex moves by up to 1/512 pixel in x and y; depth is
// rounded when it is computed, interpolated and stored. So the box is made larger, in the world, by
// more than all of that.
//
// Sideways by the size of 1/32 pixel at the box's farthest depth. A pixel's size in metres grows
// with depth, so this is enough at every depth of the box; growth along the world's axes by g moves
// every side by at least g in any direction, hence also along the image's x and y.
//
// Towards the eye by the depth that 32 steps of 2^-24 span at the box's farthest depth. In standard
// depth a step spans 2^-24 z^2 (far - near) / (far near) metres at depth z: far things share few
// distinct values, and the growth there is large. Points are moved towards the eye by a fraction of
// their distance, so that they stay on their rays and the outline in the image hardly grows.
//
// Guarantee: a triangle in the box that is drawn after the query of the enlarged box adds no sample
// that the query did not count, but for one kind: on triangles that are seen edge-on, less than a
// pixel wide, the rasteriser may extrapolate depth past the triangle's own vertices (seen once in
// 22,000 visible objects of which a third were edge-on on purpose). Such a sample lies at the
// triangle's edge and does not agree with rays either: the judge takes it for disputed.
//
// Limits: float world positions (see Scene::origin) must be exact to 1/64 pixel, so the eye should
// not look at things whose depth is less than 1/1000 of their distance from the origin.
//
// Cost: about 40 operations. Source: own derivation; the snapping is that of llvmpipe, Mesa 22.3.
#pragma once

#include "common/geometry/bounds.h"
#include "common/geometry/camera.h"

namespace vislab {

/// `box` (world) enlarged as said above, rounded outward. The result may touch the near region
/// though the box does not: ask touches_near_region about the result. A box that is not valid is
/// returned as it is.
Aabb enlarged_for_query(const Camera& camera, const Viewport& viewport, const Aabb& box);

}  // namespace vislab
