#include "algorithms/backface/cluster_cones.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/backface/magnitudes.h"
#include "algorithms/backface/normal_cone.h"
#include "common/geometry/rounding.h"

namespace vislab::backface_culling {
namespace {

constexpr double float_epsilon = std::numeric_limits<float>::epsilon();

/// Rounded to float and back, in terms of `unit`.
glm::dvec3 rounded(const glm::dvec3& point, double unit) {
  return rounded_to_float(point / unit) * unit;
}

/// The square of what axis . w has to reach in terms of |w|, rounded up.
float squared(double sine) {
  // The normals are off by their plane_error. In terms of |w|: the axis rounded to float is longer
  // or shorter than 1 by an epsilon; each coordinate of w is rounded once, and the sum carries
  // three roundings more, together below 4 epsilons. The squares and their sum carry at most 5.
  const double enlarged = sine + 2.0 * plane_error + 6.0 * float_epsilon;
  return round_up(enlarged * enlarged * (1.0 + 8.0 * float_epsilon));
}

/// Centre and radius of a sphere around points, not much larger than the smallest: the centre goes
/// towards the farthest point in ever shorter steps (Badoiu and Clarkson 2003).
glm::dvec4 sphere_around(std::span<const glm::dvec3> points) {
  glm::dvec3 center(0.0);
  for (const glm::dvec3& point : points) center += point / static_cast<double>(points.size());
  constexpr int steps = 24;
  double radius = 0.0;
  for (int step = 0; step <= steps; ++step) {
    const glm::dvec3* farthest = &points[0];
    radius = 0.0;
    for (const glm::dvec3& point : points) {
      const double distance = glm::length(point - center);
      if (distance > radius) {
        radius = distance;
        farthest = &point;
      }
    }
    if (step < steps) center += (*farthest - center) / static_cast<double>(step + 2);
  }
  return {center, radius};
}

}  // namespace

ClusterCones::ClusterCones(ConeForm form, const MeshFrame& frame)
    : form_(form), unit_(frame.unit()) {}

float& ClusterCones::at(Row row) {
  const std::size_t lane = count_ % 64;
  return form_ == ConeForm::apex ? apexes_.back().row[row][lane] : spheres_.back().row[row][lane];
}

void ClusterCones::add_untested() {
  if (count_ % 64 == 0) {
    // An axis of no length never says "behind".
    if (form_ == ConeForm::apex) {
      apexes_.emplace_back();
    } else {
      spheres_.emplace_back();
    }
  }
  ++count_;
}

void ClusterCones::add(std::span<const glm::dvec4> planes, std::span<const glm::dvec3> vertices) {
  add_untested();
  --count_;
  const glm::vec3 axis(smallest_cone(planes).axis);
  const NormalCone cone =
      glm::dvec3(axis) == glm::dvec3(0.0) ? NormalCone{} : cone_around(glm::dvec3(axis), planes);
  if (cone.exists()) {
    glm::dvec3 point;
    if (form_ == ConeForm::apex) {
      // Rounding moves it by half of an epsilon; the planes are off by less than that.
      point = rounded(apex_behind(planes, cone.axis, unit_, float_epsilon), unit_);
    } else {
      const glm::dvec4 sphere = sphere_around(vertices);
      point = rounded(glm::dvec3(sphere), unit_);
      double farthest = 0.0;
      for (const glm::dvec3& vertex : vertices) {
        farthest = std::max(farthest, glm::length(vertex - point));
      }
      at(radius) = round_up((farthest / unit_ + float_epsilon) * (1.0 + 4.0 * float_epsilon));
    }
    at(axis_x) = axis.x;
    at(axis_y) = axis.y;
    at(axis_z) = axis.z;
    at(point_x) = static_cast<float>(point.x / unit_);
    at(point_y) = static_cast<float>(point.y / unit_);
    at(point_z) = static_cast<float>(point.z / unit_);
    at(squared_sine) = squared(cone.sine);
  }
  ++count_;
}

ClusterSettings cone_clusters(std::uint32_t size) {
  ClusterSettings settings;
  settings.size = size;
  return settings;
}

ClusterCones cones_of(const Mesh& mesh, const MeshFrame& frame, const TriangleClusters& clusters,
                      ConeForm form) {
  ClusterCones cones(form, frame);
  std::vector<glm::dvec4> planes;
  std::vector<glm::dvec3> vertices;
  for (std::uint32_t cluster = 0; cluster < clusters.tested; ++cluster) {
    planes.clear();
    vertices.clear();
    for (const std::uint32_t triangle : clusters.of(cluster)) {
      planes.push_back(unit_plane(mesh, frame, triangle));
      if (form == ConeForm::apex) continue;
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t vertex = mesh.triangles[triangle][corner];
        vertices.push_back(glm::dvec3(mesh.positions[vertex]) - frame.middle);
      }
    }
    cones.add(planes, vertices);
  }
  return cones;
}

ConeEye::ConeEye(const MeshEye& eye, double unit) : perspective(eye.position.w != 0.0) {
  glm::dvec3 position(eye.position);
  double error = eye.error;
  if (perspective) {
    position /= unit;
    error /= unit;
  } else {
    const double length = eye.magnitude();
    position /= length;
    error /= length;
  }
  const double reach = largest(position);
  x = static_cast<float>(position.x);
  y = static_cast<float>(position.y);
  z = static_cast<float>(position.z);
  // The eye is off by its error, and by half an epsilon in each coordinate after rounding to float;
  // that moves axis . w and sine |w| by sqrt(3) times as much each.
  limit = round_up(4.0 * (error + float_epsilon * reach));
  // Squares leave float, and nothing is known of directions without length.
  constexpr double farthest = 1e15;
  if (!(reach < farthest) || !(error < farthest)) {
    x = y = z = 0.0F;
    limit = std::numeric_limits<float>::infinity();
  }
}

void mark_cones_scalar(const ClusterCones& cones, const ConeEye& eye, std::uint64_t* back) {
  const bool has_sphere = cones.form() == ConeForm::sphere;
  std::fill_n(back, (cones.count() + 63) / 64, 0);
  for (std::uint32_t i = 0; i < cones.count(); ++i) {
    const auto value = [&](ClusterCones::Row row) {
      return has_sphere ? cones.spheres()[i / 64].row[row][i % 64]
                        : cones.apexes()[i / 64].row[row][i % 64];
    };
    float x = -eye.x;
    float y = -eye.y;
    float z = -eye.z;
    if (eye.perspective) {
      x = value(ClusterCones::point_x) - eye.x;
      y = value(ClusterCones::point_y) - eye.y;
      z = value(ClusterCones::point_z) - eye.z;
    }
    float t = value(ClusterCones::axis_x) * x + value(ClusterCones::axis_y) * y +
              value(ClusterCones::axis_z) * z - eye.limit;
    if (has_sphere && eye.perspective) t -= value(ClusterCones::radius);
    const float length = x * x + y * y + z * z;
    const bool behind = t > 0.0F && t * t >= value(ClusterCones::squared_sine) * length;
    back[i / 64] |= std::uint64_t{behind} << (i % 64);
  }
}

}  // namespace vislab::backface_culling
