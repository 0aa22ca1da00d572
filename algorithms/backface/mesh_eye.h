// The eye as a mesh sees it: what every test for back faces begins with.
#pragma once

#include <optional>

#include "common/geometry/camera.h"
#include "common/scene/scene.h"

namespace vislab::backface_culling {

/// The eye in the frame of a mesh. An affine map takes the inside of a solid to the inside of its
/// image, so tests in the mesh's own frame hold for turned, sheared, scaled and mirrored objects.
struct MeshEye {
  /// Perspective: the eye less the mesh's middle (MeshFrame::middle), w = 1. Orthographic: the
  /// direction to the viewer, w = 0, not of unit length.
  glm::dvec4 position{0.0};
  double error = 0.0;  // bound on the error of each coordinate

  /// Largest absolute coordinate.
  double magnitude() const;
};

/// Where a mesh lies in its own frame. Planes and clusters are kept relative to the middle, so that
/// meshes far from their frame's origin lose no digits.
struct MeshFrame {
  explicit MeshFrame(const Mesh& mesh);
  MeshFrame() = default;

  glm::dvec3 middle{0.0};  // of the mesh's box
  double size = 0.0;       // largest absolute coordinate relative to the middle

  /// A power of two that no coordinate relative to the middle exceeds: what floats are given in, so
  /// that they stay far from the ends of their range.
  double unit() const;
};

/// Takes the eye of a camera into the frame of a mesh that an object places by `transform`. Nothing
/// if the transform is too near to singular to tell where the eye is.
std::optional<MeshEye> eye_in_mesh(const Camera& camera, const glm::dmat4x3& transform,
                                   const MeshFrame& mesh);

/// Plane of a triangle relative to the mesh's middle, n.p + d > 0 in front, scaled so that the
/// error of n.p + d does not depend on the triangle: divided by the sum of the absolute products
/// that make up the normal (eq. 2.1), so that |n.x| + |n.y| + |n.z| <= 1. A normal that is mostly
/// cancellation is then short, and decides nothing. Zero for a triangle without area.
glm::dvec4 scaled_plane(const Mesh& mesh, const MeshFrame& frame, std::uint32_t triangle);

/// A triangle is surely seen from behind if dot(scaled_plane, eye.position), in double, is below
/// -behind_limit.
double behind_limit(const MeshEye& eye, const MeshFrame& frame);

/// The same for planes and eye rounded to float and a value summed up in float in any order:
/// (n.x e.x + n.y e.y) + (n.z e.z + d e.w). Rounded up.
float behind_limit_float(const MeshEye& eye, const MeshFrame& frame);

}  // namespace vislab::backface_culling
