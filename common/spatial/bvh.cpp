#include "common/spatial/bvh.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace vislab {
namespace {

Aabb united(Aabb a, const Aabb& b) {
  a.extend(b);
  return a;
}

[[noreturn]] void refuse(const char* what, ObjectId object) {
  throw std::logic_error(std::string("BVH: ") + what + " object " + std::to_string(object));
}

}  // namespace

void Bvh::clear_tree() {
  nodes_.assign(1, {});
  links_.assign(1, {});
  leaves_.assign(1, {});
  objects_.clear();
  free_pairs_.clear();
  free_capacities_.clear();
  runs_intact_ = false;
}

void Bvh::insert(ObjectId object, const Aabb& box) {
  if (object >= places_.size()) places_.resize(std::size_t{object} + 1);
  Place& place = places_[object];
  if (place.node != nowhere) refuse("inserted again:", object);
  place.box = box;
  if (box.valid()) {
    put_in_tree(object);
  } else {
    place.node = in_unplaced;
    place.unplaced = static_cast<std::uint32_t>(unplaced_.size());
    unplaced_.push_back(object);
  }
}

void Bvh::remove(ObjectId object) {
  if (object >= places_.size() || places_[object].node == nowhere) {
    refuse("there is nothing to remove of", object);
  }
  Place& place = places_[object];
  if (place.node == in_unplaced) {
    places_[unplaced_.back()].unplaced = place.unplaced;
    unplaced_[place.unplaced] = unplaced_.back();
    unplaced_.pop_back();
  } else {
    take_from_tree(object);
  }
  place.node = nowhere;
}

void Bvh::move(ObjectId object, const Aabb& box) {
  if (object >= places_.size() || places_[object].node == nowhere) {
    refuse("there is nothing to move of", object);
  }
  Place& place = places_[object];
  const bool stays = place.node != in_unplaced && box.valid();
  if (!stays || limits_.motion == Motion::reinsert) {
    remove(object);
    insert(object, box);
    return;
  }
  place.box = box;
  if (limits_.motion == Motion::refit || limits_.motion == Motion::rebuild) {
    if (!place.moved) moved_.push_back(object);
    place.moved = true;
    return;
  }
  for (NodeIndex node = place.node; node != nowhere; node = links_[node].parent) {
    if (nodes_[node].box.contains(box)) break;
    nodes_[node].box.extend(box);
  }
}

void Bvh::finish_changes() {
  if (moved_.empty()) return;
  if (limits_.motion == Motion::rebuild) {
    for (const ObjectId object : moved_) places_[object].moved = false;
    build_tree();
  } else {
    refit_moved();
  }
  moved_.clear();
}

void Bvh::refit_moved() {
  for (const ObjectId object : moved_) {
    places_[object].moved = false;
    NodeIndex node = places_[object].node;
    if (node >= in_unplaced) continue;  // moved, and then taken out
    for (; node != nowhere && !links_[node].dirty; node = links_[node].parent) {
      links_[node].dirty = true;
    }
  }
  // Down along what is dirty, then back, so that children come before their parents.
  stack_.clear();
  if (links_[root].dirty) stack_.push_back(root);
  for (std::size_t i = 0; i < stack_.size(); ++i) {
    const SpatialNode& node = nodes_[stack_[i]];
    for (std::uint32_t child = 0; child < node.child_count; ++child) {
      if (links_[node.first_child + child].dirty) stack_.push_back(node.first_child + child);
    }
  }
  while (!stack_.empty()) {
    set_box(stack_.back());
    links_[stack_.back()].dirty = false;
    stack_.pop_back();
  }
}

Bvh::NodeIndex Bvh::add_pair(NodeIndex parent) {
  NodeIndex first;
  if (free_pairs_.empty()) {
    first = static_cast<NodeIndex>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    links_.resize(nodes_.size());
    leaves_.resize(nodes_.size());
  } else {
    first = free_pairs_.back();
    free_pairs_.pop_back();
  }
  for (NodeIndex node = first; node < first + 2; ++node) {
    nodes_[node] = {};
    links_[node] = {};
    links_[node].parent = parent;
    leaves_[node] = {};
  }
  return first;
}

void Bvh::set_box(NodeIndex node) {
  SpatialNode& at = nodes_[node];
  at.box = {};
  for (std::uint32_t i = 0; i < at.child_count; ++i) at.box.extend(nodes_[at.first_child + i].box);
  for (const ObjectId object : objects_at(node)) at.box.extend(places_[object].box);
}

Bvh::NodeIndex Bvh::best_sibling(const Aabb& box) {
  const double own_area = half_area(box);
  // A leaf that is good already, so that the search can leave out much. Of equals the smaller
  // subtree: many equal boxes make no long chain.
  NodeIndex best = root;
  double best_cost = std::numeric_limits<double>::infinity();
  double inherited = 0.0;  // what the areas of the ancestors grow by
  for (NodeIndex node = root;;) {
    const double area = half_area(united(nodes_[node].box, box));
    if (inherited + area <= best_cost) {
      best = node;
      best_cost = inherited + area;
    }
    inherited += area - half_area(nodes_[node].box);
    if (nodes_[node].child_count == 0) break;
    const NodeIndex left = nodes_[node].first_child;
    const auto growth = [&](NodeIndex child) {
      return half_area(united(nodes_[child].box, box)) - half_area(nodes_[child].box);
    };
    const double of_left = growth(left);
    const double of_right = growth(left + 1);
    const bool smaller = links_[left].count_below <= links_[left + 1].count_below;
    node = of_left < of_right || (of_left == of_right && smaller) ? left : left + 1;
  }
  const auto later = [](const Candidate& a, const Candidate& b) {
    return a.bound != b.bound ? a.bound > b.bound : a.node > b.node;
  };
  queue_.assign(1, {own_area, root});
  while (!queue_.empty() && queue_.front().bound < best_cost) {
    std::ranges::pop_heap(queue_, later);
    const auto [bound, node] = queue_.back();
    queue_.pop_back();
    const double above = bound - own_area;
    const double area = half_area(united(nodes_[node].box, box));
    if (above + area < best_cost) {
      best = node;
      best_cost = above + area;
    }
    const double below = bound + area - half_area(nodes_[node].box);
    if (nodes_[node].child_count == 0 || !(below < best_cost)) continue;
    for (NodeIndex child = 0; child < 2; ++child) {
      queue_.push_back({below, nodes_[node].first_child + child});
      std::ranges::push_heap(queue_, later);
    }
  }
  return best;
}

void Bvh::put_in_tree(ObjectId object) {
  runs_intact_ = false;
  const Aabb& box = places_[object].box;
  NodeIndex node = links_[root].count_below == 0 ? root : best_sibling(box);
  if (nodes_[node].child_count == 0 && leaves_[node].count < limits_.leaf_objects) {
    add_to_leaf(node, object);
  } else {
    make_sibling(node, object);
  }
  for (; node != nowhere; node = links_[node].parent) {
    nodes_[node].box.extend(box);
    ++links_[node].count_below;
  }
}

void Bvh::add_to_leaf(NodeIndex node, ObjectId object) {
  Leaf& leaf = leaves_[node];
  if (leaf.count == leaf.capacity) {
    std::uint32_t first;
    if (free_capacities_.empty()) {
      first = static_cast<std::uint32_t>(objects_.size());
      objects_.resize(objects_.size() + limits_.leaf_objects, none_id);
    } else {
      first = free_capacities_.back();
      free_capacities_.pop_back();
    }
    std::copy_n(objects_.begin() + leaf.first, leaf.count, objects_.begin() + first);
    free_leaf_memory(node);
    leaf.first = first;
    leaf.capacity = limits_.leaf_objects;
  }
  objects_[leaf.first + leaf.count++] = object;
  places_[object].node = node;
}

void Bvh::free_leaf_memory(NodeIndex node) {
  // Smaller pieces were made by build(), and stay unused until the next.
  const Leaf& leaf = leaves_[node];
  if (leaf.capacity == limits_.leaf_objects) free_capacities_.push_back(leaf.first);
}

void Bvh::make_sibling(NodeIndex node, ObjectId object) {
  const NodeIndex pair = add_pair(node);
  nodes_[pair] = nodes_[node];
  leaves_[pair] = leaves_[node];
  links_[pair].count_below = links_[node].count_below;
  adopt(pair);
  nodes_[node].first_child = pair;
  nodes_[node].child_count = 2;
  leaves_[node] = {};
  add_to_leaf(pair + 1, object);
  if (nodes_[pair].child_count == 0) share_objects(pair, pair + 1);
  for (NodeIndex child = pair; child < pair + 2; ++child) {
    if (nodes_[child].child_count == 0) links_[child].count_below = leaves_[child].count;
    set_box(child);
  }
}

void Bvh::share_objects(NodeIndex full, NodeIndex other) {
  shared_.assign(objects_at(full).begin(), objects_at(full).end());
  shared_.insert(shared_.end(), objects_at(other).begin(), objects_at(other).end());
  Aabb centers;
  for (const ObjectId object : shared_) centers.extend(glm::vec3(places_[object].box.center()));
  const glm::dvec3 size = centers.half_size();
  const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  const auto lower = [&](ObjectId a, ObjectId b) {
    const double of_a = places_[a].box.center()[axis];
    const double of_b = places_[b].box.center()[axis];
    return of_a != of_b ? of_a < of_b : a < b;
  };
  std::ranges::sort(shared_, lower);
  const auto half = static_cast<std::uint32_t>(shared_.size() / 2);
  leaves_[full].count = half;
  leaves_[other].count = static_cast<std::uint32_t>(shared_.size()) - half;
  std::copy_n(shared_.begin(), half, objects_.begin() + leaves_[full].first);
  std::copy(shared_.begin() + half, shared_.end(), objects_.begin() + leaves_[other].first);
  adopt(full);
  adopt(other);
}

void Bvh::adopt(NodeIndex node) {
  const SpatialNode& at = nodes_[node];
  for (std::uint32_t i = 0; i < at.child_count; ++i) links_[at.first_child + i].parent = node;
  for (const ObjectId object : objects_at(node)) places_[object].node = node;
}

void Bvh::take_from_tree(ObjectId object) {
  runs_intact_ = false;
  NodeIndex node = places_[object].node;
  Leaf& leaf = leaves_[node];
  const std::span<ObjectId> here(objects_.data() + leaf.first, leaf.count);
  *std::ranges::find(here, object) = here.back();
  --leaf.count;
  if (leaf.count > 0 || node == root) {
    set_box(node);
    --links_[node].count_below;
    node = links_[node].parent;
  } else {
    const NodeIndex parent = links_[node].parent;
    replace_by_sibling(node);
    node = links_[parent].parent;
  }
  for (bool changes = true; node != nowhere; node = links_[node].parent) {
    --links_[node].count_below;
    if (!changes) continue;
    const Aabb before = nodes_[node].box;
    set_box(node);
    changes = nodes_[node].box != before;
  }
}

void Bvh::replace_by_sibling(NodeIndex leaf) {
  free_leaf_memory(leaf);
  const NodeIndex parent = links_[leaf].parent;
  const NodeIndex pair = nodes_[parent].first_child;
  const NodeIndex sibling = leaf == pair ? pair + 1 : pair;
  nodes_[parent] = nodes_[sibling];
  leaves_[parent] = leaves_[sibling];
  links_[parent].count_below = links_[sibling].count_below;
  adopt(parent);
  free_pairs_.push_back(pair);
}

double Bvh::surface_area() const {
  double half = 0.0;
  std::vector<NodeIndex> open{root};
  while (!open.empty()) {
    const SpatialNode& node = nodes_[open.back()];
    open.pop_back();
    half += half_area(node.box);
    for (std::uint32_t i = 0; i < node.child_count; ++i) open.push_back(node.first_child + i);
  }
  return 2.0 * half;
}

}  // namespace vislab
