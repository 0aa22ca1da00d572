// Idea: the sign of (b - a) x (c - a) . (eye - a) under the object's transform, in intervals and,
//   where these hold 0, in rational numbers. Differences of vertices and of the eye and the
//   object's place are taken first, so that intervals stay narrow far from the origin. A transform
//   that mirrors turns the sign round.
// Source: CGAL 5.5, Interval_nt and Exact_rational.
#include "tests/geometry/exact_facing.h"

#include <CGAL/Exact_rational.h>
#include <CGAL/Interval_nt.h>

#include <array>

namespace vislab::test {
namespace {

using Rational = CGAL::Exact_rational;
using Interval = CGAL::Interval_nt_advanced;
using Rounding = CGAL::Protect_FPU_rounding<true>;  // what Interval needs while it computes

template <typename Number>
using Vector = std::array<Number, 3>;

template <typename Number>
Vector<Number> difference(const glm::dvec3& to, const glm::dvec3& from) {
  return {Number(to.x) - Number(from.x), Number(to.y) - Number(from.y),
          Number(to.z) - Number(from.z)};
}

template <typename Number>
Number determinant_of(const Vector<Number>& a, const Vector<Number>& b, const Vector<Number>& c) {
  return (a[1] * b[2] - a[2] * b[1]) * c[0] + (a[2] * b[0] - a[0] * b[2]) * c[1] +
         (a[0] * b[1] - a[1] * b[0]) * c[2];
}

/// An object and the eye in one kind of number.
template <typename Number>
struct View {
  std::array<Vector<Number>, 3> axes;  // columns of the transform
  Vector<Number> eye;                  // less the object's place; orthographic: the direction
  bool perspective;

  View(const Camera& camera, const glm::dmat4x3& transform)
      : perspective(camera.lens.projection == Projection::perspective) {
    const glm::dvec3 zero(0.0);
    for (int i = 0; i < 3; ++i) {
      axes[static_cast<std::size_t>(i)] = difference<Number>(transform[i], zero);
    }
    eye = perspective ? difference<Number>(camera.pose.eye, transform[3])
                      : difference<Number>(camera.pose.back, zero);
  }

  Vector<Number> turned(const Vector<Number>& v) const {
    Vector<Number> sum;
    for (std::size_t i = 0; i < 3; ++i) {
      sum[i] = axes[0][i] * v[0] + axes[1][i] * v[1] + axes[2][i] * v[2];
    }
    return sum;
  }

  /// Positive if the vertices appear counter-clockwise in the world.
  Number volume(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) const {
    Vector<Number> to_eye = eye;
    if (perspective) {
      const Vector<Number> at = turned(difference<Number>(a, glm::dvec3(0.0)));
      for (std::size_t i = 0; i < 3; ++i) to_eye[i] = to_eye[i] - at[i];
    }
    return determinant_of(turned(difference<Number>(b, a)), turned(difference<Number>(c, a)),
                          to_eye);
  }
};

int sign_of(const Rational& value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

void judge_object(const Camera& camera, const glm::dmat4x3& transform, const Mesh& mesh,
                  Facing* facings) {
  const View<Rational> exact(camera, transform);
  const int handed = sign_of(determinant_of(exact.axes[0], exact.axes[1], exact.axes[2]));
  std::vector<std::uint32_t> open;
  {
    const Rounding rounding;
    const View<Interval> view(camera, transform);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const glm::uvec3& corners = mesh.triangles[i];
      const Interval value =
          view.volume(glm::dvec3(mesh.positions[corners.x]), glm::dvec3(mesh.positions[corners.y]),
                      glm::dvec3(mesh.positions[corners.z]));
      if (value.inf() > 0.0 || value.sup() < 0.0) {
        facings[i] = (value.inf() > 0.0) == (handed > 0) ? Facing::front : Facing::back;
      } else {
        open.push_back(i);
      }
    }
  }
  for (const std::uint32_t i : open) {
    const glm::uvec3& corners = mesh.triangles[i];
    const int sign = handed * sign_of(exact.volume(glm::dvec3(mesh.positions[corners.x]),
                                                   glm::dvec3(mesh.positions[corners.y]),
                                                   glm::dvec3(mesh.positions[corners.z])));
    facings[i] = sign > 0 ? Facing::front : sign < 0 ? Facing::back : Facing::edge_on;
  }
}

}  // namespace

std::vector<Facing> exact_facings(const Scene& scene, const Frame& frame) {
  std::vector<Facing> facings(scene.triangle_count());
  for (ObjectId object = 0; object < scene.object_count(); ++object) {
    judge_object(frame.camera, frame.objects.transforms[object], scene.mesh_of(object),
                 facings.data() + scene.first_triangle(object));
  }
  return facings;
}

double FacingCounts::recall() const {
  return back == 0 ? 1.0 : static_cast<double>(back_left_out) / static_cast<double>(back);
}

FacingCounts& FacingCounts::operator+=(const FacingCounts& other) {
  front_left_out += other.front_left_out;
  edge_on_left_out += other.edge_on_left_out;
  back += other.back;
  back_left_out += other.back_left_out;
  twice += other.twice;
  return *this;
}

FacingCounts count_facings(const Scene& scene, const Frame& frame, std::span<const Facing> facings,
                           std::span<const TriangleRange> kept) {
  FacingCounts counts;
  std::vector<std::uint8_t> is_kept(facings.size(), 0);
  for (const TriangleRange& range : kept) {
    const TriangleId first = scene.first_triangle(range.object) + range.first;
    for (TriangleId id = first; id < first + range.count; ++id) {
      counts.twice += is_kept[id];
      is_kept[id] = 1;
    }
  }
  for (const ObjectId object : frame.objects.shown) {
    const TriangleId first = scene.first_triangle(object);
    for (TriangleId id = first; id < first + scene.triangle_count(object); ++id) {
      const std::uint64_t left_out = is_kept[id] == 0 ? 1 : 0;
      switch (facings[id]) {
        case Facing::front:
          counts.front_left_out += left_out;
          break;
        case Facing::edge_on:
          counts.edge_on_left_out += left_out;
          break;
        case Facing::back:
          ++counts.back;
          counts.back_left_out += left_out;
      }
    }
  }
  return counts;
}

}  // namespace vislab::test
