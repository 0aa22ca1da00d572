#include "algorithms/depth/convex_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "algorithms/depth/covered_hull.h"
#include "common/geometry/rounding.h"
#include "common/raster/margins.h"

namespace vislab::depth_culling {
namespace {

constexpr double flatness = 1e-6;       // of a part's diagonal: how far a vertex may stand out
constexpr std::size_t max_points = 26;  // as many as there are directions
constexpr std::size_t max_planes = 128;
// Two faces of one plane, up to the rounding of doubles.
constexpr double same_plane = 1e-13;

/// Connected parts of a mesh: by triangle the number of its part; vertices at equal positions count
/// as one.
std::vector<std::uint32_t> part_numbers(const Mesh& mesh) {
  std::vector<std::uint32_t> by_position(mesh.positions.size());
  std::iota(by_position.begin(), by_position.end(), 0U);
  const auto key = [&](std::uint32_t v) {
    const glm::vec3& p = mesh.positions[v];
    return std::array{p.x, p.y, p.z};
  };
  std::ranges::sort(by_position, [&](std::uint32_t a, std::uint32_t b) {
    const auto p = key(a), q = key(b);
    return p != q ? p < q : a < b;
  });
  std::vector<std::uint32_t> parent(mesh.positions.size());
  for (std::size_t i = 0; i < by_position.size(); ++i) {
    const bool repeated = i > 0 && key(by_position[i]) == key(by_position[i - 1]);
    parent[by_position[i]] = repeated ? parent[by_position[i - 1]] : by_position[i];
  }
  const auto find = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const glm::uvec3& t : mesh.triangles) {
    parent[find(t.y)] = find(t.x);
    parent[find(t.z)] = find(t.x);
  }
  std::vector<std::uint32_t> numbers;
  numbers.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) numbers.push_back(find(t.x));
  return numbers;
}

Plane plane_of(const Mesh& mesh, const glm::uvec3& t) {
  const glm::dvec3 a(mesh.positions[t.x]);
  const glm::dvec3 normal =
      glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
  const double length = glm::length(normal);
  // Of a triangle without area nothing is seen.
  if (!(length > 0.0)) return {glm::dvec3(0.0), 0.0};
  return {normal / length, -glm::dot(normal / length, a)};
}

/// At most max_points of them: those farthest along the axes and diagonals of a cube.
std::vector<glm::dvec3> spread_points(const std::vector<glm::dvec3>& points) {
  std::vector<std::size_t> chosen;
  for (int i = 0; i < 27; ++i) {
    if (i == 13) continue;  // no direction
    const glm::dvec3 direction(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    std::size_t farthest = 0;
    for (std::size_t k = 1; k < points.size(); ++k) {
      if (glm::dot(direction, points[k]) > glm::dot(direction, points[farthest])) farthest = k;
    }
    chosen.push_back(farthest);
  }
  std::ranges::sort(chosen);
  const auto repeated = std::ranges::unique(chosen);
  chosen.erase(repeated.begin(), repeated.end());
  std::vector<glm::dvec3> spread;
  for (const std::size_t k : chosen) spread.push_back(points[k]);
  return spread;
}

/// The part of these triangles, or nothing (no points) if it is not a convex solid.
ConvexPart convex_part(const Mesh& mesh, std::span<const glm::uvec3> triangles) {
  ConvexPart part;
  if (triangles.size() < 4 || triangles.size() > max_part_triangles) return part;
  std::vector<std::array<float, 3>> corners;
  for (const glm::uvec3& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const glm::vec3& p = mesh.positions[t[k]];
      corners.push_back({p.x, p.y, p.z});
    }
  }
  std::ranges::sort(corners);
  const auto repeated = std::ranges::unique(corners);
  corners.erase(repeated.begin(), repeated.end());
  std::vector<glm::dvec3> points;
  Aabb box;
  for (const std::array<float, 3>& p : corners) {
    points.emplace_back(p[0], p[1], p[2]);
    box.extend({p[0], p[1], p[2]});
  }
  const double tolerance = flatness * glm::length(glm::dvec3(box.max) - glm::dvec3(box.min));
  std::vector<Plane> planes;
  for (const glm::uvec3& t : triangles) {
    const Plane plane = plane_of(mesh, t);
    if (plane.normal == glm::dvec3(0.0)) continue;
    for (const glm::dvec3& p : points) {
      if (plane.signed_distance(p) > tolerance) return part;
    }
    const bool known = std::ranges::any_of(planes, [&](const Plane& other) {
      return glm::length(other.normal - plane.normal) < same_plane &&
             std::abs(other.d - plane.d) <= same_plane * std::abs(plane.d);
    });
    if (!known && planes.size() <= max_planes) planes.push_back(plane);
  }
  Mesh surface;
  surface.positions = mesh.positions;
  surface.triangles.assign(triangles.begin(), triangles.end());
  if (!is_closed_outward(surface)) return part;
  if (planes.size() <= max_planes) part.planes = std::move(planes);
  part.all_points = points.size() <= max_points;
  part.points = part.all_points ? std::move(points) : spread_points(points);
  return part;
}

double size_of(const ConvexPart& part) {
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const glm::dvec3& p : part.points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 size = high - low;
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

}  // namespace

std::vector<ConvexPart> convex_parts(const Mesh& mesh) {
  const std::vector<std::uint32_t> numbers = part_numbers(mesh);
  std::vector<std::uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t t) { return numbers[t]; });
  std::vector<ConvexPart> parts;
  std::vector<glm::uvec3> triangles;
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first;
    triangles.clear();
    while (end < order.size() && numbers[order[end]] == numbers[order[first]]) {
      triangles.push_back(mesh.triangles[order[end++]]);
    }
    first = end;
    ConvexPart part = convex_part(mesh, triangles);
    if (!part.points.empty()) parts.push_back(std::move(part));
  }
  std::ranges::stable_sort(parts, std::greater(), size_of);
  if (parts.size() > max_parts) parts.resize(max_parts);
  return parts;
}

std::size_t bytes_of(std::span<const ConvexPart> parts) {
  std::size_t bytes = parts.size_bytes();
  for (const ConvexPart& part : parts) {
    bytes += part.points.capacity() * sizeof(glm::dvec3) + part.planes.capacity() * sizeof(Plane);
  }
  return bytes;
}

namespace {

/// The part's points in the window, cut by the near plane.
struct WindowPoints {
  // Each point that is beyond the plane, and the cut between it and each that is not.
  std::array<glm::dvec2, max_points + max_points * max_points / 4> at;
  std::size_t count = 0;
  double farthest = 0.0;  // planar depth
};

/// False if nothing is left, or what is cut by the near plane is in the image.
bool project(const WindowTransform& window, const WindowRows& rows, const ConvexPart& part,
             WindowPoints& out) {
  const double nearest = window.camera().lens.near_m;
  const double beyond = nearest + rounding_margin * std::abs(nearest);
  std::array<WindowPoint, max_points> points;
  const std::size_t count = part.points.size();
  std::size_t before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    points[i] = rows(part.points[i]);
    if (!std::isfinite(points[i].x + points[i].y + points[i].depth)) return false;
    if (!(points[i].depth > beyond)) ++before;
    out.farthest = i == 0 ? points[i].depth : std::max(out.farthest, points[i].depth);
  }
  if (before == count || (before > 0 && !part.all_points)) return false;
  const auto add = [&](double x, double y, double depth) {
    const double w = window.perspective() ? depth : 1.0;
    out.at[out.count++] = {x / w, y / w};
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (points[i].depth > beyond) add(points[i].x, points[i].y, points[i].depth);
  }
  if (before == 0) return true;
  // The cut through the part: where it is in the image, one sees into the part.
  const std::size_t first_cut = out.count;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(points[i].depth > beyond)) continue;
    for (std::size_t k = 0; k < count; ++k) {
      if (points[k].depth > beyond) continue;
      const double t = (beyond - points[i].depth) / (points[k].depth - points[i].depth);
      add(points[i].x + t * (points[k].x - points[i].x),
          points[i].y + t * (points[k].y - points[i].y), beyond);
    }
  }
  glm::dvec2 low(INFINITY), high(-INFINITY);
  for (std::size_t i = first_cut; i < out.count; ++i) {
    low = glm::min(low, out.at[i]);
    high = glm::max(high, out.at[i]);
  }
  const Viewport& viewport = window.viewport();
  return high.x < -1.0 || high.y < -1.0 || low.x > viewport.width + 1.0 ||
         low.y > viewport.height + 1.0;
}

/// The least nearness of the planes that face the eye over the rectangle and a little around it.
double least_nearness(const WindowTransform& window, const glm::dmat4x3& transform,
                      const ConvexPart& part, const BoxWindow& rectangle) {
  const glm::dmat3 inverse = glm::inverse(glm::dmat3(transform));
  const Viewport& viewport = window.viewport();
  // A device's surface moves along with the corners that it snaps.
  constexpr double around = 0.5 - 1.0 / 64.0;
  double least = INFINITY;
  for (int corner = 0; corner < 4; ++corner) {
    const double x = (corner & 1) != 0 ? rectangle.x1 - around : rectangle.x0 + around;
    const double y = (corner & 2) != 0 ? rectangle.y1 - around : rectangle.y0 + around;
    const Ray ray = window.camera().ray({x / viewport.width, y / viewport.height});
    const glm::dvec3 origin = inverse * (ray.origin - transform[3]);
    const glm::dvec3 direction = inverse * ray.direction;
    for (const Plane& plane : part.planes) {
      const double distance = plane.signed_distance(origin);
      const double approach = glm::dot(plane.normal, direction);
      if (window.perspective() ? distance > 0.0 : approach < 0.0) {
        least = std::min(least, window.perspective() ? -approach / distance : distance / approach);
      }
    }
  }
  return least;
}

}  // namespace

bool covered_rectangle(const WindowTransform& window, const glm::dmat4x3& transform,
                       const ConvexPart& part, BoxWindow& out) {
  WindowPoints points;
  if (!project(window, window.mesh(transform), part, points)) return false;
  if (!largest_covered(std::span(points.at).first(points.count), window.viewport(), out)) {
    return false;
  }
  double nearness = window.nearness(points.farthest);
  if (!part.planes.empty()) {
    nearness = std::max(nearness, least_nearness(window, transform, part, out));
  }
  const double lowered = nearness - window.device_margin() - rounding_margin * std::abs(nearness);
  if (!std::isfinite(lowered)) return false;
  out.nearness = round_down(lowered);
  return true;
}

}  // namespace vislab::depth_culling
