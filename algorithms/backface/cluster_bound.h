// What is kept of a cluster of triangles to test them as one (Johannsen and Carter).
//
// Idea: with n and m the least and greatest coordinates of the normals and d the least of
//   n_i.(p_i - c), every n_i.(e - p_i) is at most if(e - c; n, m).(e - c) - d, where if() takes m
//   along axes on which e - c is positive, else n. At most zero: all triangles are seen from
//   behind.
// Guarantee: all that is rounded is rounded outward, so that this holds for the triangles' exact
//   planes.
// Limits: eight planes stand for all; the test is tight only for normals that fill a box.
// Sources: Johannsen and Carter 1998; Zachmann slides 20-26. The slides call n.(e - p) <= 0 "back
//   face" here; the lab keeps a triangle at 0. The slides' rule for joining clusters, d = min(d1,
//   d2), holds for a common c only: d has to be made anew from the planes for another c.
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <span>

#include "algorithms/backface/mesh_eye.h"

namespace vislab::backface_culling {

/// Where the local origin c of a cluster lies.
enum class Origin {
  mesh,    // at the origin of the mesh's own frame
  centre,  // in the middle of the box around the cluster
  best     // there or at a corner of the box, where d is greatest
};

/// In the mesh's frame, relative to its middle, lengths in terms of MeshFrame::unit(). The default
/// faces neither way.
struct ClusterBound {
  glm::vec3 origin{0.0F};                                // c, exact
  glm::vec3 low{0.0F};                                   // n
  glm::vec3 high{0.0F};                                  // m
  float back = -std::numeric_limits<float>::infinity();  // d: least n_i.(p_i - c)
  float front = std::numeric_limits<float>::infinity();  // greatest n_i.(p_i - c)
};

/// The bound of triangles with these unit planes (unit_plane) in this box, which is relative to the
/// mesh's middle, in the mesh's own lengths. Without planes, or with an origin so far away that
/// floats cannot tell, the default. O(planes).
ClusterBound bound_of(std::span<const glm::dvec4> planes, const Aabb& box, const MeshFrame& frame,
                      Origin origin);

/// The eye rounded to float, as bounds are tested with it: in their unit, or a direction of length
/// about 1.
struct ClusterEye {
  glm::vec3 position{0.0F};
  bool perspective = true;
  /// A value below -limit is below zero for the exact eye and planes. Infinite, at the origin, for
  /// eyes so far away that floats cannot tell: no cluster then faces either way.
  float limit = 0.0F;
};

/// `reach` is the largest absolute coordinate of all clusters' origins, in their unit.
ClusterEye cluster_eye(const MeshEye& eye, const MeshFrame& frame, double reach);

enum class ClusterFacing { mixed, back, front };

/// The test in its scalar form: the reference of the kernels.
ClusterFacing facing_of(const ClusterBound& bound, const ClusterEye& eye);

}  // namespace vislab::backface_culling
