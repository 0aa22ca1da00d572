// Idea: a volume is outside of a frustum if it is outside of one of its planes. Corners, n- and
//   p-vertex, spheres and oriented boxes differ in how the volume's reach along a plane's normal is
//   found. The exact test of boxes asks, beside the planes, all other axes along which two convex
//   bodies can be separated.
// Guarantee: conservative under rounding; every test carries an error bound.
// Cost: at most 6 planes with 8, 2 and 1 distances; the exact test at most 27 axes. Boxes whose
//   centre is inside all planes cannot be separated and need the planes only.
// Limits: the tests on planes keep what is outside beyond an edge or a corner.
// Sources: Assarsson and Moeller 2000; Gottschalk, Lin and Manocha 1996; Kowalka
// 2016, 3.2.1, 4.3.2.
#include "common/geometry/frustum_side.h"

namespace vislab {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// All planes of a frustum by a test of one.
template <typename Volume, typename Test>
Side side_by_planes(const Frustum& frustum, const Volume& volume, std::uint64_t* planes_tested,
                    Test test) {
  Side side = Side::inside;
  std::uint64_t tested = 0;
  for (const Plane& plane : frustum.span()) {
    ++tested;
    const Side of_plane = test(plane, volume);
    if (of_plane == Side::inside) continue;
    side = of_plane;
    if (side == Side::outside) break;
  }
  if (planes_tested != nullptr) *planes_tested += tested;
  return side;
}

}  // namespace

Side side_by_corners(const Plane& plane, const Aabb& box) {
  bool all_outside = true;
  bool all_inside = true;
  for (unsigned corner = 0; corner < 8 && (all_outside || all_inside); ++corner) {
    const glm::dvec3 p((corner & 1U) != 0 ? box.max.x : box.min.x,
                       (corner & 2U) != 0 ? box.max.y : box.min.y,
                       (corner & 4U) != 0 ? box.max.z : box.min.z);
    const double distance = plane.signed_distance(p);
    const double error = distance_error(plane, p);
    all_outside = all_outside && distance < -error;
    all_inside = all_inside && distance > error;
  }
  if ((!all_outside && !all_inside) || !box.valid()) return Side::intersecting;
  return all_outside ? Side::outside : Side::inside;
}

Side side_of(const Plane& plane, const Sphere& sphere) {
  if (surely_outside(plane, sphere)) return Side::outside;
  return surely_inside(plane, sphere) ? Side::inside : Side::intersecting;
}

Side side_of(const Plane& plane, const OrientedBox& box) {
  const double distance = plane.signed_distance(box.center);
  double reach = 0.0;
  double size = 0.0;
  for (int i = 0; i < 3; ++i) {
    reach += std::abs(glm::dot(plane.normal, box.half_axes[i]));
    size += absolute_sum(box.half_axes[i]);
  }
  // What holds for the centre (distance_error) holds for the half-axes too. NaN answers false.
  const double error = distance_error(plane, box.center) + 16.0 * epsilon * size;
  if (distance + reach < -error) return Side::outside;
  return distance - reach > error ? Side::inside : Side::intersecting;
}

Side side_by_corners(const Frustum& frustum, const Aabb& box, std::uint64_t* planes_tested) {
  return side_by_planes(frustum, box, planes_tested,
                        [](const Plane& p, const Aabb& b) { return side_by_corners(p, b); });
}

Side side_by_vertices(const Frustum& frustum, const Aabb& box, std::uint64_t* planes_tested) {
  return side_by_planes(frustum, box, planes_tested,
                        [](const Plane& p, const Aabb& b) { return side_by_vertices(p, b); });
}

Side side_of(const Frustum& frustum, const Sphere& sphere, std::uint64_t* planes_tested) {
  return side_by_planes(frustum, sphere, planes_tested,
                        [](const Plane& p, const Sphere& s) { return side_of(p, s); });
}

Side side_of(const Frustum& frustum, const OrientedBox& box, std::uint64_t* planes_tested) {
  return side_by_planes(frustum, box, planes_tested,
                        [](const Plane& p, const OrientedBox& b) { return side_of(p, b); });
}

ExactFrustum::ExactFrustum(const Camera& camera)
    : planes_(frustum_of(camera)), pose_(camera.pose), lens_(camera.lens) {
  const bool perspective = lens_.projection == Projection::perspective;
  const double near = perspective ? lens_.near_m : 1.0;
  const double width = std::max(std::abs(lens_.left), std::abs(lens_.right)) / near;
  const double height = std::max(std::abs(lens_.bottom), std::abs(lens_.top)) / near;
  (perspective ? slope_size_ : offset_size_) += width + height;

  std::array<glm::dvec3, 6> edges{pose_.right, pose_.up};
  std::size_t edge_count = 2;
  if (perspective) {
    for (const double x : {lens_.left, lens_.right}) {
      for (const double y : {lens_.bottom, lens_.top}) {
        edges[edge_count++] = pose_.right * (x / near) + pose_.up * (y / near) - pose_.back;
      }
    }
  } else {
    edges[edge_count++] = pose_.back;
  }
  const glm::dmat3 box_axes(1.0);
  for (int i = 0; i < 3; ++i) add_axis(box_axes[i]);
  for (const glm::dvec3& edge : std::span(edges).first(edge_count)) {
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 direction = glm::cross(box_axes[i], edge);
      const double length = glm::length(direction);
      // An edge along an axis of the box has no cross product with it and needs none.
      if (length > 0.0) add_axis(direction / length);
    }
  }
}

void ExactFrustum::add_axis(const glm::dvec3& direction) {
  Axis axis{direction, 0.0, 0.0, 0.0, 0.0};
  const auto at = [&](double x, double y) {
    return glm::dot(direction, pose_.right * x + pose_.up * y);
  };
  const double forward = -glm::dot(direction, pose_.back);
  const auto [low, high] = std::minmax({at(lens_.left, lens_.bottom), at(lens_.left, lens_.top),
                                        at(lens_.right, lens_.bottom), at(lens_.right, lens_.top)});
  if (lens_.projection == Projection::perspective) {
    axis.slope_low = low / lens_.near_m + forward;
    axis.slope_high = high / lens_.near_m + forward;
  } else {
    axis.offset_low = low;
    axis.offset_high = high;
    axis.slope_low = axis.slope_high = forward;
  }
  axes_[axis_count_++] = axis;
}

bool ExactFrustum::separates(const Axis& axis, const glm::dvec3& center, const glm::dvec3& half,
                             double depth, double error) const {
  const double middle = glm::dot(axis.direction, center);
  const double reach = glm::dot(glm::abs(axis.direction), half);
  const double high =
      axis.offset_high + std::max(axis.slope_high * lens_.near_m, axis.slope_high * depth);
  const double low =
      axis.offset_low + std::min(axis.slope_low * lens_.near_m, axis.slope_low * depth);
  return middle - reach > high + error || middle + reach < low - error;
}

Side ExactFrustum::side(const Aabb& box, std::uint64_t* axes_tested) const {
  std::uint64_t tested = 0;
  Side side = Side::inside;
  bool center_inside = true;
  const glm::dvec3 middle = box.center();
  for (const Plane& plane : planes_.span()) {
    ++tested;
    const Side of_plane = side_by_vertices(plane, box);
    if (of_plane == Side::inside) continue;
    side = of_plane;
    if (side == Side::outside) break;
    center_inside = center_inside && plane.signed_distance(middle) >= 0.0;
  }
  if (side == Side::intersecting && !center_inside && box.valid()) {
    const glm::dvec3 low = glm::dvec3(box.min) - pose_.eye;
    const glm::dvec3 high = glm::dvec3(box.max) - pose_.eye;
    const glm::dvec3 center = (low + high) * 0.5;
    const glm::dvec3 half = (high - low) * 0.5;
    const double size = absolute_sum(glm::max(glm::abs(low), glm::abs(high)));
    const double rounding = 16.0 * epsilon * slope_size_ * size;
    // Nothing of the frustum beyond the box's own depth can meet it: this makes even a frustum
    // without a far plane finite.
    const double depth =
        glm::dot(glm::abs(pose_.back), half) - glm::dot(pose_.back, center) + rounding;
    const double farthest = std::max(std::min(lens_.far_m, depth), lens_.near_m);
    // Each extent is a sum of a few products, whose vectors carry a few ulp from the camera.
    const double error =
        16.0 * epsilon *
        (size + offset_size_ + slope_size_ * (std::abs(farthest) + std::abs(lens_.near_m)));
    for (const Axis& axis : std::span(axes_).first(axis_count_)) {
      ++tested;
      if (separates(axis, center, half, farthest, error)) {
        side = Side::outside;
        break;
      }
    }
  }
  if (axes_tested != nullptr) *axes_tested += tested;
  return side;
}

}  // namespace vislab
