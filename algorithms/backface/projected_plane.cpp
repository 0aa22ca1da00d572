// backface.projected_plane: leaves out triangles whose plane, taken to clip space, has a z of the
// wrong sign: the textbook's trick.
//
// Idea: planes are rows. If a matrix M takes points to clip space (projection times view times the
//   object's transform), it takes the plane p to p M^-1. After projection the viewer is at infinity
//   on the axis of z, so that a plane's value there is the z of p M^-1 alone, up to a sign that is
//   the same for all planes: only that one component need be transformed, four products a triangle
//   instead of sixteen. OpenGL's clip space has the viewer at (0, 0, -1, 0), the textbook's at
//   (0, 0, 1, 0).
//   What is multiplied is p times the third column of M^-1, c = M^-1 (0, 0, 1, 0): the point of the
//   mesh's frame that projection takes to infinity along z. In perspective that is the eye itself:
//   the camera's frame has it at (0, 0, 0, 1), and the projection takes that to (0, 0, -k, 0), k =
//   2 far near / (far - near), or 2 near without a far plane. So c = -(eye, 1) / k. An orthographic
//   projection takes the direction to the viewer (0, 0, 1, 0) to (0, 0, -2 / (far - near), 0), and
//   c is that direction, its w exactly 0. The trick is the plane equation of backface.polygon, and
//   the z of the *view-space* normal, which takes the view direction for the eye's, is another
//   thing (backface.wrong[error=view_direction]). Of the inverse the cofactors are enough: c is the
//   generalised cross product of M's rows x, y and w, the point where all three vanish. The row z,
//   the depth range, has no say.
// Guarantee: conservative, as backface.polygon: solid meshes only (unless open=cull), the same
//   margin, edge-on triangles and objects around the eye are kept. How far c is off, with all the
//   rounding of M and its cofactors, is told by the eye as it is found without a projection
//   (mesh_eye.h), once an object; where c is off by half its size, the object is kept whole.
// Cost: O(candidate triangles): one plane test each; two products of 4 x 4 matrices and twelve
//   cofactors an object. Memory: 16 bytes a triangle of a mesh.
// Limits: as backface.polygon. Far from the origin of the world the matrix loses digits, which
//   backface.polygon, which subtracts positions first, does not: it keeps more triangles that are
//   nearly edge-on.
// Source: textbook chapter 17, Culling (in German), 17.1.

#include <algorithm>

#include "algorithms/backface/plane_culler.h"
#include "common/culler/registry.h"

namespace vislab {
namespace {

using namespace backface_culling;

CullerInfo describe() {
  CullerInfo info;
  info.name = "backface.projected_plane";
  info.family = "backface";
  info.summary =
      "Leaves out the triangles of solid meshes whose plane has the wrong sign of z after "
      "projection; only that component is transformed.";
  info.guarantee = Guarantee::conservative;
  info.repeatability = Repeatability::stateless;
  info.granularity = Granularity::triangle;
  info.culls = Culls::back_faces;
  info.space = Space::object;
  info.stage = PipelineStage::geometry;
  info.parameters = {open_parameter()};
  info.cost =
      "O(candidate triangles): one plane test each, and two products of 4 x 4 matrices an object";
  info.limits =
      "As backface.polygon, whose test it is in other words; far from the origin its matrices lose "
      "digits, and it keeps more of what is nearly edge-on.";
  info.sources = {
      "Textbook chapter 17, Culling (in German), 17.1: the z of the plane in normalised projection "
      "coordinates"};
  return info;
}

glm::dmat4 matrix_of(const glm::dmat4x3& transform) {
  return {glm::dvec4(transform[0], 0.0), glm::dvec4(transform[1], 0.0),
          glm::dvec4(transform[2], 0.0), glm::dvec4(transform[3], 1.0)};
}

/// The third column of the inverse, times the determinant.
glm::dvec4 third_of_inverse(const glm::dmat4& m) {
  const auto row = [&](int i) { return glm::dvec4(m[0][i], m[1][i], m[2][i], m[3][i]); };
  const glm::dvec4 x = row(0);
  const glm::dvec4 y = row(1);
  const glm::dvec4 w = row(3);
  const auto minor = [&](int i, int j, int k) {
    return x[i] * (y[j] * w[k] - y[k] * w[j]) - x[j] * (y[i] * w[k] - y[k] * w[i]) +
           x[k] * (y[i] * w[j] - y[j] * w[i]);
  };
  return {minor(1, 2, 3), -minor(0, 2, 3), minor(0, 1, 3), -minor(0, 1, 2)};
}

/// The eye that the matrix tells of, in the mesh's frame, less its middle, with w = 1 or 0. Nothing
/// if the matrix does not tell. `known` is the same from mesh_eye.h.
std::optional<MeshEye> projected_eye(const Camera& camera, const glm::dmat4x3& transform,
                                     const MeshFrame& mesh, const MeshEye& known) {
  // With the mesh's middle as the origin: planes are relative to it.
  glm::dmat4x3 from_middle = transform;
  from_middle[3] = transform * glm::dvec4(mesh.middle, 1.0);
  glm::dvec4 c = third_of_inverse(camera.projection() * camera.view() * matrix_of(from_middle));
  // The viewer is before the plane, not behind it: w = 1, or in the direction of what is known.
  const glm::dvec3 truth(known.position);
  if (camera.lens.projection == Projection::perspective) {
    c /= c.w;
  } else {
    c = glm::dvec4(glm::dvec3(c) * (glm::dot(truth, truth) / glm::dot(glm::dvec3(c), truth)), 0.0);
  }
  MeshEye eye;
  eye.position = c;
  const glm::dvec3 off = glm::abs(glm::dvec3(c) - truth);
  eye.error = known.error + 2.0 * std::max({off.x, off.y, off.z});
  if (!(eye.error < 0.5 * (eye.magnitude() + eye.position.w * mesh.size))) return std::nullopt;
  return eye;
}

class ProjectedPlane : public PlaneCuller {
 public:
  explicit ProjectedPlane(bool cull_open) : PlaneCuller(describe(), cull_open) {}

 protected:
  std::optional<PlaneTest> find_eye(const ObjectView& view, const MeshFrame& frame) override {
    const std::optional<MeshEye> eye = projected_eye(
        view.frame.camera, view.frame.objects.transforms[view.object], frame, view.eye);
    if (!eye) return std::nullopt;
    return plane_test(*eye, frame);
  }
};

}  // namespace

namespace cullers {

CullerEntry backface_projected_plane() {
  return {describe(), [](const ParameterValues& values) {
            return std::make_unique<ProjectedPlane>(culls_open(values));
          }};
}

}  // namespace cullers
}  // namespace vislab
