// Idea: two convex polytopes are disjoint exactly if one of their faces' normals, or a cross
// product
//   of two of their edges, separates them. Everything about the frustum is computed once in
//   rational numbers; each question is asked in intervals, then, if they do not tell, in rational
//   numbers.
// Source: CGAL 5.5, Interval_nt and Exact_rational.
#include "tests/geometry/exact_judge.h"

#include <CGAL/Exact_rational.h>
#include <CGAL/Interval_nt.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace vislab::test {
namespace {

using Rational = CGAL::Exact_rational;
using Interval = CGAL::Interval_nt_advanced;
using Rounding = CGAL::Protect_FPU_rounding<true>;  // what Interval needs while it computes

template <typename Number>
struct Vector {
  std::array<Number, 3> parts;
  const Number& operator[](std::size_t i) const { return parts[i]; }
  Number& operator[](std::size_t i) { return parts[i]; }
};

template <typename Number>
Number dot(const Vector<Number>& a, const Vector<Number>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <typename Number>
Vector<Number> vector_of(const glm::dvec3& v) {
  return {{Number(v.x), Number(v.y), Number(v.z)}};
}

using Exact = Vector<Rational>;

Exact operator+(const Exact& a, const Exact& b) {
  return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}};
}
Exact operator*(const Exact& a, const Rational& s) { return {{a[0] * s, a[1] * s, a[2] * s}}; }
Exact cross(const Exact& a, const Exact& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

Interval interval_of(const Rational& value) { return Interval(CGAL::to_interval(value)); }
Vector<Interval> interval_of(const Exact& v) {
  return {{interval_of(v[0]), interval_of(v[1]), interval_of(v[2])}};
}

/// Vertices in a mesh's frame, and what takes them to the world.
struct Triangle {
  const std::array<glm::vec3, 3>& vertices;
  const glm::dmat4x3& transform;
};

/// Half-space normal . (p - eye) >= offset, or the extent of a frustum along an axis, in both kinds
/// of numbers.
struct Direction {
  Exact exact;
  Vector<Interval> interval;
  std::array<bool, 3> positive{};  // or 0
  double length = 0.0;             // nearly

  explicit Direction(const Exact& direction) : exact(direction), interval(interval_of(direction)) {
    for (std::size_t i = 0; i < 3; ++i) {
      positive[i] = exact[i] >= 0;
      length = std::hypot(length, CGAL::to_double(exact[i]));
    }
  }
  template <typename Number>
  const Vector<Number>& as() const {
    if constexpr (std::is_same_v<Number, Rational>) {
      return exact;
    } else {
      return interval;
    }
  }
};

struct Value {
  Rational exact;
  Interval interval;

  explicit Value(const Rational& value) : exact(value), interval(interval_of(value)) {}
  template <typename Number>
  const Number& as() const {
    if constexpr (std::is_same_v<Number, Rational>) {
      return exact;
    } else {
      return interval;
    }
  }
};

struct HalfSpace {
  Direction normal;
  Value offset;
};

struct Extent {
  Direction axis;
  bool bounded_below, bounded_above;
  Value low, high;
};

// What is asked of either kind of number; false if an interval cannot tell.
bool surely(bool answer) { return answer; }
bool surely(CGAL::Uncertain<bool> answer) { return CGAL::certainly(answer); }

/// A frustum as the hull of points and of rays from them.
struct Hull {
  std::vector<Exact> points;
  std::vector<Exact> rays;
};

/// Extents along all axes that can separate the hull from a box.
std::vector<Extent> extents_of(const Hull& hull, const std::vector<Exact>& normals,
                               const std::vector<Exact>& edges) {
  std::vector<Exact> axes = normals;
  std::array<Exact, 3> box_axes;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) box_axes[i][j] = i == j ? 1 : 0;
    axes.push_back(box_axes[i]);
  }
  for (const Exact& edge : edges) {
    for (const Exact& axis : box_axes) axes.push_back(cross(axis, edge));
  }
  std::vector<Extent> extents;
  for (const Exact& axis : axes) {
    if (dot(axis, axis) == 0) continue;
    Rational low = dot(axis, hull.points[0]);
    Rational high = low;
    for (const Exact& point : hull.points) {
      const Rational along = dot(axis, point);
      if (along < low) low = along;
      if (along > high) high = along;
    }
    bool bounded_below = true;
    bool bounded_above = true;
    for (const Exact& ray : hull.rays) {
      const Rational along = dot(axis, ray);
      if (along < 0) bounded_below = false;
      if (along > 0) bounded_above = false;
    }
    extents.push_back({Direction(axis), bounded_below, bounded_above, Value(low), Value(high)});
  }
  return extents;
}

}  // namespace

struct ExactJudge::Frusta {
  glm::dvec3 eye;
  std::vector<HalfSpace> planes;
  Camera camera;
  std::vector<Extent> plane_extents;  // of the frustum that the planes bound
  std::vector<Extent> ray_extents;    // of the frustum that the corner rays span

  void find_extents();  // of both, when they are first asked for

  /// Distance of a point from a plane, times the length of its normal.
  template <typename Number>
  Number distance(const Direction& normal, const Value& offset, const glm::dvec3& point) const {
    Vector<Number> way;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<int>(i);
      way[i] = Number(point[axis]) - Number(eye[axis]);
    }
    return dot(normal.as<Number>(), way) - offset.as<Number>();
  }
  template <typename Number>
  Number distance(const HalfSpace& plane, const glm::dvec3& point) const {
    return distance<Number>(plane.normal, plane.offset, point);
  }

  /// The corner of the box that lies farthest along (sign 1) or against (-1) a direction.
  static glm::dvec3 extreme(const Aabb& box, const Direction& direction, int sign) {
    glm::dvec3 corner;
    for (int axis = 0; axis < 3; ++axis) {
      const bool high = direction.positive[static_cast<std::size_t>(axis)] == (sign > 0);
      corner[axis] = high ? box.max[axis] : box.min[axis];
    }
    return corner;
  }

  template <typename Number>
  bool outside(const HalfSpace& plane, const Aabb& box) const {
    return surely(distance<Number>(plane, extreme(box, plane.normal, 1)) < Number(0));
  }
  template <typename Number>
  bool inside(const HalfSpace& plane, const Aabb& box) const {
    return surely(distance<Number>(plane, extreme(box, plane.normal, -1)) >= Number(0));
  }

  /// Is the centre behind (sign -1) or before (1) the plane by more than the radius?
  template <typename Number>
  bool beyond(const HalfSpace& plane, const Sphere& sphere, int sign) const {
    const Number along = distance<Number>(plane, glm::dvec3(sphere.center)) * Number(sign);
    const Number radius(static_cast<double>(sphere.radius));
    const auto& normal = plane.normal.as<Number>();
    return surely(along > Number(0)) &&
           surely(along * along > radius * radius * dot(normal, normal));
  }
  template <typename Number>
  bool outside(const HalfSpace& plane, const Sphere& sphere) const {
    return beyond<Number>(plane, sphere, -1);
  }
  template <typename Number>
  bool inside(const HalfSpace& plane, const Sphere& sphere) const {
    return beyond<Number>(plane, sphere, 1);
  }

  template <typename Number>
  Number reach(const HalfSpace& plane, const OrientedBox& box) const {
    Number sum(0);
    for (int i = 0; i < 3; ++i) {
      sum = sum + CGAL::abs(dot(plane.normal.as<Number>(), vector_of<Number>(box.half_axes[i])));
    }
    return sum;
  }
  template <typename Number>
  bool outside(const HalfSpace& plane, const OrientedBox& box) const {
    return surely(distance<Number>(plane, box.center) + reach<Number>(plane, box) < Number(0));
  }
  template <typename Number>
  bool inside(const HalfSpace& plane, const OrientedBox& box) const {
    return surely(distance<Number>(plane, box.center) - reach<Number>(plane, box) >= Number(0));
  }

  template <typename Number>
  bool outside(const HalfSpace& plane, const Triangle& triangle) const {
    const auto& normal = plane.normal.as<Number>();
    for (const glm::vec3& vertex : triangle.vertices) {
      Number along = distance<Number>(plane, triangle.transform[3]);
      for (int i = 0; i < 3; ++i) {
        along = along + dot(normal, vector_of<Number>(triangle.transform[i])) *
                            Number(static_cast<double>(vertex[i]));
      }
      if (!surely(along < Number(0))) return false;
    }
    return true;
  }

  template <typename Volume>
  bool outside_of_a_plane(const Volume& volume) const {
    {
      const Rounding rounding;
      for (const HalfSpace& plane : planes) {
        if (outside<Interval>(plane, volume)) return true;
      }
    }
    for (const HalfSpace& plane : planes) {
      if (outside<Rational>(plane, volume)) return true;
    }
    return false;
  }

  template <typename Volume>
  bool inside_of_all(const Volume& volume) const {
    for (const HalfSpace& plane : planes) {
      bool sure = false;
      {
        const Rounding rounding;
        sure = inside<Interval>(plane, volume);
      }
      if (!sure && !inside<Rational>(plane, volume)) return false;
    }
    return true;
  }

  /// How far the box lies above and below a frustum along an axis, times the axis' length.
  template <typename Number>
  Number above(const Extent& extent, const Aabb& box) const {
    return distance<Number>(extent.axis, extent.high, extreme(box, extent.axis, -1));
  }
  template <typename Number>
  Number below(const Extent& extent, const Aabb& box) const {
    return -distance<Number>(extent.axis, extent.low, extreme(box, extent.axis, 1));
  }

  template <typename Number>
  bool separated(const std::vector<Extent>& extents, const Aabb& box) const {
    for (const Extent& extent : extents) {
      if (extent.bounded_above && surely(above<Number>(extent, box) > Number(0))) return true;
      if (extent.bounded_below && surely(below<Number>(extent, box) > Number(0))) return true;
    }
    return false;
  }

  bool disjoint(const std::vector<Extent>& extents, const Aabb& box) const {
    {
      const Rounding rounding;
      if (separated<Interval>(extents, box)) return true;
    }
    return separated<Rational>(extents, box);
  }
};

void ExactJudge::Frusta::find_extents() {
  if (!plane_extents.empty()) return;
  const Lens& lens = camera.lens;
  const Exact right = vector_of<Rational>(camera.pose.right);
  const Exact up = vector_of<Rational>(camera.pose.up);
  const Exact forward = vector_of<Rational>(-camera.pose.back);
  const Rational forward_squared = dot(forward, forward);
  const bool perspective = lens.projection == Projection::perspective;
  const bool has_far = std::isfinite(lens.far_m);
  const Rational near(lens.near_m);

  // The frustum of the planes: each edge along the view is where two sides meet.
  Hull of_planes;
  Hull of_rays;
  std::vector<Exact> plane_edges{cross(planes[0].normal.exact, forward),
                                 cross(planes[2].normal.exact, forward)};
  std::vector<Exact> ray_edges{right, up};
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 2; j < 4; ++j) {
      const HalfSpace& a = planes[i];
      const HalfSpace& b = planes[j];
      Exact edge = cross(a.normal.exact, b.normal.exact);
      if (dot(edge, forward) < 0) edge = edge * Rational(-1);
      plane_edges.push_back(edge);
      // The point where both sides and the plane forward . x = depth meet (x measured from the
      // eye).
      const auto at = [&](const Rational& depth) {
        const Exact sum = cross(b.normal.exact, forward) * a.offset.exact +
                          cross(forward, a.normal.exact) * b.offset.exact +
                          cross(a.normal.exact, b.normal.exact) * depth;
        return sum * (Rational(1) / dot(cross(a.normal.exact, b.normal.exact), forward));
      };
      of_planes.points.push_back(at(forward_squared * near));
      if (has_far) {
        of_planes.points.push_back(at(forward_squared * Rational(lens.far_m)));
      } else {
        of_planes.rays.push_back(edge);
      }

      const Exact offset = right * Rational(i == 0 ? lens.left : lens.right) +
                           up * Rational(j == 2 ? lens.bottom : lens.top);
      const Exact along = perspective ? offset + forward * near : forward;
      ray_edges.push_back(along);
      const auto on_ray = [&](const Rational& depth) {
        return perspective ? along * (depth / near) : offset + along * depth;
      };
      of_rays.points.push_back(on_ray(near));
      if (has_far) {
        of_rays.points.push_back(on_ray(Rational(lens.far_m)));
      } else {
        of_rays.rays.push_back(along);
      }
    }
  }
  std::vector<Exact> plane_normals;
  for (const HalfSpace& plane : planes) plane_normals.push_back(plane.normal.exact);
  plane_extents = extents_of(of_planes, plane_normals, plane_edges);
  // The faces between the rays left bottom, left top, right bottom, right top.
  std::vector<Exact> ray_normals{cross(right, up)};
  const auto between = [&](std::size_t i, std::size_t j) {
    const Exact& other = perspective ? ray_edges[2 + j] : (j - i == 1 ? up : right);
    ray_normals.push_back(cross(ray_edges[2 + i], other));
  };
  between(0, 1);
  between(0, 2);
  between(1, 3);
  between(2, 3);
  ray_extents = extents_of(of_rays, ray_normals, ray_edges);
}

ExactJudge::ExactJudge(const Camera& camera) : frusta_(std::make_unique<Frusta>()) {
  const Lens& lens = camera.lens;
  const Exact right = vector_of<Rational>(camera.pose.right);
  const Exact up = vector_of<Rational>(camera.pose.up);
  const Exact forward = vector_of<Rational>(-camera.pose.back);
  const bool perspective = lens.projection == Projection::perspective;
  const bool has_far = std::isfinite(lens.far_m);
  const Rational near(lens.near_m);
  frusta_->eye = camera.pose.eye;
  frusta_->camera = camera;

  std::vector<HalfSpace>& planes = frusta_->planes;
  const auto add_plane = [&](const Exact& normal, const Rational& offset) {
    planes.push_back({Direction(normal), Value(offset)});
  };
  const auto add_side = [&](const Exact& axis, double low, double high) {
    if (perspective) {
      add_plane(axis * near + forward * Rational(-low), Rational(0));
      add_plane(axis * -near + forward * Rational(high), Rational(0));
    } else {
      add_plane(axis, dot(axis, axis) * Rational(low));
      add_plane(axis * Rational(-1), dot(axis, axis) * Rational(-high));
    }
  };
  add_side(right, lens.left, lens.right);
  add_side(up, lens.bottom, lens.top);
  const Rational forward_squared = dot(forward, forward);
  add_plane(forward, forward_squared * near);
  if (has_far) add_plane(forward * Rational(-1), forward_squared * Rational(-lens.far_m));
}

ExactJudge::~ExactJudge() = default;

bool ExactJudge::outside_of_a_plane(const Aabb& box) const {
  return frusta_->outside_of_a_plane(box);
}
bool ExactJudge::outside_of_a_plane(const Sphere& sphere) const {
  return frusta_->outside_of_a_plane(sphere);
}
bool ExactJudge::outside_of_a_plane(const OrientedBox& box) const {
  return frusta_->outside_of_a_plane(box);
}
bool ExactJudge::outside_of_a_plane(const std::array<glm::vec3, 3>& triangle,
                                    const glm::dmat4x3& transform) const {
  return frusta_->outside_of_a_plane(Triangle{triangle, transform});
}
bool ExactJudge::inside(const Aabb& box) const { return frusta_->inside_of_all(box); }
bool ExactJudge::inside(const Sphere& sphere) const { return frusta_->inside_of_all(sphere); }
bool ExactJudge::inside(const OrientedBox& box) const { return frusta_->inside_of_all(box); }

bool ExactJudge::disjoint(const Aabb& box) const {
  frusta_->find_extents();
  return frusta_->disjoint(frusta_->plane_extents, box) &&
         frusta_->disjoint(frusta_->ray_extents, box);
}

bool ExactJudge::clearly_outside_of_a_plane(const Aabb& box, double margin) const {
  const Rounding rounding;
  for (const HalfSpace& plane : frusta_->planes) {
    const glm::dvec3 corner = Frusta::extreme(box, plane.normal, 1);
    if (frusta_->distance<Interval>(plane, corner).sup() < -margin * plane.normal.length) {
      return true;
    }
  }
  return false;
}

bool ExactJudge::clearly_inside(const Aabb& box, double margin) const {
  const Rounding rounding;
  for (const HalfSpace& plane : frusta_->planes) {
    const glm::dvec3 corner = Frusta::extreme(box, plane.normal, -1);
    if (frusta_->distance<Interval>(plane, corner).inf() <= margin * plane.normal.length) {
      return false;
    }
  }
  return true;
}

bool ExactJudge::clearly_disjoint(const Aabb& box, double margin) const {
  frusta_->find_extents();
  const Rounding rounding;
  for (const Extent& extent : frusta_->plane_extents) {
    const double least = margin * extent.axis.length;
    if (extent.bounded_above && frusta_->above<Interval>(extent, box).inf() > least) return true;
    if (extent.bounded_below && frusta_->below<Interval>(extent, box).inf() > least) return true;
  }
  return false;
}

}  // namespace vislab::test
