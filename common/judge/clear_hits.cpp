#include "common/judge/clear_hits.h"

#include <cmath>

#include "common/judge/disputed.h"

namespace vislab {
namespace {

/// More than the distance asked for: float rays and vertices move a hit by some thousandths of a
/// pixel.
constexpr double margin_px = 1.25 * disputed_edge_px;
/// Bound on the error of a barycentric coordinate.
constexpr double barycentric_error = 4e-6;

}  // namespace

void ClearHits::start(const Frame& frame, const Scene& scene) {
  frame_ = &frame;
  scene_ = &scene;
  object_ = none_id;
  for (Entry& entry : entries_) entry.triangle = none_id;
  const auto& [eye, right, up, back] = frame.camera.pose;
  const Lens& lens = frame.camera.lens;
  perspective_ = lens.projection == Projection::perspective;
  const double width = frame.viewport.width / (lens.right - lens.left);
  const double height = frame.viewport.height / (lens.top - lens.bottom);
  if (perspective_) {
    row_x_ = (right * lens.near_m + back * lens.left) * width;
    row_y_ = (up * lens.near_m + back * lens.bottom) * height;
    offset_x_ = 0.0;
    offset_y_ = 0.0;
  } else {
    row_x_ = right * width;
    row_y_ = up * height;
    offset_x_ = -lens.left * width;
    offset_y_ = -lens.bottom * height;
  }
  row_w_ = -back;
}

void ClearHits::fill(Entry& entry, TriangleId triangle) {
  if (object_ == none_id || triangle < scene_->first_triangle(object_) ||
      triangle - scene_->first_triangle(object_) >= scene_->triangle_count(object_)) {
    object_ = scene_->object_of(triangle);
  }
  const std::array<glm::dvec3, 3> world =
      world_triangle(scene_->mesh_of(object_), frame_->objects.transforms[object_],
                     triangle - scene_->first_triangle(object_));
  const Lens& lens = frame_->camera.lens;
  std::array<glm::dvec3, 3> corner;
  entry.triangle = triangle;
  entry.cut = false;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 p = world[i] - frame_->camera.pose.eye;
    const double depth = glm::dot(row_w_, p);
    corner[i] = {glm::dot(row_x_, p) + offset_x_, glm::dot(row_y_, p) + offset_y_,
                 perspective_ ? depth : 1.0};
    if (depth < lens.near_m || depth > lens.far_m) entry.cut = true;
  }
  const std::array<glm::dvec3, 3> line = {glm::cross(corner[1], corner[2]),
                                          glm::cross(corner[2], corner[0]),
                                          glm::cross(corner[0], corner[1])};
  const double determinant = glm::dot(corner[0], line[0]);
  for (int i = 0; i < 3; ++i) {
    const double height = std::abs(determinant) / glm::length(glm::dvec2(line[i]));
    entry.factor[i] = static_cast<float>(height / margin_px);
    entry.slack[i] = static_cast<float>(height / margin_px * barycentric_error);
  }
  // 1 / depth is linear in the window: the lines' sum, divided by the determinant.
  const glm::dvec3 sum = line[0] + line[1] + line[2];
  entry.cut_slope =
      static_cast<float>(margin_px * glm::length(glm::dvec2(sum)) / std::abs(determinant));
}

bool ClearHits::clear_of_cuts(const Entry& entry, float depth) const {
  const Lens& lens = frame_->camera.lens;
  return perspective_ && 1.0 / lens.near_m - 1.0 / depth >= entry.cut_slope &&
         1.0 / depth - 1.0 / lens.far_m >= entry.cut_slope;
}

bool ClearHits::decide(TriangleId triangle, const glm::dvec2& window_px) const {
  return window_triangle(*frame_, *scene_, triangle).edge_distance(window_px) >= disputed_edge_px;
}

}  // namespace vislab
