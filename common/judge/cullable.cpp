#include "common/judge/cullable.h"

#include <algorithm>
#include <array>

#include "common/geometry/frustum.h"
#include "common/scene/transform.h"

namespace vislab {
namespace {

using Corners = std::array<glm::dvec3, 3>;

/// Does the eye lie behind the triangle's plane?
bool faces_away(const Camera& camera, const Corners& corners, bool mirrored) {
  const auto& [a, b, c] = corners;
  glm::dvec3 normal = glm::cross(b - a, c - a);
  if (mirrored) normal = -normal;
  const glm::dvec3 to_eye =
      camera.lens.projection == Projection::perspective ? camera.pose.eye - a : camera.pose.back;
  return glm::dot(normal, to_eye) < 0.0;
}

/// Clips the triangle against all planes (Sutherland and Hodgman 1974): is nothing left?
bool lies_outside(const Frustum& frustum, const Corners& corners) {
  std::array<glm::dvec3, 9> polygon{corners[0], corners[1], corners[2]};
  std::size_t size = 3;
  for (const Plane& plane : frustum.span()) {
    std::array<glm::dvec3, 9> clipped;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const glm::dvec3& p = polygon[i];
      const glm::dvec3& q = polygon[(i + 1) % size];
      const double at_p = plane.signed_distance(p);
      const double at_q = plane.signed_distance(q);
      if (at_p >= 0.0) clipped[kept++] = p;
      if ((at_p >= 0.0) != (at_q >= 0.0)) clipped[kept++] = p + (q - p) * (at_p / (at_p - at_q));
    }
    if (kept == 0) return true;
    polygon = clipped;
    size = kept;
  }
  return false;
}

}  // namespace

CullableTriangles::CullableTriangles(const Frame& frame, const Scene& scene)
    : back_facing_before_(scene.triangle_count() + 1, 0),
      outside_before_(scene.triangle_count() + 1, 0) {
  const Frustum frustum = frustum_of(frame.camera);
  for (const ObjectId object : frame.objects.shown) {
    const Mesh& mesh = scene.mesh_of(object);
    const glm::dmat4x3& transform = frame.objects.transforms[object];
    const bool mirrored = determinant(transform) < 0.0;
    const Aabb& box = frame.objects.bounds[object];
    // Most objects are on one side as a whole: their triangles need no test.
    const bool all_outside = std::ranges::any_of(
        frustum.span(), [&](const Plane& plane) { return surely_outside(plane, box); });
    const bool all_inside = std::ranges::all_of(
        frustum.span(), [&](const Plane& plane) { return surely_inside(plane, box); });
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Corners corners = world_triangle(mesh, transform, i);
      const std::size_t after = scene.first_triangle(object) + i + std::size_t{1};
      back_facing_before_[after] = faces_away(frame.camera, corners, mirrored) ? 1 : 0;
      outside_before_[after] =
          all_outside || (!all_inside && lies_outside(frustum, corners)) ? 1 : 0;
    }
  }
  for (std::size_t i = 1; i < back_facing_before_.size(); ++i) {
    back_facing_before_[i] += back_facing_before_[i - 1];
    outside_before_[i] += outside_before_[i - 1];
  }
}

CulledOf CullableTriangles::count(const std::vector<std::uint32_t>& before,
                                  const VisibleSet& kept) {
  CulledOf result{before.back(), before.back()};
  for (const VisibleSet::Run& run : kept.runs()) {
    result.culled -= before[run.first + run.count] - before[run.first];
  }
  return result;
}

}  // namespace vislab
