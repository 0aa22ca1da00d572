#include "common/judge/depth_complexity.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/judge/ray_scene.h"
#include "common/judge/samples.h"
#include "common/judge/window_triangle.h"

namespace vislab {
namespace {

/// Tells which triangles turn their unseen side to the eye.
class UnseenSides {
 public:
  UnseenSides(const Scene& scene, const Frame& frame) : scene_(&scene), frame_(&frame) {
    for (const glm::dmat4x3& transform : frame.objects.transforms) {
      const bool mirrors = glm::determinant(glm::dmat3(transform)) < 0.0;
      winding_.push_back(mirrors ? -1.0 : 1.0);
    }
  }

  bool holds(TriangleId triangle) const {
    const ObjectId object = scene_->object_of(triangle);
    const Mesh& mesh = scene_->mesh_of(object);
    if (!mesh.solid) return false;
    const auto corners = world_triangle(mesh, frame_->objects.transforms[object],
                                        triangle - scene_->first_triangle(object));
    const glm::dvec3 normal =
        glm::cross(corners[1] - corners[0], corners[2] - corners[0]) * winding_[object];
    const Camera& camera = frame_->camera;
    const glm::dvec3 to_eye = camera.lens.projection == Projection::orthographic
                                  ? camera.pose.back
                                  : camera.pose.eye - corners[0];
    return glm::dot(normal, to_eye) < 0.0;
  }

 private:
  const Scene* scene_;
  const Frame* frame_;
  std::vector<double> winding_;  // by object
};

/// What the filter function counts with; the ray tracer hands it on.
struct CountingContext {
  RTCIntersectContext base;
  const RayScene* scene = nullptr;
  const UnseenSides* unseen = nullptr;  // null: every side counts
  std::array<std::uint32_t, 8> counts{};
};

/// Counts a hit and refuses it, so that the ray goes on. A tree without spatial splits holds every
/// triangle once, so each is counted once.
void count_hits(const RTCFilterFunctionNArguments* arguments) {
  auto* context = reinterpret_cast<CountingContext*>(arguments->context);
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] == 0) continue;
    arguments->valid[i] = 0;
    if (context->unseen != nullptr) {
      const TriangleId triangle = context->scene->triangle_of(
          RTCHitN_geomID(arguments->hit, n, i), RTCHitN_primID(arguments->hit, n, i),
          RTCHitN_instID(arguments->hit, n, i, 0));
      if (context->unseen->holds(triangle)) continue;
    }
    ++context->counts[RTCRayN_id(arguments->ray, n, i)];
  }
}

/// Counts along the rays through the centres of a tile's pixels.
void count_tile(const RayMaker& maker, const RayScene& rays, const UnseenSides* unseen, int tile_x,
                int tile_y, DepthComplexityMap& map) {
  const EightPositions centres = pixel_centres(tile_x, tile_y);
  EightVectors varying;
  maker.vary({&centres, 1}, &varying);
  const glm::vec3 common = maker.common();
  RTCRayHit8 packet{};
  alignas(32) std::array<int, 8> active{};
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 own(varying.x[i], varying.y[i], varying.z[i]);
    const glm::vec3 origin = maker.orthographic() ? own : common;
    const glm::vec3 direction = maker.orthographic() ? common : own;
    packet.ray.org_x[i] = origin.x;
    packet.ray.org_y[i] = origin.y;
    packet.ray.org_z[i] = origin.z;
    packet.ray.dir_x[i] = direction.x;
    packet.ray.dir_y[i] = direction.y;
    packet.ray.dir_z[i] = direction.z;
    packet.ray.tnear[i] = maker.near_distance();
    packet.ray.tfar[i] = maker.far_distance();
    packet.ray.mask[i] = 0xFFFFFFFFU;
    packet.ray.id[i] = static_cast<unsigned>(i);
    packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    active[i] = centres.x[i] < map.width && centres.y[i] < map.height ? -1 : 0;
  }
  CountingContext context;
  rtcInitIntersectContext(&context.base);
  context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  context.base.filter = count_hits;
  context.scene = &rays;
  context.unseen = unseen;
  rtcIntersect8(active.data(), rays.handle(), &context.base, &packet);
  for (std::size_t i = 0; i < 8; ++i) {
    if (active[i] == 0) continue;
    const auto x = static_cast<std::size_t>(centres.x[i]);
    const auto y = static_cast<std::size_t>(centres.y[i]);
    map.counts[y * static_cast<std::size_t>(map.width) + x] = context.counts[i];
  }
}

void count_rays(const Scene& scene, const Frame& frame, bool seen_only, DepthComplexityMap& map) {
  RayScene rays(scene);
  rays.follow(frame.objects);
  const UnseenSides sides(scene, frame);
  const UnseenSides* const unseen = seen_only ? &sides : nullptr;
  const RayMaker maker(frame.camera, frame.viewport, scene.origin());
  const int columns = (map.width + tile_width - 1) / tile_width;
  const int rows = (map.height + tile_height - 1) / tile_height;
  tbb::parallel_for(tbb::blocked_range<int>(0, rows), [&](const tbb::blocked_range<int>& range) {
    for (int row = range.begin(); row < range.end(); ++row) {
      for (int column = 0; column < columns; ++column) {
        count_tile(maker, rays, unseen, column, row, map);
      }
    }
  });
}

/// Adds one to every pixel whose square a convex polygon overlaps.
void count_overlaps(std::span<const glm::dvec2> corners, DepthComplexityMap& map) {
  glm::dvec2 low = corners[0];
  glm::dvec2 high = corners[0];
  double area = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec2& a = corners[i];
    const glm::dvec2& b = corners[(i + 1) % corners.size()];
    low = glm::min(low, a);
    high = glm::max(high, a);
    area += a.x * b.y - a.y * b.x;
  }
  // Seen edge-on, or outside of the image.
  if (area == 0.0 || high.x <= 0.0 || high.y <= 0.0 || low.x >= map.width || low.y >= map.height) {
    return;
  }
  const auto first_x = static_cast<int>(std::max(std::floor(low.x), 0.0));
  const auto first_y = static_cast<int>(std::max(std::floor(low.y), 0.0));
  const auto end_x = static_cast<int>(std::min<double>(std::ceil(high.x), map.width));
  const auto end_y = static_cast<int>(std::min<double>(std::ceil(high.y), map.height));
  // Convex shapes are apart if and only if a line along an edge of one of them parts them; those
  // along the square's edges are the box above.
  struct Edge {
    glm::dvec2 inward;
    double offset = 0.0;  // raised to the square's farthest corner
  };
  std::array<Edge, 5> edges;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec2& a = corners[i];
    const glm::dvec2 along = corners[(i + 1) % corners.size()] - a;
    const glm::dvec2 inward = glm::dvec2(-along.y, along.x) * (area > 0.0 ? 1.0 : -1.0);
    edges[i] = {inward, std::max(inward.x, 0.0) + std::max(inward.y, 0.0) - glm::dot(inward, a)};
  }
  for (int y = first_y; y < end_y; ++y) {
    for (int x = first_x; x < end_x; ++x) {
      bool overlaps = true;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Edge& edge = edges[i];
        const bool point = edge.inward == glm::dvec2(0.0);  // two corners in one place
        overlaps &= point || edge.inward.x * x + edge.inward.y * y + edge.offset > 0.0;
      }
      const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                         static_cast<std::size_t>(x);
      map.counts[pixel] += overlaps ? 1 : 0;
    }
  }
}

void count_polygons(const Scene& scene, const Frame& frame, DepthComplexityMap& map) {
  for (const ObjectId object : frame.objects.shown) {
    const Mesh& mesh = scene.mesh_of(object);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const WindowTriangle triangle(frame.camera, frame.viewport,
                                    world_triangle(mesh, frame.objects.transforms[object], i));
      if (!triangle.empty()) count_overlaps(triangle.corners(), map);
    }
  }
}

}  // namespace

std::string_view to_string(DepthComplexity definition) {
  switch (definition) {
    case DepthComplexity::rays:
      return "rays";
    case DepthComplexity::polygons:
      return "polygons";
    case DepthComplexity::transparent:
      return "transparent";
  }
  throw std::logic_error("no such definition of depth complexity");
}

DepthComplexityMap depth_complexity(const Scene& scene, const Frame& frame,
                                    DepthComplexity definition) {
  DepthComplexityMap map{frame.viewport.width, frame.viewport.height, {}};
  map.counts.resize(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height));
  if (definition == DepthComplexity::polygons) {
    count_polygons(scene, frame, map);
  } else {
    count_rays(scene, frame, definition == DepthComplexity::transparent, map);
  }
  return map;
}

DepthComplexityFigures figures_of(const DepthComplexityMap& map) {
  std::vector<std::uint32_t> sorted = map.counts;
  std::sort(sorted.begin(), sorted.end());
  DepthComplexityFigures figures;
  std::uint64_t sum = 0;
  for (const std::uint32_t count : sorted) sum += count;
  const std::size_t n = sorted.size();
  figures.mean = static_cast<double>(sum) / static_cast<double>(n);
  figures.p95 = sorted[(95 * n + 99) / 100 - 1];
  figures.max = sorted.back();
  return figures;
}

}  // namespace vislab
