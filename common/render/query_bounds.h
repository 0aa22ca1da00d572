// Boxes that are safe to ask the device about.
//
// Idea: what lies in a box may come out of the rasteriser a little outside of it. Window positions
// are snapped to 1/256 pixel, so each vertex moves by up to 1/512 pixel in x and y; depth is
// rounded when it is computed, interpolated and stored. So the box is made larger, in the world, by
// more than all of that:
//   - sideways by the size of 1/32 pixel at the box's farthest depth. A pixel's size in metres
//   grows
//     with depth, so this is enough at every depth of the box; growth along the world's axes by g
//     moves every side by at least g in any direction, hence also along the image's x and y;
//   - towards the eye by the depth that 32 steps of 2^-24 span at the box's farthest depth. In
//     standard depth a step spans 2^-24 z^2 (far - near) / (far near) metres at depth z: far things
//     share few distinct values, and the growth there is large. A point is moved towards the eye by
//     a fraction of its distance, so that it stays on its ray and the box's outline in the image
//     grows only where it must.
// Guarantee: a triangle in the box that adds a sample to the image, drawn in any order with others,
// makes a query of the enlarged box count that sample, if it was asked before the triangle was
// drawn. Limits: float world positions (see Scene::origin) must be exact to 1/64 pixel, so the eye
// should not look at things whose depth is less than 1/1000 of their distance from the origin.
// Triangles seen edge-on at subpixel width may be interpolated by the rasteriser to any depth
// within their own extent; that is inside the box. Cost: about 40 operations. Source: own
// derivation; the snapping is that of llvmpipe in Mesa 22.3.
#pragma once

#include "common/geometry/bounds.h"
#include "common/geometry/camera.h"

namespace vislab {

/// `box` (world) enlarged as said above, rounded outward. The result may touch the near region
/// though the box does not: ask touches_near_region about the result. A box that is not valid is
/// returned as it is.
Aabb enlarged_for_query(const Camera& camera, const Viewport& viewport, const Aabb& box);

}  // namespace vislab
