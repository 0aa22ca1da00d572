#include "common/scene/quake_leaves.h"

#include <algorithm>
#include <utility>

namespace vislab {
namespace {

constexpr double margin_m = 1.0;

/// Nodes are named as in the tree, >= 0, leaf l is -(l + 1).
constexpr std::int32_t outside_of_all = std::numeric_limits<std::int32_t>::min();

class LeafShaper {
 public:
  LeafShaper(const QuakeWorld& world, const Aabb& bounds)
      : world_(world),
        faces_of_node_(world.nodes.size()),
        faces_of_leaf_(world.leaves.size()),
        middle_(bounds.center()),
        reach_(2.0 * (glm::length(bounds.half_size()) + margin_m)) {
    add_box(bounds);
  }

  LeafShapes run() {
    // A node's faces are divided when all of its ancestors' are.
    std::vector<std::int32_t> waiting{0};
    while (!waiting.empty()) {
      const std::int32_t node = waiting.back();
      waiting.pop_back();
      divide(node);
      for (const std::int32_t child : {children(node).second, children(node).first}) {
        if (child >= 0) waiting.push_back(child);
      }
    }
    LeafShapes shapes;
    shapes.faces_of_leaf.resize(world_.leaves.size());
    for (Face& face : faces_) {
      if (face.polygon.empty()) continue;
      const auto id = static_cast<std::uint32_t>(shapes.faces.size());
      const std::uint32_t front = leaf_of(face.side[0]);
      const std::uint32_t back = leaf_of(face.side[1]);
      for (const std::uint32_t leaf : {front, back}) {
        if (leaf != none_id) shapes.faces_of_leaf[leaf].push_back(id);
      }
      shapes.faces.push_back({std::move(face.polygon), face.plane, front, back});
    }
    return shapes;
  }

 private:
  struct Face {
    ConvexPolygon polygon;
    Plane plane;
    std::int32_t side[2] = {outside_of_all, outside_of_all};  // in front, behind
  };

  static std::uint32_t leaf_of(std::int32_t side) {
    return side == outside_of_all ? none_id : static_cast<std::uint32_t>(-(side + 1));
  }

  std::pair<std::int32_t, std::int32_t> children(std::int32_t node) const {
    const QuakeNode& record = world_.nodes[static_cast<std::size_t>(node)];
    return {record.front, record.back};
  }

  std::vector<std::uint32_t>& faces_at(std::int32_t side) {
    return side >= 0 ? faces_of_node_[static_cast<std::size_t>(side)]
                     : faces_of_leaf_[static_cast<std::size_t>(-(side + 1))];
  }

  void add(Face face) {
    const auto id = static_cast<std::uint32_t>(faces_.size());
    for (const std::int32_t side : face.side) {
      if (side != outside_of_all) faces_at(side).push_back(id);
    }
    faces_.push_back(std::move(face));
  }

  void add_box(const Aabb& bounds) {
    std::vector<Plane> planes;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 normal(0.0);
      normal[axis] = 1.0;
      planes.push_back({normal, margin_m - bounds.min[axis]});
      planes.push_back({-normal, margin_m + bounds.max[axis]});
    }
    for (const Plane& plane : planes) {
      ConvexPolygon polygon = square_on(plane, middle_, reach_);
      for (const Plane& other : planes) {
        if (other.normal != plane.normal && other.normal != -plane.normal) {
          polygon = divided(polygon, other, leaf_tolerance_m).inside;
        }
      }
      add({std::move(polygon), plane, {0, outside_of_all}});
    }
  }

  void divide(std::int32_t node) {
    const auto [front, back] = children(node);
    const Plane plane = world_.planes[world_.nodes[static_cast<std::size_t>(node)].plane];
    const std::vector<std::uint32_t> faces = std::move(faces_at(node));
    if (faces.empty()) return;  // no point of the world comes here
    ConvexPolygon section = square_on(plane, middle_, reach_);
    for (const std::uint32_t id : faces) {
      if (section.empty()) break;
      PolygonHalves halves = divided(section, faces_[id].plane, leaf_tolerance_m);
      section = std::move(faces_[id].side[0] == node ? halves.inside : halves.outside);
    }
    for (const std::uint32_t id : faces) hand_down(id, node, plane, front, back);
    if (!section.empty()) add({std::move(section), plane, {front, back}});
  }

  void hand_down(std::uint32_t id, std::int32_t node, const Plane& plane, std::int32_t front,
                 std::int32_t back) {
    const std::size_t here = faces_[id].side[0] == node ? 0 : 1;
    PolygonHalves halves = divided(faces_[id].polygon, plane, leaf_tolerance_m);
    if (halves.inside.empty() && halves.outside.empty()) {
      // It lies in the plane: the node is on one side of both.
      const bool same = glm::dot(faces_[id].plane.normal, plane.normal) > 0.0;
      (same == (here == 0) ? halves.inside : halves.outside) = faces_[id].polygon;
    }
    if (halves.inside.empty() || halves.outside.empty()) {
      const std::int32_t child = halves.outside.empty() ? front : back;
      faces_[id].side[here] = child;
      faces_at(child).push_back(id);
      return;
    }
    Face behind = faces_[id];
    behind.polygon = std::move(halves.outside);
    behind.side[here] = back;
    faces_[id].polygon = std::move(halves.inside);
    faces_[id].side[here] = front;
    faces_at(front).push_back(id);
    add(std::move(behind));
  }

  const QuakeWorld& world_;
  std::vector<Face> faces_;
  std::vector<std::vector<std::uint32_t>> faces_of_node_;
  std::vector<std::vector<std::uint32_t>> faces_of_leaf_;
  glm::dvec3 middle_;
  double reach_;
};

}  // namespace

LeafShapes shapes_of_leaves(const QuakeWorld& world, const Aabb& bounds) {
  return LeafShaper(world, bounds).run();
}

}  // namespace vislab
