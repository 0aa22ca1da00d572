#include "algorithms/backface/cone_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vislab::backface_culling {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// In terms of the way to the apex: the planes are off by their error; what is computed, the apexes
/// included, by some roundings of double.
constexpr double sine_margin = 3.0 * plane_error;
/// Of the apexes, in terms of the mesh and of their own lengths.
constexpr double apex_spare = 3.0 * plane_error;
/// More than a computed depth may be wrong by, in terms of the way to the apex.
constexpr double depth_error = 32.0 * epsilon;

}  // namespace

TreeEye::TreeEye(const MeshEye& eye) : position(eye.position), perspective(eye.position.w != 0.0) {
  double error = eye.error;
  if (!perspective) {
    const double length = glm::length(position);
    position /= length;
    error = error / length + 4.0 * epsilon;
  }
  // The eye may be off by sqrt(3) times that, and a depth by twice as much.
  margin = 4.0 * error;
}

double TreeEye::way_to(const TreeEye& other) const {
  const double moved = glm::length(position - other.position);
  const double change = std::abs(margin - other.margin);
  if (moved == 0.0 && change == 0.0 && position == other.position) return 0.0;
  const double way = (moved + change) * (1.0 + 8.0 * epsilon);
  return std::max(way, std::numeric_limits<double>::min());
}

ConeTree::ConeTree(const Mesh& mesh, const MeshFrame& frame, const ClusterSettings& settings)
    : ConeTree(mesh, frame, make_clusters(mesh, frame, settings)) {}

ConeTree::ConeTree(const Mesh& mesh, const MeshFrame& frame, const TriangleClusters& clusters)
    : triangle_count_(mesh.triangles.size()), runs_(clusters) {
  std::vector<glm::dvec4> planes;
  planes.reserve(clusters.order.size());
  for (const std::uint32_t triangle : clusters.order) {
    planes.push_back(unit_plane(mesh, frame, triangle));
  }
  add_cones(clusters, planes, frame.size);
}

void ConeTree::add_cones(const TriangleClusters& clusters, std::span<const glm::dvec4> planes,
                         double reach) {
  nodes_.resize(clusters.nodes.size());
  // Clusters are met from the last to the first; children before their parents.
  std::uint32_t cluster = clusters.tested;
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    const TriangleClusters::Node& made = clusters.nodes[i];
    const std::span<const glm::dvec4> below = planes.subspan(made.first, made.end - made.first);
    Node& node = nodes_[i];
    node.left = made.left;
    node.right = made.right;
    if (made.is_cluster()) {
      node.end = cluster;
      node.first = --cluster;
      node.cone = smallest_cone(below);
    } else {
      node.first = nodes_[made.left].first;
      node.end = nodes_[made.right].end;
      const NormalCone& left = nodes_[made.left].cone;
      const NormalCone& right = nodes_[made.right].cone;
      if (left.exists() && right.exists()) {
        node.cone = cone_around(merged_axis(left, right), below);
      }
    }
    if (!node.cone.exists()) continue;
    node.back_apex = apex_behind(below, node.cone.axis, reach, apex_spare);
    node.front_apex = apex_in_front(below, node.cone.axis, reach, apex_spare);
    node.cone.sine += sine_margin;
  }
}

ConeTree::Verdict ConeTree::verdict(const Node& node, const TreeEye& eye) {
  constexpr double for_ever = std::numeric_limits<double>::infinity();
  if (!node.cone.exists()) return {Facing::mixed, for_ever};
  double behind = 0.0;  // how deep the eye is in the cone from behind
  double before = 0.0;
  double farthest = 1.0;  // way to an apex
  const double sine = node.cone.sine;
  if (eye.perspective) {
    const glm::dvec3 to_back = node.back_apex - eye.position;
    const glm::dvec3 from_front = eye.position - node.front_apex;
    const double back_length = glm::length(to_back);
    const double front_length = glm::length(from_front);
    behind = glm::dot(node.cone.axis, to_back) - sine * back_length;
    before = glm::dot(node.cone.axis, from_front) - sine * front_length;
    farthest = std::max(back_length, front_length);
  } else {
    const double along = glm::dot(node.cone.axis, eye.position);
    behind = -along - sine;
    before = along - sine;
  }
  behind -= eye.margin;
  before -= eye.margin;
  const Facing facing = behind > 0.0 ? Facing::back : before > 0.0 ? Facing::front : Facing::mixed;
  const double depth = facing == Facing::back    ? behind
                       : facing == Facing::front ? before
                                                 : std::min(-behind, -before);
  // Both this depth and that of another eye are computed with an error.
  const double sure = depth - 2.0 * depth_error * farthest;
  return {facing, std::max(0.0, sure / ((1.0 + sine) * (1.0 + depth_error)))};
}

}  // namespace vislab::backface_culling
