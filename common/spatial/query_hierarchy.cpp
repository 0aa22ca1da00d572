#include "common/spatial/query_hierarchy.h"

#include <algorithm>

#include "common/geometry/random.h"

namespace vislab {
namespace {

/// Leaves of light objects may hold several, for a smaller tree.
constexpr std::uint32_t most_leaf_objects = 8;

}  // namespace

void QueryHierarchy::build(const Scene& scene) {
  scene_ = &scene;
  std::uint64_t heaviest = 1;
  for (ObjectId object = 0; object < scene.object_count(); ++object) {
    heaviest = std::max(heaviest, std::uint64_t{scene.triangle_count(object)} + draw_triangles);
  }
  Bvh::Limits limits;
  limits.leaf_objects = static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(leaf_triangles_ / heaviest, 1, most_leaf_objects));
  followed_.emplace(limits).build(scene);
  unit_of_.assign(scene.object_count(), nowhere);
  links_.clear();
  link();
  changed_.clear();
}

bool QueryHierarchy::reset() {
  if (!followed_->reset()) return false;
  link();
  return true;
}

void QueryHierarchy::update(const Frame& frame, const Changes& changes) {
  changed_.clear();
  if (!followed_->update(frame, changes)) return;
  bool others = !changes.shown.empty() || !changes.hidden.empty();
  for (const ObjectId object : changes.moved) {
    // Between the tree and the unplaced.
    others |= followed_->holds(object) &&
              frame.objects.bounds[object].valid() != (unit_of_[object] != nowhere);
  }
  if (others) link();
}

void QueryHierarchy::link() {
  const std::span<const SpatialNode> nodes = structure().nodes();
  std::swap(links_, before_);
  links_.assign(nodes.size(), {});
  objects_.clear();
  // Depth first: the objects of every node are a run, and children stand after their parents.
  order_.clear();
  stack_.assign(1, SpatialStructure::root);
  while (!stack_.empty()) {
    const NodeIndex index = stack_.back();
    stack_.pop_back();
    order_.push_back(index);
    links_[index].first = static_cast<std::uint32_t>(objects_.size());
    for (const ObjectId object : structure().objects_at(index)) {
      objects_.push_back(object);
      ++links_[index].count;
      links_[index].triangles += scene_->triangle_count(object);
      links_[index].contents += Random(object).bits();
    }
    for (std::uint32_t i = nodes[index].child_count; i-- > 0;) {
      links_[nodes[index].first_child + i].parent = index;
      stack_.push_back(nodes[index].first_child + i);
    }
  }
  for (std::size_t i = order_.size(); i-- > 0;) {
    const Links& child = links_[order_[i]];
    if (child.parent == nowhere) continue;
    links_[child.parent].count += child.count;
    links_[child.parent].triangles += child.triangles;
    links_[child.parent].contents += child.contents;
  }
  find_units();
  find_changed();
}

void QueryHierarchy::find_units() {
  std::ranges::fill(unit_of_, nowhere);
  for (const NodeIndex index : order_) {
    Links& links = links_[index];
    links.unit = structure().nodes()[index].child_count == 0 || work(index) <= leaf_triangles_;
    const bool walk_ends_here =
        links.unit && (links.parent == nowhere || !links_[links.parent].unit);
    if (!walk_ends_here) continue;
    for (const ObjectId object : objects(index)) unit_of_[object] = index;
    // Devices draw objects of neighbouring ids a little faster.
    std::sort(objects_.begin() + links.first, objects_.begin() + links.first + links.count);
  }
}

void QueryHierarchy::find_changed() {
  changed_.clear();
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const bool same = i < before_.size() && before_[i].contents == links_[i].contents;
    if (!same) changed_.push_back(static_cast<NodeIndex>(i));
  }
}

std::size_t QueryHierarchy::bytes() const {
  return (followed_ ? followed_->bytes() : 0) +
         (links_.capacity() + before_.capacity()) * sizeof(Links) +
         objects_.capacity() * sizeof(ObjectId) +
         (unit_of_.capacity() + changed_.capacity() + order_.capacity() + stack_.capacity()) *
             sizeof(NodeIndex);
}

}  // namespace vislab
