// A bounding-volume hierarchy whose nodes are what is asked about and what is drawn.
//
// Idea: below some amount of geometry a question costs more than what it may save. So the walk
//   ends at units: the first nodes from the root that hold at most `leaf_triangles` triangles,
//   where an object's draw counts as `draw_triangles` triangles, and leaves of the tree, which
//   hold one object if objects are heavy. Methods that share it, and the ideal that they are
//   measured against, draw the same units.
// Guarantee: every object that is shown is in exactly one unit, or in unplaced().
// Cost: build that of the Bvh. Motion: refit, O(movers and their ancestors). Objects that come
//   or go: O(nodes) in that frame; nodes that then hold other objects than before are told.
// Limits: units of refitted trees get larger as objects mix.
// Sources: Bittner et al. 2004, 4.1; Mattausch et al. 2008, 3.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/spatial/bvh.h"
#include "common/spatial/followed_structure.h"

namespace vislab {

class QueryHierarchy {
 public:
  using NodeIndex = SpatialStructure::NodeIndex;
  static constexpr NodeIndex nowhere = 0xFFFFFFFFU;
  /// A draw costs a device about as much as so many triangles (OSMesa: 3.5 us and 0.17 us).
  static constexpr std::uint32_t draw_triangles = 20;

  explicit QueryHierarchy(std::uint32_t leaf_triangles) : leaf_triangles_(leaf_triangles) {}

  /// The scene outlives this.
  void build(const Scene& scene);
  /// Back to the scene as built. False if it is so already.
  bool reset();
  /// From ICuller::update(). changed() is then what the changes made of the nodes.
  void update(const Frame& frame, const Changes& changes);

  std::uint32_t leaf_triangles() const { return leaf_triangles_; }
  /// Boxes and children. A unit has children too, if it is an inner node of the tree: is_unit()
  /// says where a walk ends.
  const Bvh& structure() const { return followed_->structure(); }
  const SpatialNode& node(NodeIndex node) const { return structure().nodes()[node]; }
  std::size_t node_count() const { return links_.size(); }
  bool is_unit(NodeIndex node) const { return links_[node].unit; }
  /// `nowhere` of the root.
  NodeIndex parent(NodeIndex node) const { return links_[node].parent; }
  /// The objects at and below a node. Valid until reset() or update().
  std::span<const ObjectId> objects(NodeIndex node) const {
    return {objects_.data() + links_[node].first, links_[node].count};
  }
  /// Triangles of these objects.
  std::uint64_t triangles(NodeIndex node) const { return links_[node].triangles; }
  /// The same, where a draw counts as draw_triangles.
  std::uint64_t work(NodeIndex node) const {
    return links_[node].triangles + std::uint64_t{links_[node].count} * draw_triangles;
  }
  /// `nowhere` of an object that is hidden or unplaced.
  NodeIndex unit_of(ObjectId object) const { return unit_of_[object]; }
  /// Objects whose box is not valid.
  std::span<const ObjectId> unplaced() const { return structure().unplaced(); }

  /// Nodes that hold other objects since the last update(), ascending. What was known of them is
  /// void. Motion changes no node.
  std::span<const NodeIndex> changed() const { return changed_; }

  std::size_t bytes() const;

 private:
  struct Links {
    NodeIndex parent = nowhere;
    std::uint32_t first = 0, count = 0;  // in objects_
    bool unit = false;
    std::uint64_t triangles = 0;
    std::uint64_t contents = 0;  // a hash of which objects are in it, whatever their order
  };

  void link();
  void find_units();
  void find_changed();

  std::uint32_t leaf_triangles_;
  const Scene* scene_ = nullptr;
  std::optional<FollowedStructure<Bvh>> followed_;
  std::vector<Links> links_;  // by node
  std::vector<ObjectId> objects_;
  std::vector<NodeIndex> unit_of_;
  std::vector<NodeIndex> changed_;
  // Memory of link().
  std::vector<Links> before_;
  std::vector<NodeIndex> order_;
  std::vector<NodeIndex> stack_;
};

}  // namespace vislab
