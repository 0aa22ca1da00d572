#include "common/spatial/bsp.h"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>

namespace vislab {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

float centre_of(const Aabb& box, int axis) { return static_cast<float>(box.center()[axis]); }

double surface(const Aabb& box) {
  const glm::dvec3 half = box.half_size();
  return half.x * half.y + half.y * half.z + half.z * half.x;
}

std::array<int, 3> longest_first(const glm::dvec3& edges) {
  std::array<int, 3> axes{0, 1, 2};
  std::ranges::sort(
      axes, [&](int a, int b) { return edges[a] > edges[b] || (edges[a] == edges[b] && a < b); });
  return axes;
}

/// How many of a leaf's objects lie below and above each of the candidate planes of an axis, which
/// divide its box evenly. Rounding may put an object into the next bin: this is for costs only.
class PlaneCounts {
 public:
  static constexpr int planes = 15;

  PlaneCounts(float low, float high)
      : low_(low), step_((static_cast<double>(high) - low) / (planes + 1)) {}

  float position(int plane) const { return static_cast<float>(low_ + step_ * (plane + 1)); }
  void add(float from, float to) {
    ++ends_[static_cast<std::size_t>(planes_below(to))];
    ++starts_[static_cast<std::size_t>(planes_below(from))];
  }
  /// Objects wholly below the plane, and wholly above it.
  std::uint32_t below(int plane) const {
    std::uint32_t sum = 0;
    for (int i = 0; i <= plane; ++i) sum += ends_[static_cast<std::size_t>(i)];
    return sum;
  }
  std::uint32_t above(int plane) const {
    std::uint32_t sum = 0;
    for (int i = plane + 1; i <= planes; ++i) sum += starts_[static_cast<std::size_t>(i)];
    return sum;
  }

 private:
  int planes_below(float value) const {
    return std::clamp(static_cast<int>((value - low_) / step_), 0, planes);
  }

  double low_, step_;
  std::array<std::uint32_t, planes + 1> starts_{}, ends_{};
};

}  // namespace

Aabb AxisBsp::everywhere() { return {glm::vec3(-infinity), glm::vec3(infinity)}; }

void AxisBsp::build(std::span<const Aabb> boxes) {
  blocks_.clear();
  runs_.clear();
  unplaced_.clear();
  placed_ = 0;
  entries_ = 0;
  nodes_.assign(1, {});
  details_.assign(1, {});
  details_[root].stale = true;
  entries_of_objects_.assign(boxes.size(), {});
  for (ObjectId object = 0; object < boxes.size(); ++object) {
    entries_of_objects_[object].box = boxes[object];
    if (!boxes[object].valid()) {
      enter(object, boxes[object]);
      continue;
    }
    entries_of_objects_[object].state = State::placed;
    ++placed_;
    push(root, object);
  }
  pending_.push_back(root);
  split_pending();
  refit(root);
}

void AxisBsp::insert(ObjectId object, const Aabb& box) {
  if (object >= entries_of_objects_.size()) entries_of_objects_.resize(std::size_t{object} + 1);
  if (entries_of_objects_[object].state != State::absent) {
    throw std::logic_error("object " + std::to_string(object) + " is inserted twice");
  }
  enter(object, box);
}

void AxisBsp::remove(ObjectId object) {
  entry_of(object, "removed");
  leave(object);
}

void AxisBsp::move(ObjectId object, const Aabb& box) {
  entry_of(object, "moved");
  leave(object);
  enter(object, box);
}

void AxisBsp::finish_changes() { refit(root); }

std::size_t AxisBsp::bytes() const {
  return blocks_.bytes() + runs_.bytes() + nodes_.capacity() * sizeof(SpatialNode) +
         details_.capacity() * sizeof(Detail) + entries_of_objects_.capacity() * sizeof(Entry) +
         unplaced_.capacity() * sizeof(ObjectId) + pending_.capacity() * sizeof(NodeIndex) +
         gathered_.capacity() * sizeof(ObjectId) + centres_.capacity() * sizeof(float);
}

AxisBsp::Entry& AxisBsp::entry_of(ObjectId object, const char* what) {
  if (object >= entries_of_objects_.size() || entries_of_objects_[object].state == State::absent) {
    throw std::logic_error("object " + std::to_string(object) + " is " + what + ", but is not in");
  }
  return entries_of_objects_[object];
}

AxisBsp::Sides AxisBsp::sides_of(const Cut& cut, const Aabb& box) const {
  const float low = box.min[cut.axis];
  const float high = box.max[cut.axis];
  switch (limits_.straddlers) {
    case Straddlers::node:
      if (high <= cut.position) return {true, false};
      return {false, low >= cut.position};
    case Straddlers::both:
      return {low <= cut.position, high >= cut.position};
    case Straddlers::centre:
      break;
  }
  const bool lower = centre_of(box, cut.axis) < cut.position;
  return {lower, !lower};
}

void AxisBsp::enter(ObjectId object, const Aabb& box) {
  Entry& entry = entries_of_objects_[object];
  entry.box = box;
  if (box.valid()) {
    entry.state = State::placed;
    ++placed_;
    add(root, object);
    split_pending();
    return;
  }
  entry.state = State::unplaced;
  entry.position = static_cast<std::uint32_t>(unplaced_.size());
  unplaced_.push_back(object);
}

void AxisBsp::leave(ObjectId object) {
  Entry& entry = entries_of_objects_[object];
  if (entry.state == State::placed) {
    --placed_;
    take(root, object);
  } else {
    unplaced_[entry.position] = unplaced_.back();
    entries_of_objects_[unplaced_.back()].position = entry.position;
    unplaced_.pop_back();
  }
  entry.state = State::absent;
}

void AxisBsp::push(NodeIndex node, ObjectId object) {
  ObjectRuns::Run& run = details_[node].objects;
  entries_of_objects_[object].position = run.count;
  runs_.push(run, object);
  ++entries_;
}

void AxisBsp::add(NodeIndex node, ObjectId object) {
  details_[node].stale = true;
  if (nodes_[node].child_count == 0) {
    push(node, object);
    pending_.push_back(node);
    return;
  }
  const Sides sides = sides_of(details_[node].cut, entries_of_objects_[object].box);
  if (!sides.lower && !sides.upper) push(node, object);
  if (sides.lower) add(nodes_[node].first_child, object);
  if (sides.upper) add(nodes_[node].first_child + 1, object);
}

void AxisBsp::take(NodeIndex node, ObjectId object) {
  details_[node].stale = true;
  Sides sides{false, false};
  if (nodes_[node].child_count != 0) {
    sides = sides_of(details_[node].cut, entries_of_objects_[object].box);
  }
  if (!sides.lower && !sides.upper) {
    ObjectRuns::Run& run = details_[node].objects;
    --entries_;
    if (repeats_objects()) {
      runs_.take_out_object(run, object);
    } else {
      const std::uint32_t position = entries_of_objects_[object].position;
      entries_of_objects_[runs_.of(run).back()].position = position;
      runs_.take_out(run, position);
    }
  }
  if (sides.lower) take(nodes_[node].first_child, object);
  if (sides.upper) take(nodes_[node].first_child + 1, object);
  if (nodes_[node].child_count != 0) merge_if_due(node);
}

void AxisBsp::split_pending() {
  // In the order of levels, so that the limit of entries is spent evenly.
  for (std::size_t i = 0; i < pending_.size(); ++i) split_if_due(pending_[i]);
  pending_.clear();
}

void AxisBsp::split_if_due(NodeIndex node) {
  const std::uint32_t count = details_[node].objects.count;
  if (count <= limits_.leaf_objects || count < details_[node].split_at ||
      details_[node].depth >= limits_.depth) {
    return;
  }
  const Cut cut = choose_cut(node);
  if (!cut.exists()) {
    // Not asked again for each object that comes, which would be quadratic.
    details_[node].split_at = 2 * count;
    return;
  }
  const NodeIndex first = blocks_.take();
  if (blocks_.size() > nodes_.size()) {
    nodes_.resize(blocks_.size());
    details_.resize(blocks_.size());
  }
  for (unsigned i = 0; i < 2; ++i) {
    nodes_[first + i] = {};
    Detail& child = details_[first + i];
    child = {};
    child.depth = details_[node].depth + 1;
    child.stale = true;
    child.region = details_[node].region;
    (i == 0 ? child.region.max : child.region.min)[cut.axis] = cut.position;
  }
  details_[node].cut = cut;
  nodes_[node].first_child = first;
  nodes_[node].child_count = 2;
  const std::span<const ObjectId> objects = runs_.of(details_[node].objects);
  gathered_.assign(objects.begin(), objects.end());
  runs_.release(details_[node].objects);
  entries_ -= gathered_.size();
  for (const ObjectId object : gathered_) {
    const Sides sides = sides_of(cut, entries_of_objects_[object].box);
    if (!sides.lower && !sides.upper) push(node, object);
    if (sides.lower) push(first, object);
    if (sides.upper) push(first + 1, object);
  }
  pending_.push_back(first);
  pending_.push_back(first + 1);
}

void AxisBsp::merge_if_due(NodeIndex node) {
  const NodeIndex first = nodes_[node].first_child;
  if (nodes_[first].child_count != 0 || nodes_[first + 1].child_count != 0) return;
  const std::uint64_t own = details_[node].objects.count;
  const std::uint64_t below =
      std::uint64_t{details_[first].objects.count} + details_[first + 1].objects.count;
  if (own + below > limits_.leaf_objects) return;
  gathered_.clear();
  for (NodeIndex child = first; child < first + 2; ++child) {
    const std::span<const ObjectId> objects = runs_.of(details_[child].objects);
    gathered_.insert(gathered_.end(), objects.begin(), objects.end());
    runs_.release(details_[child].objects);
  }
  std::ranges::sort(gathered_);
  gathered_.erase(std::unique(gathered_.begin(), gathered_.end()), gathered_.end());
  entries_ -= below;
  for (const ObjectId object : gathered_) push(node, object);
  blocks_.give_back(first);
  nodes_[node].first_child = 0;
  nodes_[node].child_count = 0;
}

Aabb AxisBsp::part_in(NodeIndex node, ObjectId object) const {
  Aabb part = entries_of_objects_[object].box;
  if (limits_.straddlers == Straddlers::both) {
    part.min = glm::max(part.min, details_[node].region.min);
    part.max = glm::min(part.max, details_[node].region.max);
  }
  return part;
}

AxisBsp::Cut AxisBsp::choose_cut(NodeIndex leaf) {
  if (limits_.split == Split::cost) {
    const Cut cut = cheapest_cut(leaf);
    std::uint64_t added = 0;
    if (cut.exists() && separates(cut, leaf, added)) {
      if (added == 0 || entries_ + added <= entry_limit(placed_)) return cut;
      return {};
    }
  }
  return halving_cut(leaf);
}

AxisBsp::Cut AxisBsp::halving_cut(NodeIndex leaf) {
  const bool by_centre = limits_.straddlers == Straddlers::centre;
  Aabb bounds;
  for (const ObjectId object : runs_.of(details_[leaf].objects)) {
    const Aabb part = part_in(leaf, object);
    by_centre ? bounds.extend(glm::vec3(part.center())) : bounds.extend(part);
  }
  for (const int axis : longest_first(bounds.half_size())) {
    Cut cut{axis, centre_of(bounds, axis)};
    if (limits_.split == Split::median) {
      centres_.clear();
      for (const ObjectId object : runs_.of(details_[leaf].objects)) {
        centres_.push_back(centre_of(part_in(leaf, object), axis));
      }
      const auto middle = centres_.begin() + static_cast<std::ptrdiff_t>(centres_.size() / 2);
      std::nth_element(centres_.begin(), middle, centres_.end());
      cut.position = *middle;
    }
    std::uint64_t added = 0;
    if (separates(cut, leaf, added) && (added == 0 || entries_ + added <= entry_limit(placed_))) {
      return cut;
    }
  }
  return {};
}

AxisBsp::Cut AxisBsp::cheapest_cut(NodeIndex leaf) const {
  const std::span<const ObjectId> objects = runs_.of(details_[leaf].objects);
  const auto count = static_cast<std::uint32_t>(objects.size());
  const bool by_centre = limits_.straddlers == Straddlers::centre;
  Aabb bounds;
  for (const ObjectId object : objects) bounds.extend(part_in(leaf, object));
  Cut best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (!(bounds.min[axis] < bounds.max[axis])) continue;
    PlaneCounts counts(bounds.min[axis], bounds.max[axis]);
    for (const ObjectId object : objects) {
      const Aabb part = part_in(leaf, object);
      const float centre = centre_of(part, axis);
      by_centre ? counts.add(centre, centre) : counts.add(part.min[axis], part.max[axis]);
    }
    for (int plane = 0; plane < PlaneCounts::planes; ++plane) {
      std::uint32_t lower = counts.below(plane);
      std::uint32_t upper = counts.above(plane);
      const std::uint32_t straddling = count - lower - upper;
      double cost = 0.0;
      if (limits_.straddlers == Straddlers::node) {
        cost = surface(bounds) * straddling;
      } else {
        lower += straddling;
        upper += straddling;
      }
      if (lower + upper == 0 || lower == count || upper == count) continue;
      Aabb part = bounds;
      part.max[axis] = counts.position(plane);
      cost += surface(part) * lower;
      part = bounds;
      part.min[axis] = counts.position(plane);
      cost += surface(part) * upper;
      if (cost < best_cost) {
        best_cost = cost;
        best = {axis, counts.position(plane)};
      }
    }
  }
  return best;
}

bool AxisBsp::separates(const Cut& cut, NodeIndex leaf, std::uint64_t& added) const {
  const std::span<const ObjectId> objects = runs_.of(details_[leaf].objects);
  std::size_t lower = 0;
  std::size_t upper = 0;
  std::size_t stay = 0;
  for (const ObjectId object : objects) {
    const Sides sides = sides_of(cut, entries_of_objects_[object].box);
    lower += sides.lower ? 1 : 0;
    upper += sides.upper ? 1 : 0;
    stay += !sides.lower && !sides.upper ? 1 : 0;
  }
  added = lower + upper + stay - objects.size();
  return lower + upper > 0 && lower < objects.size() && upper < objects.size();
}

void AxisBsp::refit(NodeIndex node) {
  if (!details_[node].stale) return;
  details_[node].stale = false;
  Aabb box;
  for (const ObjectId object : runs_.of(details_[node].objects)) box.extend(part_in(node, object));
  for (std::uint32_t i = 0; i < nodes_[node].child_count; ++i) {
    refit(nodes_[node].first_child + i);
    box.extend(nodes_[nodes_[node].first_child + i].box);
  }
  nodes_[node].box = box;
}

}  // namespace vislab
