// Cones of normals: from where a group of triangles is surely seen from behind, or from the front.
//
// Idea: let all unit normals of a group lie within the angle a of an axis, and let an apex lie
//   behind all of its planes. Where the way from the eye to the apex makes an angle below 90° - a
//   with the axis,
//     axis . (apex - eye) >= sin a |apex - eye|,
//   every plane has the eye behind it: going on from a point behind all planes in a direction that
//   no normal leans to leads farther behind. From an apex in front of all planes the same holds
//   with the direction turned round, and tells the eyes that see all of the group from the front.
// Cost: O(planes) expected for the axis and for the apex.
// Limits: a group whose normals do not fit into an open half space has no cone. Of the region from
//   which a group is seen from behind, an intersection of half spaces, it is a round part.
// Sources: Shirman and Abi-Ezzi 1993, The Cone of Normals Technique for Fast Processing of Curved
//   Patches; Kowalka 2016, 2.2.2. Where the apex is put is this lab's: the highest point of the
//   intersection of half spaces.
#pragma once

#include <glm/glm.hpp>
#include <span>

namespace vislab::backface_culling {

/// Planes are n.p + d with |n| = 1, relative to any point (unit_plane).
struct NormalCone {
  glm::dvec3 axis{0.0};  // of unit length, or zero: there is no cone
  double sine = 1.0;     // of the greatest angle between the axis and a normal, below 1

  bool exists() const { return sine < 1.0; }
};

/// The axis of the smallest cone around the normals, as a cone that holds them (to the rounding of
/// double: users add a margin). None as cone_around.
NormalCone smallest_cone(std::span<const glm::dvec4> planes);

/// A cone with the given axis, of any length but zero, around the normals. None if a normal is
/// farther than 87 degrees from the axis: hardly any eye would be in the cone.
NormalCone cone_around(const glm::dvec3& axis, std::span<const glm::dvec4> planes);

/// The axis of the smallest cone around two cones.
glm::dvec3 merged_axis(const NormalCone& a, const NormalCone& b);

/// A point behind all planes, as high along the axis as can be found, at most some hundred times
/// `reach` from 0, the measure of how far the group is. The cone around the axis must exist. The
/// point is behind all planes by at least spare * (reach + |point|).
glm::dvec3 apex_behind(std::span<const glm::dvec4> planes, const glm::dvec3& axis, double reach,
                       double spare);

/// The same in front of all planes, as low along the axis as can be found.
glm::dvec3 apex_in_front(std::span<const glm::dvec4> planes, const glm::dvec3& axis, double reach,
                         double spare);

}  // namespace vislab::backface_culling
