#include "algorithms/backface/mesh_eye.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/backface/magnitudes.h"

namespace vislab::backface_culling {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double float_epsilon = std::numeric_limits<float>::epsilon();

}  // namespace

double MeshEye::magnitude() const { return largest(glm::dvec3(position)); }

MeshFrame::MeshFrame(const Mesh& mesh)
    : middle(mesh.bounds.center()),
      // The middle is rounded, and so may be the differences.
      size((1.0 + 4.0 * epsilon) * std::max(largest(glm::dvec3(mesh.bounds.min) - middle),
                                            largest(glm::dvec3(mesh.bounds.max) - middle))) {}

double MeshFrame::unit() const { return power_of_two_from(size); }

std::optional<MeshEye> eye_in_mesh(const Camera& camera, const glm::dmat4x3& transform,
                                   const MeshFrame& mesh) {
  const glm::dmat3 linear(transform[0], transform[1], transform[2]);
  const glm::dmat3 inverse = glm::inverse(linear);
  // With |linear * inverse - 1| < 1/2 the true inverse is at most twice the computed one.
  if (!(row_sum(linear * inverse - glm::dmat3(1.0)) < 0.5)) return std::nullopt;
  const bool perspective = camera.lens.projection == Projection::perspective;
  const glm::dvec3 world = perspective ? camera.pose.eye - transform[3] : camera.pose.back;
  const glm::dvec3 world_size =
      perspective ? glm::abs(camera.pose.eye) + glm::abs(transform[3]) : glm::abs(world);
  const glm::dvec3 local = inverse * world;
  // What is left over when the eye is taken back to the world bounds how far off it is.
  const glm::dvec3 rest = glm::abs(linear * local - world);
  const glm::dmat3 sizes(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
  const glm::dvec3 off = rest + 8.0 * epsilon * (sizes * glm::abs(local) + world_size);
  MeshEye eye;
  eye.error = 2.0 * row_sum(inverse) * largest(off);
  if (perspective) {
    eye.position = glm::dvec4(local - mesh.middle, 1.0);
    eye.error += epsilon * (largest(local) + largest(mesh.middle));
  } else {
    eye.position = glm::dvec4(local, 0.0);
  }
  if (!std::isfinite(eye.error)) return std::nullopt;
  return eye;
}

glm::dvec4 scaled_plane(const Mesh& mesh, const MeshFrame& frame, std::uint32_t triangle) {
  const glm::uvec3& corners = mesh.triangles[triangle];
  const glm::dvec3 a(mesh.positions[corners.x]);
  const glm::dvec3 u = glm::dvec3(mesh.positions[corners.y]) - a;
  const glm::dvec3 v = glm::dvec3(mesh.positions[corners.z]) - a;
  const glm::dvec3 forward(u.y * v.z, u.z * v.x, u.x * v.y);
  const glm::dvec3 backward(u.z * v.y, u.x * v.z, u.y * v.x);
  const glm::dvec3 sizes = glm::abs(forward) + glm::abs(backward);
  const double size = sizes.x + sizes.y + sizes.z;
  if (!(size > 0.0)) return glm::dvec4(0.0);
  const glm::dvec3 normal = forward - backward;
  return {normal / size, -glm::dot(normal, a - frame.middle) / size};
}

double behind_limit(const MeshEye& eye, const MeshFrame& frame) {
  // With scaled planes each of the normal's parts carries at most 4 roundings, d at most 9, and the
  // value 6 more, each of half an epsilon times |eye| + |mesh|; more than twice that is taken.
  return 20.0 * epsilon * (eye.magnitude() + eye.position.w * frame.size) + eye.error;
}

float behind_limit_float(const MeshEye& eye, const MeshFrame& frame) {
  // Two roundings to float and at most four of the products and sums, each of half an epsilon
  // times |eye| + |mesh|; more than twice that is taken, which covers the double's too.
  const double reach = eye.magnitude() + eye.position.w * frame.size;
  return static_cast<float>((8.0 * float_epsilon * reach + eye.error) * (1.0 + 1e-6));
}

}  // namespace vislab::backface_culling
