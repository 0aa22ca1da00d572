#include "common/spatial/leaf_octree.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "common/spatial/octree_cells.h"

namespace vislab {
namespace {

/// The octants of a cell halved at `middle` that a box touches which touches the cell: by axis, the
/// lower and the upper half. Boxes that only touch a plane are in both its halves.
struct TouchedHalves {
  TouchedHalves(const Aabb& box, const glm::vec3& middle)
      : lower(glm::lessThanEqual(box.min, middle)), upper(glm::greaterThanEqual(box.max, middle)) {}

  bool octant(unsigned i) const {
    return ((i & 1U) != 0 ? upper.x : lower.x) && ((i & 2U) != 0 ? upper.y : lower.y) &&
           ((i & 4U) != 0 ? upper.z : lower.z);
  }

  glm::bvec3 lower, upper;
};

}  // namespace

void LeafOctree::build(std::span<const Aabb> boxes) {
  entries_of_objects_.assign(boxes.size(), {});
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    entries_of_objects_[object] = {boxes[object], 0, State::unplaced};
  }
  lay_root();
}

void LeafOctree::lay_root() {
  blocks_.clear();
  runs_.clear();
  unplaced_.clear();
  valid_unplaced_ = 0;
  placed_ = 0;
  entries_ = 0;
  nodes_.assign(1, {});
  details_.assign(1, {});
  Aabb all;
  for (const Entry& entry : entries_of_objects_) {
    if (entry.state != State::absent && entry.box.valid()) all.extend(entry.box);
  }
  details_[root].cell = root_cube(all);
  for (ObjectId object = 0; object < entries_of_objects_.size(); ++object) {
    Entry& entry = entries_of_objects_[object];
    if (entry.state == State::absent) continue;
    if (entry.box.valid()) {
      runs_.push(details_[root].objects, object);
      entry.state = State::placed;
      ++placed_;
    } else {
      enter(object, entry.box);
    }
  }
  if (placed_ == 0) return;
  entries_ = placed_;
  nodes_[root].box = details_[root].cell;
  pending_.push_back(root);
  split_pending();
}

void LeafOctree::insert(ObjectId object, const Aabb& box) {
  if (object >= entries_of_objects_.size()) entries_of_objects_.resize(std::size_t{object} + 1);
  if (entries_of_objects_[object].state != State::absent) {
    throw std::logic_error("object " + std::to_string(object) + " is inserted twice");
  }
  enter(object, box);
}

void LeafOctree::remove(ObjectId object) {
  entry_of(object, "removed");
  leave(object);
}

void LeafOctree::move(ObjectId object, const Aabb& box) {
  entry_of(object, "moved");
  leave(object);
  enter(object, box);
}

void LeafOctree::finish_changes() {
  if (valid_unplaced_ > placed_) lay_root();
}

std::size_t LeafOctree::bytes() const {
  return blocks_.bytes() + runs_.bytes() + nodes_.capacity() * sizeof(SpatialNode) +
         details_.capacity() * sizeof(Detail) + entries_of_objects_.capacity() * sizeof(Entry) +
         unplaced_.capacity() * sizeof(ObjectId) + pending_.capacity() * sizeof(NodeIndex) +
         gathered_.capacity() * sizeof(ObjectId);
}

LeafOctree::Entry& LeafOctree::entry_of(ObjectId object, const char* what) {
  if (object >= entries_of_objects_.size() || entries_of_objects_[object].state == State::absent) {
    throw std::logic_error("object " + std::to_string(object) + " is " + what + ", but is not in");
  }
  return entries_of_objects_[object];
}

void LeafOctree::enter(ObjectId object, const Aabb& box) {
  Entry& entry = entries_of_objects_[object];
  entry.box = box;
  if (box.valid() && details_[root].cell.contains(box)) {
    entry.state = State::placed;
    ++placed_;
    add(root, object, box);
    split_pending();
    return;
  }
  entry.state = State::unplaced;
  entry.position = static_cast<std::uint32_t>(unplaced_.size());
  unplaced_.push_back(object);
  if (box.valid()) ++valid_unplaced_;
}

void LeafOctree::leave(ObjectId object) {
  Entry& entry = entries_of_objects_[object];
  if (entry.state == State::placed) {
    --placed_;
    take(root, object, entry.box);
  } else {
    unplaced_[entry.position] = unplaced_.back();
    entries_of_objects_[unplaced_.back()].position = entry.position;
    unplaced_.pop_back();
    if (entry.box.valid()) --valid_unplaced_;
  }
  entry.state = State::absent;
}

void LeafOctree::add(NodeIndex node, ObjectId object, const Aabb& box) {
  nodes_[node].box = details_[node].cell;
  if (nodes_[node].child_count == 0) {
    runs_.push(details_[node].objects, object);
    ++entries_;
    pending_.push_back(node);
    return;
  }
  const TouchedHalves touched(box, middle_of(details_[node].cell));
  for (unsigned i = 0; i < 8; ++i) {
    if (touched.octant(i)) add(nodes_[node].first_child + i, object, box);
  }
}

void LeafOctree::take(NodeIndex node, ObjectId object, const Aabb& box) {
  if (nodes_[node].child_count == 0) {
    runs_.take_out_object(details_[node].objects, object);
    --entries_;
    if (details_[node].objects.count == 0) nodes_[node].box = {};
    return;
  }
  const TouchedHalves touched(box, middle_of(details_[node].cell));
  for (unsigned i = 0; i < 8; ++i) {
    if (touched.octant(i)) take(nodes_[node].first_child + i, object, box);
  }
  merge_if_due(node);
}

void LeafOctree::split_pending() {
  // In the order of levels, so that the limit of entries is spent evenly.
  for (std::size_t i = 0; i < pending_.size(); ++i) split_if_due(pending_[i]);
  pending_.clear();
}

void LeafOctree::split_if_due(NodeIndex node) {
  const Detail detail = details_[node];
  const std::uint32_t count = detail.objects.count;
  if (count <= limits_.leaf_objects || count < detail.split_at || detail.depth >= limits_.depth ||
      !can_halve(detail.cell)) {
    return;
  }
  const glm::vec3 middle = middle_of(detail.cell);
  std::uint64_t touches = 0;
  for (const ObjectId object : runs_.of(detail.objects)) {
    const TouchedHalves touched(entries_of_objects_[object].box, middle);
    for (unsigned i = 0; i < 8; ++i) touches += touched.octant(i) ? 1 : 0;
  }
  const std::uint64_t added = touches - count;
  if (added == 7 * std::uint64_t{count} || (added > 0 && entries_ + added > entry_limit(placed_))) {
    // Not asked again for each object that comes, which would be quadratic.
    details_[node].split_at = 2 * count;
    return;
  }

  const NodeIndex first = blocks_.take();
  if (blocks_.size() > nodes_.size()) {
    nodes_.resize(blocks_.size());
    details_.resize(blocks_.size());
  }
  for (unsigned i = 0; i < 8; ++i) {
    nodes_[first + i] = {};
    details_[first + i] = {octant(detail.cell, i), {}, detail.depth + 1, 0};
  }
  nodes_[node].first_child = first;
  nodes_[node].child_count = 8;
  // The run moves while others grow: it is asked anew each time.
  for (std::uint32_t k = 0; k < count; ++k) {
    const ObjectId object = runs_.of(detail.objects)[k];
    const TouchedHalves touched(entries_of_objects_[object].box, middle);
    for (unsigned i = 0; i < 8; ++i) {
      if (!touched.octant(i)) continue;
      runs_.push(details_[first + i].objects, object);
      nodes_[first + i].box = details_[first + i].cell;
    }
  }
  runs_.release(details_[node].objects);
  entries_ += added;
  for (unsigned i = 0; i < 8; ++i) pending_.push_back(first + i);
}

void LeafOctree::merge_if_due(NodeIndex node) {
  const NodeIndex first = nodes_[node].first_child;
  std::uint64_t entries = 0;
  for (unsigned i = 0; i < 8; ++i) {
    if (nodes_[first + i].child_count != 0) return;
    entries += details_[first + i].objects.count;
  }
  if (entries > limits_.leaf_objects) return;
  gathered_.clear();
  for (unsigned i = 0; i < 8; ++i) {
    const std::span<const ObjectId> objects = runs_.of(details_[first + i].objects);
    gathered_.insert(gathered_.end(), objects.begin(), objects.end());
    runs_.release(details_[first + i].objects);
  }
  std::ranges::sort(gathered_);
  gathered_.erase(std::unique(gathered_.begin(), gathered_.end()), gathered_.end());
  for (const ObjectId object : gathered_) runs_.push(details_[node].objects, object);
  entries_ = entries_ - entries + gathered_.size();
  blocks_.give_back(first);
  nodes_[node].first_child = 0;
  nodes_[node].child_count = 0;
  nodes_[node].box = gathered_.empty() ? Aabb{} : details_[node].cell;
}

}  // namespace vislab
