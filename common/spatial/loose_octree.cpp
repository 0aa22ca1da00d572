#include "common/spatial/loose_octree.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "common/spatial/octree_cells.h"

namespace vislab {
namespace {

/// A box around the sphere.
Aabb box_around(const Sphere& sphere) {
  return enlarged({sphere.center, sphere.center}, sphere.radius);
}

/// Can a root be laid around it? Not around broken boxes, nor around spheres that leave float.
bool can_be_placed(const Aabb& box, const Sphere& sphere) {
  constexpr float limit = 1e38F;
  return box.valid() && sphere.radius < limit &&
         glm::all(glm::lessThan(glm::abs(sphere.center), glm::vec3(limit)));
}

bool holds(const Aabb& box, const Sphere& sphere) {
  const glm::dvec3 center(sphere.center);
  const glm::dvec3 radius(sphere.radius);
  return glm::all(glm::greaterThanEqual(center - radius, glm::dvec3(box.min))) &&
         glm::all(glm::lessThanEqual(center + radius, glm::dvec3(box.max)));
}

}  // namespace

void LooseOctree::build(std::span<const Aabb> boxes) {
  entries_.assign(boxes.size(), {});
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    entries_[object] = {boxes[object], circumscribed(boxes[object]), nowhere, 0};
  }
  lay_root();
}

void LooseOctree::lay_root() {
  blocks_.clear();
  runs_.clear();
  unplaced_.clear();
  valid_unplaced_ = 0;
  Aabb all;
  for (const Entry& entry : entries_) {
    if (entry.node != absent && can_be_placed(entry.box, entry.sphere)) {
      all.extend(box_around(entry.sphere));
    }
  }
  nodes_.assign(1, {});
  details_.assign(1, new_detail(root_cube(all), root, 0));
  for (ObjectId object = 0; object < entries_.size(); ++object) {
    const Entry& entry = entries_[object];
    if (entry.node == absent) continue;
    if (can_be_placed(entry.box, entry.sphere) && accepts(root, entry)) {
      attach(root, object);
    } else {
      put_outside(object);
    }
  }
  split(root);
}

void LooseOctree::insert(ObjectId object, const Aabb& box) {
  if (object >= entries_.size()) entries_.resize(std::size_t{object} + 1);
  Entry& entry = entries_[object];
  if (entry.node != absent) {
    throw std::logic_error("object " + std::to_string(object) + " is inserted twice");
  }
  entry.box = box;
  entry.sphere = circumscribed(box);
  place(object, root);
}

void LooseOctree::remove(ObjectId object) {
  Entry& entry = entry_of(object, "removed");
  if (entry.node == nowhere) {
    take_from_outside(object);
  } else {
    const NodeIndex old = entry.node;
    detach(object);
    collapse_from(old);
  }
  entry.node = absent;
}

void LooseOctree::move(ObjectId object, const Aabb& box) {
  Entry& entry = entry_of(object, "moved");
  const NodeIndex old = entry.node;
  if (old == nowhere) take_from_outside(object);
  entry.box = box;
  entry.sphere = circumscribed(box);
  if (old == nowhere) {
    place(object, root);
    return;
  }
  const bool has_octants = nodes_[old].child_count != 0;
  const bool full = details_[old].objects.count > limits_.leaf_objects;
  if (accepts(old, entry) && !((has_octants || full) && fits_an_octant(old, entry))) return;
  detach(object);
  place(object, old);
  collapse_from(old);
}

void LooseOctree::finish_changes() {
  if (valid_unplaced_ > details_[root].below) lay_root();
}

std::size_t LooseOctree::bytes() const {
  return blocks_.bytes() + runs_.bytes() + nodes_.capacity() * sizeof(SpatialNode) +
         details_.capacity() * sizeof(Detail) + entries_.capacity() * sizeof(Entry) +
         unplaced_.capacity() * sizeof(ObjectId) + pending_.capacity() * sizeof(NodeIndex) +
         gathered_.capacity() * sizeof(ObjectId);
}

SpatialStructure::NodeIndex LooseOctree::node_of(ObjectId object) const {
  if (object >= entries_.size() || entries_[object].node == nowhere) return none_id;
  return entries_[object].node;
}

LooseOctree::Entry& LooseOctree::entry_of(ObjectId object, const char* what) {
  if (object >= entries_.size() || entries_[object].node == absent) {
    throw std::logic_error("object " + std::to_string(object) + " is " + what + ", but is not in");
  }
  return entries_[object];
}

void LooseOctree::place(ObjectId object, NodeIndex from) {
  const Entry& entry = entries_[object];
  NodeIndex node = from;
  while (!accepts(node, entry)) {
    if (node == root) {
      put_outside(object);
      return;
    }
    node = details_[node].parent;
  }
  while (nodes_[node].child_count != 0 && fits_an_octant(node, entry)) {
    node = nodes_[node].first_child + octant_of(details_[node], entry);
  }
  attach(node, object);
  if (nodes_[node].child_count != 0) return;
  // Those that were here before are asked again when the leaf becomes too full; after that, only
  // who comes.
  const std::uint32_t objects = details_[node].objects.count;
  if (objects == limits_.leaf_objects + 1 ||
      (objects > limits_.leaf_objects && fits_an_octant(node, entry))) {
    split(node);
  }
}

void LooseOctree::attach(NodeIndex node, ObjectId object) {
  add_to_run(node, object);
  count(node, 1);
}

void LooseOctree::detach(ObjectId object) {
  take_from_run(object);
  count(entries_[object].node, -1);
}

void LooseOctree::add_to_run(NodeIndex node, ObjectId object) {
  entries_[object].node = node;
  entries_[object].position = details_[node].objects.count;
  runs_.push(details_[node].objects, object);
}

void LooseOctree::take_from_run(ObjectId object) {
  const Entry& entry = entries_[object];
  ObjectRuns::Run& run = details_[entry.node].objects;
  entries_[runs_.of(run).back()].position = entry.position;
  runs_.take_out(run, entry.position);
}

void LooseOctree::put_outside(ObjectId object) {
  Entry& entry = entries_[object];
  entry.node = nowhere;
  entry.position = static_cast<std::uint32_t>(unplaced_.size());
  unplaced_.push_back(object);
  if (can_be_placed(entry.box, entry.sphere)) ++valid_unplaced_;
}

void LooseOctree::take_from_outside(ObjectId object) {
  const Entry& entry = entries_[object];
  unplaced_[entry.position] = unplaced_.back();
  entries_[unplaced_.back()].position = entry.position;
  unplaced_.pop_back();
  if (can_be_placed(entry.box, entry.sphere)) --valid_unplaced_;
}

void LooseOctree::count(NodeIndex node, int change) {
  for (;;) {
    Detail& detail = details_[node];
    detail.below += static_cast<std::uint32_t>(change);
    nodes_[node].box = detail.below > 0 ? detail.loose : Aabb{};
    if (node == root) return;
    node = detail.parent;
  }
}

bool LooseOctree::accepts(NodeIndex node, const Entry& entry) const {
  const Aabb& loose = details_[node].loose;
  return entry.box.valid() && holds(loose, entry.sphere) && loose.contains(entry.box);
}

std::uint32_t LooseOctree::octant_of(const Detail& detail, const Entry& entry) const {
  const glm::bvec3 upper = glm::greaterThanEqual(entry.sphere.center, middle_of(detail.cell));
  return (upper.x ? 1U : 0U) | (upper.y ? 2U : 0U) | (upper.z ? 4U : 0U);
}

bool LooseOctree::fits_an_octant(NodeIndex node, const Entry& entry) const {
  const Detail& detail = details_[node];
  if (!detail.divisible) return false;
  const std::uint32_t i = octant_of(detail, entry);
  if (nodes_[node].child_count != 0) return accepts(nodes_[node].first_child + i, entry);
  const Aabb loose = enlarged(octant(detail.cell, i), limits_.overlap_m);
  return holds(loose, entry.sphere) && loose.contains(entry.box);
}

LooseOctree::Detail LooseOctree::new_detail(const Aabb& cell, NodeIndex parent, int depth) const {
  Detail detail;
  detail.cell = cell;
  detail.parent = parent;
  detail.depth = depth;
  if (cell.empty()) return detail;
  detail.loose = enlarged(cell, limits_.overlap_m);
  detail.divisible =
      depth < limits_.depth && can_halve(cell) && cell.half_size().x >= limits_.least_edge_m;
  return detail;
}

void LooseOctree::split(NodeIndex top) {
  pending_.assign(1, top);
  while (!pending_.empty()) {
    const NodeIndex node = pending_.back();
    pending_.pop_back();
    if (details_[node].objects.count <= limits_.leaf_objects) continue;
    gathered_.clear();
    for (const ObjectId object : runs_.of(details_[node].objects)) {
      if (fits_an_octant(node, entries_[object])) gathered_.push_back(object);
    }
    if (gathered_.empty()) continue;

    const NodeIndex first = blocks_.take();
    if (blocks_.size() > nodes_.size()) {
      nodes_.resize(blocks_.size());
      details_.resize(blocks_.size());
    }
    for (unsigned i = 0; i < 8; ++i) {
      nodes_[first + i] = {};
      details_[first + i] =
          new_detail(octant(details_[node].cell, i), node, details_[node].depth + 1);
    }
    nodes_[node].first_child = first;
    nodes_[node].child_count = 8;
    for (const ObjectId object : gathered_) {
      take_from_run(object);
      const NodeIndex child = first + octant_of(details_[node], entries_[object]);
      add_to_run(child, object);
      ++details_[child].below;
      nodes_[child].box = details_[child].loose;
    }
    for (unsigned i = 0; i < 8; ++i) pending_.push_back(first + i);
  }
}

void LooseOctree::collapse_from(NodeIndex node) {
  NodeIndex top = none_id;
  while (details_[node].below <= limits_.leaf_objects) {
    top = node;
    if (node == root) break;
    node = details_[node].parent;
  }
  if (top == none_id || nodes_[top].child_count == 0) return;
  gathered_.clear();
  give_back_octants(top);
  for (const ObjectId object : gathered_) add_to_run(top, object);
}

void LooseOctree::give_back_octants(NodeIndex node) {
  if (nodes_[node].child_count == 0) return;
  const NodeIndex first = nodes_[node].first_child;
  for (NodeIndex child = first; child < first + 8; ++child) {
    const std::span<const ObjectId> objects = runs_.of(details_[child].objects);
    gathered_.insert(gathered_.end(), objects.begin(), objects.end());
    runs_.release(details_[child].objects);
    give_back_octants(child);
  }
  blocks_.give_back(first);
  nodes_[node].first_child = 0;
  nodes_[node].child_count = 0;
}

}  // namespace vislab
