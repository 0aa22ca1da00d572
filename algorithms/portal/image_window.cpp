#include "algorithms/portal/image_window.h"

#include <algorithm>

#include "algorithms/portal/convex_cut.h"
#include "common/geometry/frustum.h"

namespace vislab::portal_culling {
namespace {

/// Shorter edges have no direction that can be relied on: corners are rounded to about 1e-15, so
/// that the direction of longer ones is wrong by 1e-6 radians at most, and only across themselves.
constexpr double shortest_edge = 1e-9;

std::array<ImageLine, 4> sides_of(const Rectangle& r) {
  return {ImageLine{{1.0, 0.0}, window_slack - r.min.x},
          ImageLine{{-1.0, 0.0}, window_slack + r.max.x},
          ImageLine{{0.0, 1.0}, window_slack - r.min.y},
          ImageLine{{0.0, -1.0}, window_slack + r.max.y}};
}

}  // namespace

ImagePolygon& ImagePolygon::operator=(const ImagePolygon& other) {
  std::copy_n(other.corners_.begin(), other.count_, corners_.begin());
  count_ = other.count_;
  bounds_ = other.bounds_;
  return *this;
}

void ImagePolygon::set(const Rectangle& r) {
  clear();
  add(r.min);
  add({r.max.x, r.min.y});
  add(r.max);
  add({r.min.x, r.max.y});
}

bool ImagePolygon::cut(const ImageLine& line) {
  std::array<double, capacity> distance;
  for (std::uint32_t k = 0; k < count_; ++k) distance[k] = line.distance(corners_[k]);
  std::array<glm::dvec2, capacity> kept;
  std::uint32_t count = 0;
  const Cut cut = cut_convex<glm::dvec2>(corners(), std::span(distance).first(count_), kept, count);
  if (cut == Cut::in_two) {
    std::copy_n(kept.begin(), count, corners_.begin());
    count_ = count;
  }
  return cut != Cut::all_outside;
}

void ImagePolygon::find_bounds() {
  bounds_ = {};
  for (const glm::dvec2& p : corners()) bounds_.extend(p);
}

bool ImageWindow::set_part(const ImagePolygon& polygon, const ImageWindow& window) {
  polygon_ = polygon;
  for (const ImageLine& line : window.lines()) {
    if (!polygon_.cut(line)) return false;
  }
  polygon_.find_bounds();
  find_lines();
  return polygon_.size() >= 3;
}

void ImageWindow::find_lines() {
  line_count_ = 0;
  const std::span<const glm::dvec2> corners = polygon_.corners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec2 edge = corners[i + 1 == corners.size() ? 0 : i + 1] - corners[i];
    const double length = glm::length(edge);
    if (!(length > shortest_edge)) continue;
    const glm::dvec2 inward = glm::dvec2(-edge.y, edge.x) / length;
    lines_[line_count_++] = {inward, window_slack - glm::dot(inward, corners[i])};
  }
}

Rectangle ImageMap::whole() const {
  const Lens& lens = camera_.lens;
  const double distance = lens.projection == Projection::perspective ? lens.near_m : 1.0;
  return {{lens.left / distance, lens.bottom / distance},
          {lens.right / distance, lens.top / distance}};
}

bool ImageMap::image_of(std::span<const glm::dvec3> polygon, ImagePolygon& image) const {
  const bool perspective = camera_.lens.projection == Projection::perspective;
  const double near = camera_.lens.near_m;
  const auto local = [&](const glm::dvec3& p) {
    const glm::dvec3 d = p - camera_.pose.eye;
    return glm::dvec3(glm::dot(camera_.pose.right, d), glm::dot(camera_.pose.up, d),
                      -glm::dot(camera_.pose.back, d));
  };
  // A polygon that lies in the near plane may cross it at each of its edges, by rounding.
  Rectangle bounds;
  std::uint32_t count = 0;
  std::uint32_t crossings = 0;
  image.clear();
  const auto add = [&](const glm::dvec2& p) {
    bounds.extend(p);
    if (++count <= ImagePolygon::capacity) image.add(p);
  };
  glm::dvec3 before = local(polygon.back());
  for (const glm::dvec3& corner : polygon) {
    const glm::dvec3 p = local(corner);
    if ((p.z < near) != (before.z < near)) {
      ++crossings;
      const glm::dvec2 q(before + (p - before) * ((near - before.z) / (p.z - before.z)));
      add(perspective ? q / near : q);
    }
    if (p.z >= near) add(perspective ? glm::dvec2(p) / p.z : glm::dvec2(p));
    before = p;
  }
  if (count > ImagePolygon::capacity || crossings > 2) image.set(bounds);
  return image.size() >= 3;
}

Plane ImageMap::plane_of(const ImageLine& line) const {
  const glm::dvec3 across = camera_.pose.right * line.normal.x + camera_.pose.up * line.normal.y;
  if (camera_.lens.projection == Projection::orthographic) return {across, line.offset};
  return {across - camera_.pose.back * line.offset, 0.0};
}

void WindowPlanes::set(const ImageMap& map, const ImageWindow& window) {
  set(map, window.bounds());
  for (const ImageLine& line : window.lines()) add(map.plane_of(line));
}

void WindowPlanes::set(const ImageMap& map, const Rectangle& rectangle) {
  eye_ = map.camera().pose.eye;
  count_ = 0;
  for (const ImageLine& side : sides_of(rectangle)) add(map.plane_of(side));
}

bool WindowPlanes::meets(const Aabb& box) const {
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (planes_[i].signed_distance(p_vertex(planes_[i], box) - eye_) < 0.0) return false;
  }
  return true;
}

}  // namespace vislab::portal_culling
