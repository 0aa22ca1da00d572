#include "common/render/outside_view.h"

#include <algorithm>
#include <cmath>

namespace vislab {
namespace {

/// World box in double: the eye need not be a float.
struct Region {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};

  bool empty() const { return !(low.x <= high.x); }
  void extend(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  glm::dvec3 corner(int i) const {
    return {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
            (i & 4) != 0 ? high.z : low.z};
  }
};

Region region_of_visible(const PictureInput& input) {
  const Scene& scene = *input.scene;
  Region region;
  for (const ObjectId object : input.frame->objects.shown) {
    const Mesh& mesh = scene.mesh_of(object);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const TriangleClass kind = input.classes[scene.first_triangle(object) + i];
      if (kind != TriangleClass::kept_visible && kind != TriangleClass::culled_wrongly) continue;
      for (const glm::dvec3& corner :
           world_triangle(mesh, input.frame->objects.transforms[object], i)) {
        region.extend(corner);
      }
    }
  }
  return region;
}

Region region_of_all(const ObjectsView& objects) {
  Region region;
  for (const ObjectId object : objects.shown) {
    region.extend(glm::dvec3(objects.bounds[object].min));
    region.extend(glm::dvec3(objects.bounds[object].max));
  }
  return region;
}

glm::dvec4 clip_position(const Camera& camera, const glm::dvec3& world) {
  return camera.view_projection() * glm::dvec4(world, 1.0);
}

}  // namespace

OutsideView fit_outside_view(const PictureInput& input, double aspect) {
  const Camera& seen = input.frame->camera;
  const Region all = region_of_all(input.frame->objects);
  Region region = region_of_visible(input);
  if (region.empty()) region = all;
  region.extend(seen.pose.eye);

  OutsideView view;
  // The frustum ends just behind what is visible, so that it does not hide the picture.
  double deepest = 0.0;
  for (int i = 0; i < 8; ++i) deepest = std::max(deepest, seen.planar_depth(region.corner(i)));
  view.frustum_depth = std::min(seen.lens.far_m, std::max(deepest, 2.0 * seen.lens.near_m));

  // Some of the surroundings too: things culled stand there.
  const double margin = 0.3 * glm::length(region.high - region.low);
  Region shown;
  shown.low = glm::max(region.low - margin, glm::min(all.low, seen.pose.eye));
  shown.high = glm::min(region.high + margin, glm::max(all.high, seen.pose.eye));

  const glm::dvec3 up(0.0, 1.0, 0.0);
  const glm::dvec3 direction =
      glm::normalize(0.6 * seen.pose.back + 0.75 * seen.pose.right + 0.75 * up);
  const glm::dvec3 center = 0.5 * (shown.low + shown.high);
  const double fov_y = 0.6;
  const double tan_y = std::tan(0.5 * fov_y);
  const double tan_x = tan_y * aspect;
  Camera camera;
  camera.pose = look_at(center + direction, center);
  double distance = 0.0;
  double radius = 0.0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 offset = shown.corner(i) - center;
    const double across = std::max(std::abs(glm::dot(offset, camera.pose.right)) / tan_x,
                                   std::abs(glm::dot(offset, camera.pose.up)) / tan_y);
    distance = std::max(distance, across + glm::dot(offset, camera.pose.back));
    radius = std::max(radius, glm::length(offset));
  }
  distance *= 1.06;
  camera.pose.eye = center + direction * distance;
  double farthest = distance + radius;
  for (int i = 0; i < 8; ++i) farthest = std::max(farthest, camera.planar_depth(all.corner(i)));
  camera.lens = perspective_lens(fov_y, aspect, 0.02 * distance, 1.01 * farthest);
  view.camera = camera;
  return view;
}

bool project_line(const Camera& camera, const Viewport& viewport, const glm::dvec3& from,
                  const glm::dvec3& to, WindowLine& line) {
  glm::dvec4 a = clip_position(camera, from);
  glm::dvec4 b = clip_position(camera, to);
  // In front of the near plane: z + w >= 0.
  const double da = a.z + a.w;
  const double db = b.z + b.w;
  if (da < 0.0 && db < 0.0) return false;
  if (da < 0.0) a += (b - a) * (da / (da - db));
  if (db < 0.0) b += (a - b) * (db / (db - da));
  const auto window = [&](const glm::dvec4& p) {
    return glm::dvec2((0.5 + 0.5 * p.x / p.w) * viewport.width,
                      (0.5 - 0.5 * p.y / p.w) * viewport.height);
  };
  line = {window(a), window(b)};
  return true;
}

std::vector<std::array<glm::dvec3, 2>> frustum_edges(const Camera& camera, double depth) {
  const std::array<glm::dvec2, 4> corners = {{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}};
  const double near_m = camera.lens.near_m;
  // The near window itself is often too small to be seen.
  const double first_m = std::min(depth, near_m + 0.12 * (depth - near_m));
  const bool parallel = camera.lens.projection == Projection::orthographic;
  std::vector<std::array<glm::dvec3, 2>> edges;
  for (std::size_t i = 0; i < 4; ++i) {
    const Ray ray = camera.ray(corners[i]);
    const Ray next = camera.ray(corners[(i + 1) % 4]);
    const auto at = [](const Ray& r, double t) { return r.origin + r.direction * t; };
    edges.push_back({at(ray, parallel ? near_m : 0.0), at(ray, depth)});
    edges.push_back({at(ray, first_m), at(next, first_m)});
    edges.push_back({at(ray, depth), at(next, depth)});
  }
  return edges;
}

}  // namespace vislab
