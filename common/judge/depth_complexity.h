// Depth complexity of a frame: how much lies one behind the other in each pixel.
//
// The lecture (Zachmann, Computer-Graphik 2, visibility, p. 42) gives three definitions and notes
// that all depend on eye and direction. Here they are three measurements, between the near and the
// far plane:
//   rays         intersections of the ray through the pixel's centre with the scene, both sides of
//                every triangle. What a ray tracer that is never stopped meets. A ray through the
//                common edge of two triangles meets both.
//   polygons     triangles whose projection overlaps the pixel's square, wherever in it: what a
//                rasteriser must look at. At least as many as the ray's but for rays through edges,
//                and many more where triangles are small.
//   transparent  triangles that would be seen at the pixel's centre, were all transparent. As
//                everywhere in the lab, solid meshes are seen from their front, so their back faces
//                do not count; of other meshes both sides do. About half of the ray's.
// For the judge's layer: the counts describe scenes, and no culler may read them.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "common/scene/frame.h"
#include "common/scene/scene.h"

namespace vislab {

enum class DepthComplexity { rays, polygons, transparent };
inline constexpr DepthComplexity depth_complexities[] = {
    DepthComplexity::rays, DepthComplexity::polygons, DepthComplexity::transparent};

/// "rays", "polygons", "transparent".
std::string_view to_string(DepthComplexity definition);

/// Counts by pixel, rows from bottom to top: pixel (x, y) is at y * width + x.
struct DepthComplexityMap {
  int width = 0, height = 0;
  std::vector<std::uint32_t> counts;
};

/// Over all pixels of a frame, those without anything included.
struct DepthComplexityFigures {
  double mean = 0.0;
  std::uint32_t p95 = 0;  // the least count that 95 % of the pixels do not exceed
  std::uint32_t max = 0;
};

/// Counts what is shown in a frame. The same on any number of threads. `rays` and `transparent`
/// build a ray tracer's tree, O(n log n), and cost about 0.1 microseconds for each intersection;
/// `polygons` costs O(triangles + overlaps). Throws InputError on a processor without AVX.
DepthComplexityMap depth_complexity(const Scene& scene, const Frame& frame,
                                    DepthComplexity definition);

/// `map` has at least one pixel. O(pixels).
DepthComplexityFigures figures_of(const DepthComplexityMap& map);

}  // namespace vislab
