#include "common/spatial/spatial_structure.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace vislab {
namespace {

using NodeIndex = SpatialStructure::NodeIndex;

[[noreturn]] void broken(const std::string& what) {
  throw std::logic_error("spatial structure: " + what);
}

std::string named(ObjectId object) { return "object " + std::to_string(object); }
std::string node_named(NodeIndex node) { return "node " + std::to_string(node); }

Aabb common_part(const Aabb& a, const Aabb& b) {
  Aabb part;
  part.min = glm::max(a.min, b.min);
  part.max = glm::min(a.max, b.max);
  return part;
}

/// Does the part fill some of the box? A touch (no extent where the box has some) does not count.
bool fills(const Aabb& part, const Aabb& box) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(part.min[axis] <= part.max[axis])) return false;
    if (part.min[axis] == part.max[axis] && box.min[axis] < box.max[axis]) return false;
  }
  return true;
}

/// Do the boxes hold all of `box` together? What sticks out of the first is looked for in the
/// others, slab by slab.
bool hold_together(std::span<const Aabb> boxes, const Aabb& box) {
  std::vector<Aabb> parts;  // what of `box` each holds
  for (const Aabb& other : boxes) {
    const Aabb part = common_part(other, box);
    if (part == box) return true;
    if (fills(part, box)) parts.push_back(part);
  }
  if (parts.empty()) return false;
  const Aabb first = parts.front();
  const std::span<const Aabb> others = std::span(parts).subspan(1);
  Aabb rest = box;
  for (int axis = 0; axis < 3; ++axis) {
    if (rest.min[axis] < first.min[axis]) {
      Aabb slab = rest;
      slab.max[axis] = first.min[axis];
      if (!hold_together(others, slab)) return false;
    }
    if (first.max[axis] < rest.max[axis]) {
      Aabb slab = rest;
      slab.min[axis] = first.max[axis];
      if (!hold_together(others, slab)) return false;
    }
    rest.min[axis] = first.min[axis];
    rest.max[axis] = first.max[axis];
  }
  return true;
}

class Audit {
 public:
  Audit(const SpatialStructure& structure, std::span<const Aabb> boxes)
      : structure_(structure),
        boxes_(boxes),
        times_found_(boxes.size()),
        reached_(structure.nodes().size()) {
    if (structure.repeats_objects()) places_.resize(boxes.size());
  }

  void run(std::size_t object_count) {
    if (structure_.nodes().empty()) broken("there is no root");
    visit(SpatialStructure::root);
    for (const ObjectId object : structure_.unplaced()) {
      find(object);
      if (times_found_[object] != 1) broken(named(object) + " is unplaced, and elsewhere too");
    }
    const auto found = static_cast<std::size_t>(
        std::ranges::count_if(times_found_, [](std::uint32_t times) { return times > 0; }));
    if (found != object_count) {
      broken(std::to_string(found) + " objects are found, but " + std::to_string(object_count) +
             " are in");
    }
    for (ObjectId object = 0; object < places_.size(); ++object) {
      if (!places_[object].empty() && !hold_together(places_[object], boxes_[object])) {
        broken("the nodes of " + named(object) + " do not hold its box together");
      }
    }
  }

 private:
  void visit(NodeIndex node) {
    const std::span<const SpatialNode> nodes = structure_.nodes();
    if (node >= nodes.size()) broken(node_named(node) + " does not exist, but is a child");
    if (reached_[node]) broken(node_named(node) + " is reached twice");
    reached_[node] = true;
    ancestors_.push_back(node);
    const std::size_t first_found = order_.size();
    for (const ObjectId object : structure_.objects_at(node)) find_at(node, object);
    for (std::uint32_t i = 0; i < nodes[node].child_count; ++i) visit(nodes[node].first_child + i);
    ancestors_.pop_back();

    const std::span<const ObjectId> run = structure_.objects_below(node);
    if (run.empty()) return;
    std::vector<ObjectId> below(order_.begin() + static_cast<std::ptrdiff_t>(first_found),
                                order_.end());
    std::vector<ObjectId> said(run.begin(), run.end());
    std::ranges::sort(below);
    std::ranges::sort(said);
    if (below != said) broken("the run of " + node_named(node) + " is not what lies below it");
  }

  void find(ObjectId object) {
    if (object >= boxes_.size()) broken(named(object) + " is in, but has no box");
    ++times_found_[object];
  }

  void find_at(NodeIndex node, ObjectId object) {
    find(object);
    order_.push_back(object);
    const Aabb& box = boxes_[object];
    if (!box.valid()) broken(named(object) + " has no valid box, but is at " + node_named(node));
    const bool repeats = structure_.repeats_objects();
    if (times_found_[object] > 1 && !repeats) broken(named(object) + " is at several nodes");
    const std::span<const SpatialNode> nodes = structure_.nodes();
    const Aabb part = repeats ? common_part(box, nodes[node].box) : box;
    if (part.empty()) broken(named(object) + " does not touch " + node_named(node));
    for (const NodeIndex ancestor : ancestors_) {
      if (!nodes[ancestor].box.contains(part)) {
        broken(node_named(ancestor) + " does not hold the box of " + named(object));
      }
    }
    if (repeats) places_[object].push_back(nodes[node].box);
  }

  const SpatialStructure& structure_;
  std::span<const Aabb> boxes_;
  std::vector<std::uint32_t> times_found_;  // by object
  std::vector<std::vector<Aabb>> places_;   // by object: the nodes it is at, if it is repeated
  std::vector<bool> reached_;               // by node
  std::vector<NodeIndex> ancestors_;        // from the root to the node that is visited
  std::vector<ObjectId> order_;             // as found
};

}  // namespace

void SpatialStructure::audit(std::span<const Aabb> boxes, std::size_t object_count) const {
  Audit(*this, boxes).run(object_count);
}

}  // namespace vislab
